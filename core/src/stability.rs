//! What holds where: how far from the truth `f32` can be, at the ends of every range.
//!
//! All that follows is asserted by the suite `tests/tests/estimators/stress`, whose tests are named in the last column; the
//! elementary functions have a [table of their own](crate::elementary). Errors are relative unless they say otherwise, against the
//! same law in double precision or a closed formula. *Condition* is what the rounding of an argument costs any formula: for
//! e^−x it is x. Each test also rejects planted mistakes that are at least ten times as wrong.
//!
//! ## Probabilities and distances
//!
//! | quantity | domain | error at most | beyond | test |
//! |---|---|---|---|---|
//! | P(collision), every free flight | τ from 1e-12 to 3, σ_t from 1e-30 to 1e30 | 5e-7, by counting words | P < 2⁻¹⁰⁴ is rounded to 2⁻¹²⁸ | `tracking::rare_collisions_have_their_probability` |
//! | survival, and weight of survivors, under [`roulette`](crate::collision::roulette) | weights down to 1e-12 of thresholds 1e-30 … 1e30 | 5e-7, by counting words | as above | `tracking::roulette_is_fair_to_small_weights` |
//! | flights that leave an opaque medium | τ = 1e12 | none, up to 1600 mean free paths | | `tracking::opaque_media_let_nothing_pass` |
//! | mean free path, every free flight | τ = 1e12 | statistics resolve 1 % | | `tracking::opaque_media_have_their_mean_free_path` |
//! | tentative collisions on a ray | up to 1e7 | Poisson's law within 4.9 σ | refused by [`check_work`](crate::majorant::check_work) | `tracking::ten_million_collisions_on_a_ray_do_not_stall` |
//! | collisions in other units of length | lengths by 2⁻⁵⁰ … 2⁵⁰, every medium and tracker | none: the same bits | subnormal or infinite coefficients | `scale::no_estimator_knows_the_unit_of_length` |
//! | all estimates, f32 and eight lanes | lengths 1e-15 … 1e15, depths 1e-12 … 1e12, at random | no NaN, all in range, lanes equal scalars | | `sweeps` |
//!
//! Short flights keep their digits because uniform numbers do ([`Stream::exponential`](crate::stream::Stream::exponential)), and long
//! ones have no longest. Distances are sums of two numbers while a ray is walked, so that 1e7 steps do not stall.
//!
//! ## Closed forms
//!
//! | quantity | domain | error at most | test |
//! |---|---|---|---|
//! | depth, distance in [`Homogeneous`](crate::medium::Homogeneous) | σ_t 1e-30 … 1e30, τ 1e-12 … 1e12 | 6e-8, half an ulp | `closed_forms::homogeneous_media_lose_half_an_ulp` |
//! | T in it | as above | 1.2e-7 + 6e-8 τ | the same |
//! | 1 − T, and line integrals through fog | τ 1e-30 … 1e3 | 2e-7 | `closed_forms::thin_media_keep_their_collisions` |
//! | distance on a [`Linear`](crate::medium::Linear) ramp | extinction 1e-30 … 1e30, lengths 1e-15 … 1e15 | 1e-6 in the depth reached | `closed_forms::ramps_are_inverted_to_a_few_ulps` |
//! | its depth | as above | 4e-7 · condition, which is that of t − t₀ on ramps that begin below zero | `closed_forms::ramps_have_their_depth` |
//! | distance in an [`Exponential`](crate::medium::Exponential) atmosphere | σ₀ 1e-30 … 1e30, exponents to ±150, scale heights 1e-15 … 1e15 | 1e-6 (1 + 0.3 (\|h\| + \|kt\|)) in the depth reached | `closed_forms::atmospheres_are_inverted_as_well_as_their_exponents_allow` |
//! | its depth and extinction | as above | 6e-7 (1 + 0.3 (\|h\| + \|kt\|)) | `closed_forms::atmospheres_have_their_depth_and_extinction` |
//! | anything in a vacuum | σ = 0, any place | exact: never a collision, T = 1 | `closed_forms::an_empty_atmosphere_never_collides` and others |
//!
//! Ramps and atmospheres are judged by the depth that the distance found has in truth: where a ramp ends, or the air does, distances
//! themselves are as ill-conditioned as the question. Extinctions beyond the largest `f32` count as that.
//!
//! ## Grids and geometry
//!
//! | quantity | domain | error at most | test |
//! |---|---|---|---|
//! | interpolant on a walk | faces, edges, corners; components ±0, 1e-40, 1e-30, 1e-7; one voxel to 33 samples an axis | 4e-6 of the largest sample: the rounding of coordinates | `grids::rays_along_faces_edges_and_corners_are_walked` |
//! | segments of a walk | as above | the blocks of the three axes, and 3 | the same |
//! | look-ups above their bound | as above, and neighbours 0 and 1e6 | none | `grids` |
//! | flights, T through samples | 1e-44 … 3.3e38, subnormals included | statistics resolve 5 % | `grids::samples_at_the_ends_of_f32_mean_what_they_say` |
//! | flights at an offset of 1e6 | maps that are exact there | none: the bits of the flight at the origin | `grids::grids_at_an_offset_of_a_million_are_themselves` |
//! | [`clip_to_box`](crate::ray::clip_to_box) | sizes 1e-21 … 1e21, origins 1e6 sizes away, components ±0 … 1 | 3 · 2⁻²⁴ (\|o\| + size)/\|d\| | `geometry::boxes_are_clipped_to_the_rounding_of_their_coordinates` |
//! | [`clip_to_unit_sphere`](crate::ray::clip_to_unit_sphere) | origins up to 1e6 radii away, directions 1e-15 … 1e15 long | 2.4e-7 (\|o\| + 1)(1 + 1/half chord), absolute, in radii | `geometry::spheres_are_clipped_from_afar` |
//!
//! A ray along the far face of a domain is outside. From 1e6 radii away a sphere is seen to a tenth of its radius: move the
//! world's origin first, as the host does. Where a bound times the scale of a grid overflows, the grid is refused.
//!
//! ## Directions
//!
//! | quantity | domain | error at most | test |
//! |---|---|---|---|
//! | Henyey–Greenstein cosine | \|g\| 0, 1e-40 … 0.9999, u at both ends | 2.5e-7, absolute | `phases::henyey_greenstein_is_sampled_at_every_g` |
//! | the same | \|g\| up to 1 − 2⁻²⁴ | 3e-7, absolute | the same |
//! | its density, from the cosine as it is | as above | 6e-7 | `phases::the_peak_of_henyey_greenstein_is_that_of_its_formula` |
//! | Rayleigh's cosine | u at both ends and about 1/2 | 6e-7 | `phases::rayleigh_and_isotropic_cosines_are_right_at_both_ends` |
//! | [`deflected`](crate::vec3::Vec3::deflected): length, and cosine to the axis | axes at and near ±z, components ±0; cosines ±1 | 4e-7, absolute, the two together | `phases::deflections_have_their_angle_about_every_axis` |
//! | unit length | after 1e6 deflections | 3e-7 | `phases::a_long_chain_of_deflections_keeps_unit_length` |
//!
//! A cosine near one tells angles apart from 3.5e-4 on only; lobes narrower than that (1 − \|g\| < 1e-4) keep their mean cosine, not
//! their shape.
//!
//! ## Sums and work
//!
//! | quantity | domain | bound | test |
//! |---|---|---|---|
//! | [`Compensated`](crate::sum::Compensated) sums | 1e8 addends, 1e9 with `WOODCOCK_EXHAUSTIVE=1`; sizes over 30 decades | 1.2e-7 | `sums` |
//! | segments of a [`Linear`](crate::medium::Linear) ray | any finite coefficients, rays without an end | 160 | `work::ramps_are_walked_in_few_segments` |
//! | segments of an [`Exponential`](crate::medium::Exponential) ray | as above | 300 | `work::atmospheres_are_walked_in_few_segments` |
//! | look-ups of a tracker | majorant depths D up to 3e3 | D + 8 √D + 16 each | `sweeps::nothing_breaks_between_the_ends` |
//! | majorant depths above [`WORK_LIMIT`](crate::majorant::WORK_LIMIT) | up to infinite | refused without a look-up or a draw | `work::what_is_astronomical_is_refused_beforehand` |
//! | rays longer than [`FAR`](crate::ray::FAR) | up to infinite | walks end at `FAR` | `work::rays_without_an_end_are_tracked` |
//!
//! Nothing is capped: a walk ends because its ray does, its medium does or its weight is zero. What would take too long is an error
//! before it begins. A ramp that begins steeply from zero at a far place, so steeply that neighbouring places of `f32` lie 1e9
//! mean free paths apart, is such a case.
