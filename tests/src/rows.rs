//! The rows of core's registries behind one signature each, so that one suite serves all of a kind.
//!
//! A registry names files; a module of the same name here says how that file's functions are called. A file
//! without such a module fails to compile as soon as it has a row.

pub mod spectral;

use woodcock_core::medium::{ClosedForm, Controlled, Homogeneous, PiecewiseConstant};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::Stream;

/// Which media a row serves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Serves {
    /// Those with optical depth in closed form.
    ClosedForm,
    /// Those that are constant in pieces.
    PiecewiseConstant,
    /// All.
    Any,
}

/// Writes the three ways to call a row, of which [`Serves`] names the one that exists.
macro_rules! calls {
    ($out:ty, closed_form = $call:expr) => {
        calls!(@in_closed_form $out, $call);
        calls!(@none in_cells, PiecewiseConstant, $out);
        calls!(@none in_any, Controlled, $out);
    };
    ($out:ty, cells = $call:expr) => {
        calls!(@none in_closed_form, ClosedForm, $out);
        calls!(@in_cells $out, $call);
        calls!(@none in_any, Controlled, $out);
    };
    ($out:ty, any = $call:expr) => {
        calls!(@none in_closed_form, ClosedForm, $out);
        calls!(@none in_cells, PiecewiseConstant, $out);
        calls!(@in_any $out, $call);
    };
    (@in_closed_form $out:ty, $call:expr) => { calls!(@some in_closed_form, ClosedForm, $out, $call); };
    (@in_cells $out:ty, $call:expr) => { calls!(@some in_cells, PiecewiseConstant, $out, $call); };
    (@in_any $out:ty, $call:expr) => { calls!(@some in_any, Controlled, $out, $call); };
    (@some $name:ident, $bound:ident, $out:ty, $call:expr) => {
        fn $name<R: Real, M: $bound<R>>(
            medium: &M, ray: &Ray<R>, t_max: R, rng: &mut impl Stream<R>, active: R::Mask,
        ) -> $out {
            $call(medium, ray, t_max, rng, active)
        }
    };
    (@none $name:ident, $bound:ident, $out:ty) => {
        fn $name<R: Real, M: $bound<R>>(
            _: &M, _: &Ray<R>, _: R, _: &mut impl Stream<R>, _: R::Mask,
        ) -> $out {
            unreachable!("this row serves other media")
        }
    };
}

/// Samplers of free flights.
pub mod free_flight {
    use super::*;
    use woodcock_core::free_flight::{self, Flight};
    use woodcock_core::real::Mask;

    /// What a sampler of free flights is asked.
    pub trait Sampler {
        /// Which media it serves; only that way may be called.
        const SERVES: Serves;
        /// A flight in closed form.
        fn in_closed_form<R: Real, M: ClosedForm<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> Flight<R>;
        /// A flight from cell to cell.
        fn in_cells<R: Real, M: PiecewiseConstant<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> Flight<R>;
        /// A flight through anything.
        fn in_any<R: Real, M: Controlled<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> Flight<R>;
        /// A flight through fog, which every row serves.
        fn in_fog<R: Real>(
            fog: &Homogeneous,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> Flight<R> {
            match Self::SERVES {
                Serves::ClosedForm => Self::in_closed_form(fog, ray, t_max, rng, active),
                Serves::PiecewiseConstant => Self::in_cells(fog, ray, t_max, rng, active),
                Serves::Any => Self::in_any(fog, ray, t_max, rng, active),
            }
        }
    }

    macro_rules! row {
        ($name:ident, $serves:ident, $how:ident = $call:expr) => {
            #[doc = concat!("`free_flight/", stringify!($name), ".rs`.")]
            pub mod $name {
                use super::*;
                /// Its row.
                #[derive(Clone, Copy, Debug)]
                pub struct Row;
                impl Sampler for Row {
                    const SERVES: Serves = Serves::$serves;
                    calls!(Flight<R>, $how = $call);
                }
            }
        };
    }
    row!(
        analytic,
        ClosedForm,
        closed_form = free_flight::analytic::sample
    );
    row!(
        regular,
        PiecewiseConstant,
        cells = free_flight::regular::sample
    );
    row!(delta, Any, any = free_flight::delta::sample);
    row!(decomposition, Any, any = free_flight::decomposition::sample);
    row!(weighted, Any, any = under_a_bound);

