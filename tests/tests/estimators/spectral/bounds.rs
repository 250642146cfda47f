//! Bounds of the weights and their second moments, on rays, on long paths, and where nothing is left to chance.

use super::weights::follow;
use super::{Flown, colours, fly, set_keys};
use std::array;
use woodcock_core::medium::{Homogeneous, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::spectral::{
    Coloured, Decision, SpectralFlight, SpectralMedium, Spectrum, Tentative, hero, history_aware,
    weighted,
};
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_tests::each_width;
use woodcock_tests::rows::spectral::{Way, own_probability};
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::stats::{Moments, Sample, assert_agrees, judge, must_kill, samples, seed};
use woodcock_tests::widths::{no_one, per_lane, ray, width};

/// What needs no statistics: nothing collides in vacuum, whatever bounds it; where all is opaque the first tentative
/// collision is real, at weight one; lanes that never began do nothing.
pub(super) fn extremes_are_exact<T: Way, const N: usize>() {
    fn exactly<T: Way, R: Real, S: KeyedStream<R>, const N: usize>(
        medium: &impl SpectralMedium<R, N>,
        t_max: f64,
        expected: impl Fn(&Flown<N>) -> bool,
    ) {
        let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
        fly::<T, R, S, _, N>(medium, &along, t_max, (407, 0), 1000, |path| {
            assert!(expected(&path), "{t_max} {}: {path:?}", width::<R>());
        });
    }
    let vacuum = Homogeneous::new(0.0).expect("vacuum is a medium");
    let wall = Homogeneous::new(1e20).expect("a valid extinction");
    let coloured = Coloured::new(vacuum, colours::<N>()).expect("valid colours");
    let opaque = Coloured::new(wall, [1.0; N]).expect("valid colours");
    let ones = [1.0; N];
    each_width!(R, S => {
        for t_max in [0.0, 1e-30, 1.0, 1e30] {
            exactly::<T, R, S, N>(&coloured, t_max, |p| p.left() && p.weight == ones);
        }
        exactly::<T, R, S, N>(&opaque, 0.0, |p| p.left() && p.weight == ones);
        exactly::<T, R, S, N>(&opaque, 1.0, |p| p.t < 1e-18 && p.weight == ones);
        // Vacuum, and clear colours, that their bound does not know of: weights of one but for rounding.
        let near = |p: &Flown<N>| p.left() && p.weight.iter().all(|w| (w - 1.0).abs() < 3e-5);
        let unknown = Procedural::new(per_lane::<R>(|_, _, _| 0.0), 50.0);
        let unknown = Coloured::new(unknown, colours::<N>()).expect("valid colours");
        exactly::<T, R, S, N>(&unknown, 1.0, near);
        let clear = Procedural::new(per_lane::<R>(|_, _, _| 40.0), 50.0);
        let clear = Coloured::new(clear, [0.0; N]).expect("valid colours");
        exactly::<T, R, S, N>(&clear, 1.0, near);
        let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
        let mut rng = <S as KeyedStream<R>>::idle();
        let before = format!("{rng:?}");
        let idle = T::sample(&clear, &along, R::one(), &mut rng, no_one::<R>());
        assert!(!idle.flight.collided.any() && idle.weight.is_zero().all(), "{idle:?}");
        assert_eq!(before, format!("{rng:?}"));
    });
}

/// A hundred thousand collisions of a path, among extinctions that differ by a factor of a million or without limit,
/// in units from 10⁻³⁰ to 10³⁰: weights stay finite, and a bounded way keeps its promise.
pub(super) fn long_paths_stay_finite<T: Way, const N: usize>() {
    for (pixel, unit) in (0..).zip([1e-30_f32, 1.0, 1e30]) {
        let mut events = SplitMix::new(408);
        let mut rng = <PathStream as KeyedStream<f32>>::idle();
        set_keys::<f32, _>(&mut rng, 409, pixel, 0);
        let mut state = T::decision::<f32, N>();
        state.begin(&mut rng, true);
        let mut reals = 0;
        for step in 0..100_000 {
            let colour = |bits: u64| [1.0, 0.01, 1e-6, 0.0][(bits % 4) as usize];
            let event = Tentative {
                sigma_t: unit * events.uniform() as f32,
                majorant: unit,
                colour: Spectrum(array::from_fn(|_| colour(events.bits()))),
            };
            reals += u32::from(state.decide(&event, &mut rng, true));
            let weight = state.weight();
            let valid = weight.0.iter().all(|w| (0.0..f32::INFINITY).contains(w));
            assert!(valid, "step {step}: {weight:?}");
            if T::BOUNDED {
                // What rounding adds to the mean in so many steps.
                let mean = weight.sum() / N as f32;
                assert!((mean - 1.0).abs() < 1e-3, "step {step}: {weight:?}");
            }
        }
        assert!((1000..90_000).contains(&reals), "{reals} real collisions");
    }
}

/// P(k events) of a Poisson process with this mean, k = 0, 1, …
fn poisson(mean: f64) -> impl Iterator<Item = f64> {
    let mut p = (-mean).exp();
    (1..).map(move |k| {
        let now = p;
        p *= mean / f64::from(k);
        now
    })
}

/// E[w² · 1(leaves)] and E[w² · 1(collides)] by wavelength, in fog of a given share of its bound.
///
/// ```text
/// Σₖ P(k events) pₖ² / qₖ,   Σₖ P(more than k events) p'ₖ² / q'ₖ
/// ```
///
/// p being what the wavelength alone gives k null collisions (then a real one), q what the way gives them.
fn second_moments<T: Way, const N: usize>(share: f64, events: f64) -> [[f64; 2]; N] {
    let colour = colours::<N>().map(f64::from);
    let square = |c: f64, nulls: usize, real: bool| {
        let nulls = nulls as i32;
        let own = own_probability(c, share, nulls, real);
        let drawn = T::probability(colour, share, nulls, real);
        if own > 0.0 { own * own / drawn } else { 0.0 }
    };
    let probabilities: Vec<f64> = poisson(events).take(100).collect();
    // From the far end on, so that small ones are not lost in rounding.
    let mut more = 0.0;
    let mut moments = [[0.0; 2]; N];
    for (nulls, p) in probabilities.into_iter().enumerate().rev() {
        for (moments, c) in moments.iter_mut().zip(colour) {
            moments[0] += p * square(c, nulls, false);
            moments[1] += more * square(c, nulls, true);
        }
        more += p;
    }
    moments
}

/// Fog of extinction one on [0, `FOG_END`), under each of these bounds.
const FOG_MAJORANTS: [f32; 2] = [1.5, 2.5];
const FOG_END: f64 = 1.5;

/// Moments of w² by wavelength, of paths that leave and of those that collide.
fn squares<T: Way, const N: usize>(majorant: f32) -> [[Moments; 2]; N] {
    let fog = Procedural::new(per_lane::<f32>(|_, _, _| 1.0), majorant);
    let medium = Coloured::new(fog, colours::<N>()).expect("valid colours");
    let along = ray([0.0; 3], [0.0, 1.0, 0.0]);
    let mut squares = [[Moments::new(); 2]; N];
    let (n, key) = (samples(1 << 18), (seed(410), majorant.to_bits()));
    fly::<T, f32, PathStream, _, N>(&medium, &along, FOG_END, key, n, |path| {
        for ([left, collided], w) in squares.iter_mut().zip(path.weight) {
            left.push(if path.left() { w * w } else { 0.0 });
            collided.push(if path.left() { 0.0 } else { w * w });
        }
    });
    squares
}

fn fog_moments<T: Way, const N: usize>(majorant: f32) -> [[f64; 2]; N] {
    let majorant = f64::from(majorant);
    second_moments::<T, N>(1.0 / majorant, FOG_END * majorant)
}

pub(super) fn second_moments_are_those_of_theory<T: Way, const N: usize>() {
    for majorant in FOG_MAJORANTS {
        let truths = fog_moments::<T, N>(majorant);
        for (i, (squares, truths)) in squares::<T, N>(majorant).iter().zip(truths).enumerate() {
            for ((square, truth), what) in squares.iter().zip(truths).zip(["leaves", "collides"]) {
                let name = format!("wavelength {i} of {N} {what} under {majorant}");
                super::assert_mean(&name, square, truth, 0.025);
            }
        }
    }
}

/// Weights of the same means but another spread are noticed.
#[test]
fn another_second_moment_is_seen() {
    use woodcock_tests::rows::spectral::{hero, weighted};
    let [[_, collided], ..] = squares::<weighted::Row, 3>(FOG_MAJORANTS[0]);
    let [[_, truth], ..] = fog_moments::<hero::Row, 3>(FOG_MAJORANTS[0]);
    must_kill(
        "probabilities without history",
        judge(&collided, truth, 0.025),
    );
}

/// Where one wavelength is followed through a medium twice as clear to another, the weights of the other grow without
/// a bound and its mean cannot be measured; the bounded ways measure it from as many paths.
#[test]
fn following_one_wavelength_has_no_bound() {
    let fog = Procedural::new(per_lane::<f32>(|_, _, _| 1.0), 2.0);
    let medium = Coloured::new(fog, [1.0, 0.05]).expect("valid colours");
    let (along, t_max) = (ray([0.0; 3], [1.0, 0.0, 0.0]), 40.0);
    let truth = -(-0.05 * f64::from(t_max)).exp_m1();
    let of = |way: &mut dyn FnMut(&mut PathStream) -> SpectralFlight<f32, 2>| {
        let mut rng = <PathStream as KeyedStream<f32>>::idle();
        let mut moments = Moments::new();
        for path in 0..samples(1 << 17) {
            set_keys::<f32, _>(&mut rng, seed(411), 0, path);
            let found = Flown::of(&way(&mut rng), 0);
            moments.push(if found.left() { 0.0 } else { found.weight[1] });
        }
        moments
    };
    let followed = of(&mut |rng| weighted::sample(&medium, &along, t_max, follow, rng, true));
    assert!(
        !judge(&followed, truth, 0.005).agrees() && followed.max() > 100.0,
        "one wavelength serves for all: {followed:?} for {truth}"
    );
    let history = of(&mut |rng| history_aware::sample(&medium, &along, t_max, rng, true));
    let mixed = of(&mut |rng| hero::sample(&medium, &along, t_max, rng, true));
    for bounded in [history, mixed] {
        assert!(
            judge(&bounded, truth, 0.005).agrees(),
            "{bounded:?} for {truth}"
        );
        assert!(bounded.max() <= 2.0 + 1e-5, "{bounded:?}");
    }
}

/// A bound that the most opaque wavelength exceeds: weights change sign, means stay.
#[test]
fn a_bound_too_low_changes_signs_not_means() {
    let (majorant, t_max) = (1.6, 1.0);
    let ramp = Procedural::new(per_lane::<f32>(|x, _, _| 2.0 * x), majorant);
    let medium = Coloured::new(ramp, colours::<3>()).expect("valid colours");
    let along = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let mut left = [Sample::new(); 3];
    let mut rng = <PathStream as KeyedStream<f32>>::idle();
    for path in 0..samples(1 << 18) {
        set_keys::<f32, _>(&mut rng, seed(412), 0, path);
        let half = |e: &Tentative<f32, 3>, _| 0.5 * e.sigma_t / e.majorant;
        let found = weighted::sample(&medium, &along, t_max, half, &mut rng, true);
        let found = Flown::of(&found, 0);
        for (left, w) in left.iter_mut().zip(found.weight) {
            left.push(if found.left() { w } else { 0.0 });
        }
    }
    assert!(left[0].moments().min() < -0.1, "no weight changed its sign");
    for (left, c) in left.iter().zip(colours::<3>()) {
        assert_agrees("a bound too low", left, (-f64::from(c)).exp(), 0.005);
    }
}

#[test]
fn colours_are_refused_beyond_their_range() {
    let fog = Homogeneous::new(1.0).expect("a valid extinction");
    for bad in [-0.1, 1.000_001, f32::NAN, f32::INFINITY] {
        let error = Coloured::new(fog, [0.0, 1.0, bad]).expect_err("no colour");
        assert_eq!(error.wavelength, 2);
        assert!(error.to_string().contains("wavelength 2"), "{error}");
    }
    assert!(Coloured::new(fog, [0.0, -0.0, 1.0]).is_ok());
}
