//! Each wavelength's transmittance and its law of the distance, on closed-form fields and on a grid.

use super::{COLOURS, Flown, assert_mean, colours, fly, set_keys};
use std::array;
use woodcock_core::majorant::Process;
use woodcock_core::medium::{IDENTITY, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::spectral::{
    Coloured, ColouredBy, Flights, SpectralMedium, Spectrum, transmittance,
};
use woodcock_core::stream::KeyedStream;
use woodcock_core::vec3::Vec3;
use woodcock_tests::depth::Depth;
use woodcock_tests::each_width;
use woodcock_tests::fixtures::{self, Fixture};
use woodcock_tests::grids::{TestGrid, chord};
use woodcock_tests::rows::spectral::Way;
use woodcock_tests::stats::{Moments, Sample, judge, must_kill, samples, seed};
use woodcock_tests::widths::{everyone, per_lane, ray, width};

/// The relative standard error that each mean must reach.
const RESOLUTION: f64 = 0.005;
/// Paths of a field.
const PATHS: usize = 1 << 18;
/// Optical depth of the most opaque wavelength: as deep as so many paths can resolve.
const DEPTH: f64 = 1.35;
/// Quarters before which a smaller share of paths collides would need more of them.
const SHARE: f64 = 0.28;

/// One ray of each field, its density scaled to a known optical depth; the numbers of wavelengths share the fields
/// among them.
fn scaled(n: usize) -> Vec<(u32, Fixture, f64)> {
    let every_field = fixtures::all().into_iter().step_by(4);
    let chosen = (0..).zip(every_field);
    chosen
        .filter(|(i, _)| [1, 3, 4, 8][*i as usize % 4] == n)
        .map(|(i, fixture)| {
            let scale = DEPTH / fixture.ray.optical_depth;
            (i, fixture, scale)
        })
        .collect()
}

/// As many paths as a width needs, and how finely it looks: other widths repeat what `f32` drew.
fn effort<R: Real>() -> (usize, f64) {
    if width::<R>() == "f32" {
        (samples(PATHS), RESOLUTION)
    } else {
        (samples(PATHS / 8), 3.0 * RESOLUTION)
    }
}

/// Weights of paths by what became of them: collided within each quarter, or left.
struct Tally<const N: usize> {
    t_max: f64,
    paths: u64,
    quarters: [[Moments; N]; 4],
    left: [Moments; N],
    /// The first wavelength's transmittance, path by path.
    in_order: Sample,
}

impl<const N: usize> Tally<N> {
    fn new(t_max: f64) -> Self {
        Self {
            t_max,
            paths: 0,
            quarters: [[Moments::new(); N]; 4],
            left: [Moments::new(); N],
            in_order: Sample::new(),
        }
    }

    fn push(&mut self, path: &Flown<N>) {
        self.paths += 1;
        let quarter = (path.t / self.t_max * 4.0).ceil() - 1.0;
        let fate = match self.quarters.get_mut(quarter as usize) {
            Some(quarter) => quarter,
            None => &mut self.left,
        };
        for (moments, w) in fate.iter_mut().zip(path.weight) {
            moments.push(w);
        }
        self.in_order
            .push(if path.left() { path.weight[0] } else { 0.0 });
    }

    /// Moments of the weights that were counted, all others being zero.
    fn among_all(&self, counted: &Moments) -> Moments {
        let mut zeros = Moments::new();
        zeros.push(0.0);
        let mut all = *counted;
        let mut rest = self.paths - counted.count();
        while rest > 0 {
            if rest & 1 == 1 {
                all.merge(&zeros);
            }
            zeros.merge(&zeros.clone());
            rest >>= 1;
        }
        all
    }

    /// * `depths`: each wavelength's optical depth up to each quarter.
    fn assert_laws(&self, name: &str, resolution: f64, depths: [[f64; 4]; N]) {
        let verdict = self.in_order.judge_blocks();
        assert!(
            verdict.agrees(),
            "{name}: paths are not independent: {verdict:?}"
        );
        for (i, (left, depths)) in self.left.iter().zip(&depths).enumerate() {
            let name = format!("{name}, wavelength {i} leaves");
            assert_mean(&name, &self.among_all(left), (-depths[3]).exp(), resolution);
        }
        let mut before = [Moments::new(); N];
        let mut looked = 0;
        for (quarter, inside) in self.quarters.iter().enumerate() {
            for (before, inside) in before.iter_mut().zip(inside) {
                before.merge(inside);
            }
            let collided = depths.map(|d| -(-d[quarter]).exp_m1());
            if collided.iter().sum::<f64>() < SHARE * N as f64 {
                continue;
            }
            looked += 1;
            for (i, (before, truth)) in before.iter().zip(collided).enumerate() {
                let name = format!("{name}, wavelength {i} before quarter {}", quarter + 1);
                assert_mean(&name, &self.among_all(before), truth, resolution);
            }
        }
        assert!(looked > 0, "{name}: no quarter was looked at");
    }
}

pub(super) fn fields_have_each_wavelengths_law<T: Way, const N: usize>() {
    for (pixel, fixture, scale) in scaled(N) {
        let t_max = f64::from(fixture.ray.t_max as f32);
        let depth = Depth::new(t_max, 300, &fixture.breaks(), fixture.along());
        let depths = colours::<N>().map(|c| {
            array::from_fn(|i| f64::from(c) * scale * depth.at(t_max * (i + 1) as f64 / 4.0))
        });
        each_width!(R, S => {
            let name = format!("{} {N} {}", fixture.name, width::<R>());
            let field = fixture.sigma_t();
            let medium = Procedural::new(
                per_lane::<R>(|x, y, z| scale * field(x, y, z)),
                ((fixture.majorant * scale) as f32).next_up(),
            );
            let medium = Coloured::new(medium, colours::<N>()).expect("valid colours");
            let along: Ray<R> = ray(fixture.ray.origin, fixture.ray.dir);
            let (n, resolution) = effort::<R>();
            let mut tally = Tally::<N>::new(t_max);
            fly::<T, R, S, _, N>(&medium, &along, t_max, (seed(401), pixel), n, |path| {
                if T::BOUNDED {
                    path.assert_bounded(&name);
                }
                tally.push(&path);
            });
            tally.assert_laws(&name, resolution, depths);
        });
    }
}

/// A colour that turns along the ray: σ_λ as a function of the place.
fn turning<R: Real, const N: usize>() -> impl Fn(Vec3<R>) -> Spectrum<R, N> {
    let colour = |i: usize| per_lane::<R>(move |x, _, _| turning_colour(i, x));
    let each: [_; N] = array::from_fn(colour);
    move |place| Spectrum(array::from_fn(|i| each[i](place)))
}

fn turning_colour(i: usize, x: f64) -> f64 {
    let phase = x * 3.0 + i as f64 * 1.3;
    0.5 + 0.5 * phase.sin()
}

pub(super) fn a_grid_has_each_wavelengths_law<T: Way, const N: usize>() {
    let grid = TestGrid::cloud([33, 26, 25], 402);
    let middle = grid.dims.map(|n| 0.5 * f64::from(n - 1));
    let chord = chord(grid.dims, middle, [1.0, 0.4, -0.3]);
    let once = grid.depth(chord.origin, chord.direction, chord.t_max, 1.0);
    let scale = (DEPTH / once.total()) as f32;
    let medium = grid.medium(IDENTITY, scale);
    let quarter = |i: usize| chord.t_max * (i + 1) as f64 / 4.0;
    let along_x = |t: f64| chord.origin[0] + t * chord.direction[0];
    let sigma_t = |t: f64| {
        let place = array::from_fn(|a| chord.origin[a] + t * chord.direction[a]);
        f64::from(scale) * grid.at(place)
    };
    // The same colours everywhere, and colours that turn with the place.
    let constant =
        COLOURS.map(|c| array::from_fn(|i| f64::from(c) * f64::from(scale) * once.at(quarter(i))));
    let turned: [[f64; 4]; N] = array::from_fn(|i| {
        let depth = Depth::new(chord.t_max, 2000, &[], |t| {
            turning_colour(i, 0.1 * along_x(t)) * sigma_t(t)
        });
        array::from_fn(|q| depth.at(quarter(q)))
    });
    each_width!(R, S => {
        let along: Ray<R> = ray(chord.origin, chord.direction);
        let (n, resolution) = effort::<R>();
        let coloured = Coloured::new(medium, colours::<N>()).expect("valid colours");
        let mut tally = Tally::<N>::new(chord.t_max);
        let key = (seed(403), 0);
        fly::<T, R, S, _, N>(&coloured, &along, chord.t_max, key, n, |path| tally.push(&path));
        let name = format!("cloud {N} {}", width::<R>());
        tally.assert_laws(&name, resolution, array::from_fn(|i| constant[i]));

        let turn = turning::<R, N>();
        let by_place = ColouredBy::new(medium, |p: Vec3<R>| turn(p * R::splat(0.1)));
        let mut tally = Tally::<N>::new(chord.t_max);
        let key = (seed(403), 1);
        fly::<T, R, S, _, N>(&by_place, &along, chord.t_max, key, n, |path| tally.push(&path));
        let name = format!("cloud whose colour turns {N} {}", width::<R>());
        tally.assert_laws(&name, resolution, turned);
    });
}

/// A path of two stretches, in every lane: its weights in the end, and what the second stretch alone did to them.
fn two_stretches<T: Way, R: Real, S: KeyedStream<R>, M: SpectralMedium<R, N>, const N: usize>(
    medium: &M,
    first: usize,
) -> Vec<(Flown<N>, [f64; N])> {
    let mut rng = S::idle();
    set_keys(&mut rng, seed(404), 0, first);
    let along: Ray<R> = ray([0.0; 3], [1.0, 0.0, 0.0]);
    let mut state = Flights::idle(medium, T::decision::<R, N>());
    state.begin(medium, &along, R::one(), &mut rng, everyone::<R>());
    state.run(medium, &mut rng);
    let before = state.flight();
    let left = !before.flight.collided;
    let along: Ray<R> = ray([0.3, 0.0, 0.0], [1.0, 0.0, 0.0]);
    state.onward(medium, &along, R::splat(0.5), &mut rng, left);
    state.run(medium, &mut rng);
    let after = state.flight();
    assert!(
        (left | after.flight.collided).all(),
        "a first collision is forgotten"
    );
    let of_lane = |lane| {
        let (path, before) = (Flown::of(&after, lane), Flown::of(&before, lane));
        let second = array::from_fn(|i| path.weight[i] / before.weight[i]);
        (path, second)
    };
    (0..R::LANES).map(of_lane).collect()
}

/// Weights and heroes are kept from flight to flight, and the product of both stretches' laws comes out.
pub(super) fn flights_go_on_with_their_history<T: Way, const N: usize>() {
    // A ramp: τ = 1² on the first stretch, 0.8² − 0.3² on the second.
    let depth = 1.0 + (0.64 - 0.09);
    each_width!(R, S => {
        let ramp = Procedural::new(per_lane::<R>(|x, _, _| 2.0 * x), 2.1);
        let medium = Coloured::new(ramp, colours::<N>()).expect("valid colours");
        let (n, resolution) = effort::<R>();
        let [mut left, mut forgetful] = [[Moments::new(); N]; 2];
        for first in (0..n).step_by(R::LANES) {
            for (path, second) in two_stretches::<T, R, S, _, N>(&medium, first) {
                for i in 0..N {
                    left[i].push(if path.left() { path.weight[i] } else { 0.0 });
                    forgetful[i].push(if path.left() { second[i] } else { 0.0 });
                }
            }
        }
        let truth = colours::<N>().map(|c| (-f64::from(c) * depth).exp());
        for i in 0..N {
            let name = format!("two stretches, wavelength {i} of {N} {}", width::<R>());
            assert_mean(&name, &left[i], truth[i], resolution);
        }
        if N > 1 {
            let verdict = judge(&forgetful[0], truth[0], resolution);
            must_kill("a second flight without history", verdict);
        }
    });
}

/// Ratio tracking: each wavelength its own factor at shared places, which correlates them as stated.
fn transmittances<const N: usize>() {
    for (pixel, fixture, scale) in scaled(N) {
        let t_max = f64::from(fixture.ray.t_max as f32);
        let depth = Depth::new(t_max, 300, &fixture.breaks(), fixture.along());
        let majorant = ((fixture.majorant * scale) as f32).next_up();
        let depths = colours::<N>().map(|c| f64::from(c) * scale * depth.total());
        // With the first wavelength, this one.
        let other = N.min(3) - 1;
        let colour = f64::from(COLOURS[other]);
        let shared = colour * scale * scale * depth.squared_integral() / f64::from(majorant);
        let product = (shared - depths[0] - depths[other]).exp();
        each_width!(R, S => {
            let field = fixture.sigma_t();
            let medium = Procedural::new(per_lane::<R>(|x, y, z| scale * field(x, y, z)), majorant);
            let medium = Coloured::new(medium, colours::<N>()).expect("valid colours");
            let along: Ray<R> = ray(fixture.ray.origin, fixture.ray.dir);
            let (n, resolution) = effort::<R>();
            let n = n / 2; // enough for weights in [0, 1]
            let mut weights = [Moments::new(); N];
            let mut products = Moments::new();
            let mut rng = <S as KeyedStream<R>>::idle();
            for first in (0..n).step_by(R::LANES) {
                set_keys::<R, S>(&mut rng, seed(405), pixel, first);
                let end = R::splat(t_max as f32);
                let w = transmittance::estimate(&medium, &along, end, &mut rng, everyone::<R>());
                for lane in 0..R::LANES {
                    let w = w.lane(lane).map(f64::from);
                    for (moments, w) in weights.iter_mut().zip(w) {
                        moments.push(w);
                    }
                    products.push(w[0] * w[other]);
                }
            }
            let name = format!("{} of {N} {}", fixture.name, width::<R>());
            for (weights, depth) in weights.iter().zip(depths) {
                assert_mean(&name, weights, (-depth).exp(), resolution);
                assert!(weights.min() >= -1e-6 && weights.max() <= 1.0, "{name}: {weights:?}");
            }
            assert_mean(&name, &products, product, 4.0 * resolution);
            if N > 1 && width::<R>() == "f32" {
                let grey = judge(&weights[0], (-depths[1]).exp(), resolution);
                must_kill("one wavelength's weight for another's", grey);
                let apart = (-depths[0] - depths[other]).exp();
                must_kill("independent wavelengths", judge(&products, apart, 4.0 * resolution));
            }
        });
    }
}

#[test]
fn shadows_have_each_wavelengths_transmittance() {
    transmittances::<1>();
    transmittances::<3>();
    transmittances::<4>();
    transmittances::<8>();
}