    /// Weighted tracking where the bound holds, to which the suite of all rows keeps: the weight is one.
    fn under_a_bound<R: Real, M: Controlled<R>>(
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> Flight<R> {
        let flight = free_flight::weighted::sample(medium, ray, t_max, rng, active);
        assert!(flight.weight.eq(R::one()).all(), "{:?}", flight.weight);
        flight.flight
    }
}

/// Estimators of transmittance.
pub mod transmittance {
    use super::*;
    use woodcock_core::transmittance;
    use woodcock_core::transmittance::power_series::{Depth, Distance};
    use woodcock_core::transmittance::residual_ratio::{Mean, Minimum};

    /// What is known along a ray: enough to predict most estimators' variance and cost.
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
        /// A constant lower bound [1/length].
        pub minimum: f64,
        /// What the medium is told to be its mean [1/length].
        pub mean: f64,
    }

    impl Known {
        /// E W² of residual ratio tracking under a constant control, and its rate.
        fn residual(&self, control: f64) -> (f64, f64) {
            let rate = (self.majorant - control).max(control - self.minimum);
            let squared = self.squared_integral - 2.0 * control * self.optical_depth
                + control * control * self.t_max;
            ((squared / rate - 2.0 * self.optical_depth).exp(), rate)
        }

        fn delta_moment(&self) -> f64 {
            (-self.optical_depth).exp()
        }
    }

    /// Teeth of the comb's row.
    pub const WALKS: u32 = 16;

    /// What an estimator of transmittance is asked.
    pub trait Estimator {
        /// Which media it serves; only that way may be called.
        const SERVES: Serves;
        /// Every estimate of a medium whose bound is tight is exact, not zero or one.
        const EXACT_WHERE_TIGHT: bool;
        /// So is every estimate of a medium whose bound is tight in each of several segments.
        const EXACT_IN_PIECES: bool;
        /// Between what estimates lie.
        const RANGE: (f64, f64);
        /// An estimate in closed form.
        fn in_closed_form<R: Real, M: ClosedForm<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> R;
        /// An estimate from cell to cell.
        fn in_cells<R: Real, M: PiecewiseConstant<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> R;
        /// An estimate through anything.
        fn in_any<R: Real, M: Controlled<R>>(
            medium: &M,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> R;
        /// An estimate through fog, which every row serves.
        fn in_fog<R: Real>(
            fog: &Homogeneous,
            ray: &Ray<R>,
            t_max: R,
            rng: &mut impl Stream<R>,
            active: R::Mask,
        ) -> R {
            match Self::SERVES {
                Serves::ClosedForm => Self::in_closed_form(fog, ray, t_max, rng, active),
                Serves::PiecewiseConstant => Self::in_cells(fog, ray, t_max, rng, active),
                Serves::Any => Self::in_any(fog, ray, t_max, rng, active),
            }
        }
        /// E W² under a constant bound, where theory says it.
        fn second_moment(known: &Known) -> Option<f64>;
        /// Mean number of look-ups under a constant bound, where theory says it.
        fn lookups(known: &Known) -> Option<f64>;
        /// E W² that sample counts reckon with: where theory is silent, a fourth of delta tracking's variance.
        fn expected_moment(known: &Known) -> f64 {
            let squared_mean = (-2.0 * known.optical_depth).exp();
            let guess = squared_mean + 0.25 * (known.delta_moment() - squared_mean);
            Self::second_moment(known).unwrap_or(guess)
        }
    }

