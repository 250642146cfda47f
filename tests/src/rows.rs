//! The rows of core's registries behind one signature each, so that one suite serves all of a kind.
//!
//! A registry names files; a module of the same name here says how that file's functions are called. A file
//! without such a module fails to compile as soon as it has a row.

pub mod spectral;

/// Samplers of free flights.
pub mod free_flight {
    use woodcock_core::free_flight::{self, Flight};
    use woodcock_core::medium::{Homogeneous, Medium};
    use woodcock_core::ray::Ray;
    use woodcock_core::real::Real;
    use woodcock_core::stream::Stream;

    /// What a sampler of free flights is asked.
    pub trait Sampler {
        /// It serves any medium, not the homogeneous alone.
        const ANY_MEDIUM: bool;
        /// A flight through fog.
        fn in_fog<R: Real>(
            fog: &Homogeneous,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> Flight<R>;
        /// A flight through anything; not called unless [`Self::ANY_MEDIUM`].
        fn in_any<R: Real, M: Medium<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> Flight<R>;
    }

    macro_rules! row {
        ($name:ident, $any:literal, $fog:expr, $in_any:expr) => {
            #[doc = concat!("`free_flight/", stringify!($name), ".rs`.")]
            pub mod $name {
                use super::*;
                /// Its row.
                #[derive(Clone, Copy, Debug)]
                pub struct Row;
                impl Sampler for Row {
                    const ANY_MEDIUM: bool = $any;
                    fn in_fog<R: Real>(
                        fog: &Homogeneous,
                        ray: &Ray<R>,
                        t_max: R,
                        rng: &mut impl Stream<R>,
                        active: R::Mask,
                    ) -> Flight<R> {
                        $fog(fog, ray, t_max, rng, active)
                    }
                    fn in_any<R: Real, M: Medium<R>>(
                        medium: &M,
                        ray: &Ray<R>,
                        t_max: R,
                        rng: &mut impl Stream<R>,
                        active: R::Mask,
                    ) -> Flight<R> {
                        $in_any(medium, ray, t_max, rng, active)
                    }
                }
            }
        };
    }
    row!(
        analytic,
        false,
        |fog, _, t_max, rng, active| free_flight::analytic::sample(fog, t_max, rng, active),
        |_, _, _, _, _| unreachable!("the closed form is for homogeneous media")
    );
    row!(
        delta,
        true,
        free_flight::delta::sample,
        free_flight::delta::sample
    );
}

/// Estimators of transmittance.
pub mod transmittance {
    use woodcock_core::medium::{Homogeneous, Medium};
    use woodcock_core::ray::Ray;
    use woodcock_core::real::Real;
    use woodcock_core::stream::Stream;
    use woodcock_core::transmittance;

    /// What is known along a ray: enough to predict every estimator's variance and cost.
    #[derive(Clone, Copy, Debug)]
    pub struct Known {
        /// τ.
        pub optical_depth: f64,
        /// ∫σ_t² dt [1/length].
        pub squared_integral: f64,
        /// ∫ e^−τ(t) dt \[length\].
        pub mean_free_flight: f64,
        /// Length of the ray.
        pub t_max: f64,
        /// The constant bound [1/length].
        pub majorant: f64,
    }

    /// What an estimator of transmittance is asked.
    pub trait Estimator {
        /// It serves any medium, not the homogeneous alone.
        const ANY_MEDIUM: bool;
        /// An estimate through fog.
        fn in_fog<R: Real>(
            fog: &Homogeneous,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> R;
        /// An estimate through anything; not called unless [`Self::ANY_MEDIUM`].
        fn in_any<R: Real, M: Medium<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> R;
        /// E W² under a constant bound.
        fn second_moment(known: &Known) -> f64;
        /// Mean number of look-ups under a constant bound that the extinction stays below.
        fn lookups(known: &Known) -> f64;
    }

    macro_rules! row {
        ($name:ident, $any:literal, $fog:expr, $in_any:expr, $second:expr, $lookups:expr) => {
            #[doc = concat!("`transmittance/", stringify!($name), ".rs`.")]
            pub mod $name {
                use super::*;
                /// Its row.
                #[derive(Clone, Copy, Debug)]
                pub struct Row;
                impl Estimator for Row {
                    const ANY_MEDIUM: bool = $any;
                    fn in_fog<R: Real>(
                        fog: &Homogeneous,
                        ray: &Ray<R>,
                        t_max: R,
                        rng: &mut impl Stream<R>,
                        active: R::Mask,
                    ) -> R {
                        $fog(fog, ray, t_max, rng, active)
                    }
                    fn in_any<R: Real, M: Medium<R>>(
                        medium: &M,
                        ray: &Ray<R>,
                        t_max: R,
                        rng: &mut impl Stream<R>,
                        active: R::Mask,
                    ) -> R {
                        $in_any(medium, ray, t_max, rng, active)
                    }
                    fn second_moment(known: &Known) -> f64 {
                        let second: fn(&Known) -> f64 = $second;
                        second(known)
                    }
                    fn lookups(known: &Known) -> f64 {
                        let lookups: fn(&Known) -> f64 = $lookups;
                        lookups(known)
                    }
                }
            }
        };
    }
    row!(
        analytic,
        false,
        |fog, _, t_max, _, _| transmittance::analytic::estimate(fog, t_max),
        |_, _, _, _, _| unreachable!("the closed form is for homogeneous media"),
        |k| (-2.0 * k.optical_depth).exp(),
        |_| 0.0
    );
    row!(
        delta,
        true,
        transmittance::delta::estimate,
        transmittance::delta::estimate,
        |k| (-k.optical_depth).exp(),
        |k| k.majorant * k.mean_free_flight
    );
    row!(
        ratio,
        true,
        transmittance::ratio::estimate,
        transmittance::ratio::estimate,
        |k| (k.squared_integral / k.majorant - 2.0 * k.optical_depth).exp(),
        |k| k.majorant * k.t_max
    );
}