    macro_rules! row {
        (
            $name:ident, $serves:ident, $how:ident = $call:expr,
            exact_where_tight = $exact:literal, exact_in_pieces = $pieces:literal, range = $range:expr,
            second_moment = $second:expr, lookups = $lookups:expr
        ) => {
            #[doc = concat!("`transmittance/", stringify!($name), ".rs`, or a variant of it.")]
            pub mod $name {
                use super::*;
                /// Its row.
                #[derive(Clone, Copy, Debug)]
                pub struct Row;
                impl Estimator for Row {
                    const SERVES: Serves = Serves::$serves;
                    const EXACT_WHERE_TIGHT: bool = $exact;
                    const EXACT_IN_PIECES: bool = $pieces;
                    const RANGE: (f64, f64) = $range;
                    calls!(R, $how = $call);
                    fn second_moment(known: &Known) -> Option<f64> {
                        let second: fn(&Known) -> Option<f64> = $second;
                        second(known)
                    }
                    fn lookups(known: &Known) -> Option<f64> {
                        let lookups: fn(&Known) -> Option<f64> = $lookups;
                        lookups(known)
                    }
                }
            }
        };
    }

    /// Weights that are probabilities, and rounding.
    const UNIT: (f64, f64) = (0.0, 1.0 + 1e-6);

    row!(
        analytic,
        ClosedForm,
        closed_form =
            |medium, ray, t_max, _, _| transmittance::analytic::estimate(medium, ray, t_max),
        exact_where_tight = true,
        exact_in_pieces = true,
        range = UNIT,
        second_moment = |k| Some((-2.0 * k.optical_depth).exp()),
        lookups = |_| Some(0.0)
    );
    row!(
        regular,
        PiecewiseConstant,
        cells = |medium, ray, t_max, _, active| transmittance::regular::estimate(
            medium, ray, t_max, active
        ),
        exact_where_tight = true,
        exact_in_pieces = true,
        range = UNIT,
        second_moment = |k| Some((-2.0 * k.optical_depth).exp()),
        lookups = |_| Some(0.0)
    );
    row!(
        delta,
        Any,
        any = transmittance::delta::estimate,
        exact_where_tight = false,
        exact_in_pieces = false,
        range = UNIT,
        second_moment = |k| Some(k.delta_moment()),
        lookups = |k| Some(k.majorant * k.mean_free_flight)
    );
    row!(
        ratio,
        Any,
        any = transmittance::ratio::estimate,
        exact_where_tight = false,
        exact_in_pieces = false,
        range = UNIT,
        second_moment = |k| Some((k.squared_integral / k.majorant - 2.0 * k.optical_depth).exp()),
        lookups = |k| Some(k.majorant * k.t_max)
    );
    row!(
        residual_ratio,
        Any,
        any = transmittance::residual_ratio::estimate::<Mean, R, M>,
        exact_where_tight = true,
        exact_in_pieces = true,
        range = (0.0, f64::INFINITY),
        second_moment = |k| Some(k.residual(k.mean).0),
        lookups = |k| Some(k.residual(k.mean).1 * k.t_max)
    );
    row!(
        residual_ratio_minimum,
        Any,
        any = transmittance::residual_ratio::estimate::<Minimum, R, M>,
        exact_where_tight = true,
        exact_in_pieces = true,
        range = UNIT,
        second_moment = |k| Some(k.residual(k.minimum).0),
        lookups = |k| Some(k.residual(k.minimum).1 * k.t_max)
    );
    row!(
        comb,
        Any,
        any = |medium, ray, t_max, rng, active| transmittance::comb::estimate(
            medium, ray, t_max, WALKS, rng, active
        ),
        exact_where_tight = true,
        exact_in_pieces = true,
        range = UNIT,
        second_moment = |_| None,
        lookups = |_| None
    );
    row!(
        power_series,
        Any,
        any = transmittance::power_series::estimate::<Distance, R, M>,
        exact_where_tight = true,
        exact_in_pieces = false,
        range = (f64::NEG_INFINITY, f64::INFINITY),
        second_moment = |_| None,
        lookups = |_| None
    );
    row!(
        power_series_depth,
        Any,
        any = transmittance::power_series::estimate::<Depth, R, M>,
        exact_where_tight = true,
        exact_in_pieces = true,
        range = (f64::NEG_INFINITY, f64::INFINITY),
        second_moment = |_| None,
        lookups = |_| None
    );
}
