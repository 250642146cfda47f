//! Lanes against scalars, bit by bit: flights and transmittance of each ray are those that scalar code finds.

use super::colours;
use woodcock_core::medium::{IDENTITY, Procedural};
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::spectral::{Coloured, SpectralMedium, transmittance};
use woodcock_core::stream::{Key, KeyedStream, PathStream};
use woodcock_core::vec3::Vec3;
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::{LANES, LaneMask, Lanes};
use woodcock_tests::grids::{TestGrid, unit};
use woodcock_tests::rows::spectral::Way;
use woodcock_tests::stats::independent::SplitMix;
use woodcock_tests::widths::per_lane;

/// What is compared: a function of a ray, its length and its stream, at each width.
trait Compared<const N: usize> {
    fn at<R: Real>(
        medium: &impl SpectralMedium<R, N>,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl KeyedStream<R>,
        active: R::Mask,
    ) -> Vec<R>;
}

/// The distance, one where it is a collision, and the weights.
struct OfFlights<T>(T);
impl<T: Way, const N: usize> Compared<N> for OfFlights<T> {
    fn at<R: Real>(
        medium: &impl SpectralMedium<R, N>,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl KeyedStream<R>,
        active: R::Mask,
    ) -> Vec<R> {
        let found = T::sample(medium, ray, t_max, rng, active);
        let mut numbers = found.weight.0.to_vec();
        numbers.extend([found.flight.t, R::one().or_zero(found.flight.collided)]);
        numbers
    }
}

/// The weights.
struct OfShadows;
impl<const N: usize> Compared<N> for OfShadows {
    fn at<R: Real>(
        medium: &impl SpectralMedium<R, N>,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl KeyedStream<R>,
        active: R::Mask,
    ) -> Vec<R> {
        let weight = transmittance::estimate(medium, ray, t_max, rng, active);
        weight.0.to_vec()
    }
}

/// Rays of all lengths from the box [0, size], in some lanes.
fn compare<C: Compared<N>, const N: usize>(
    one: &impl SpectralMedium<f32, N>,
    eight: &impl SpectralMedium<Lanes, N>,
    size: [f64; 3],
) {
    let mut random = SplitMix::new(416);
    let mut differing = std::collections::BTreeSet::new();
    for round in 0..300_u32 {
        let mut along = Ray {
            origin: Vec3::<Lanes>::uniform(0.0),
            direction: Vec3::uniform(0.0),
        };
        let mut t_max = Lanes::zero();
        let mut wide = <LaneStream as KeyedStream<Lanes>>::idle();
        let key = |lane: usize| Key {
            seed: 417,
            pixel: round,
            sample: lane as u32,
        };
        for lane in 0..LANES {
            let origin = size.map(|s| s * random.uniform());
            let direction = unit([random.normal(), random.normal(), random.normal()]);
            let exit = (0..3).map(|a| {
                let far = if direction[a] > 0.0 { size[a] } else { 0.0 };
                (far - origin[a]) / direction[a]
            });
            along.origin.set_lane(lane, origin.map(|v| v as f32));
            along.direction.set_lane(lane, direction.map(|v| v as f32));
            t_max.set_lane(lane, exit.fold(f64::INFINITY, f64::min) as f32);
            wide.set_key(lane, key(lane));
        }
        let active = LaneMask::from_bits(random.bits() as u32 & 255);
        let found = C::at(eight, &along, t_max, &mut wide, active);
        for lane in (0..LANES).filter(|&lane| active.lane(lane)) {
            let single = Ray {
                origin: Vec3::splat(along.origin.lane(lane)),
                direction: Vec3::splat(along.direction.lane(lane)),
            };
            let mut rng = PathStream::new(key(lane));
            let expected = C::at(one, &single, t_max.lane(lane), &mut rng, true);
            for (found, expected) in found.iter().zip(&expected) {
                let found = found.lane(lane).to_bits();
                assert_eq!(found, expected.to_bits(), "round {round}, lane {lane}");
                differing.insert(found);
            }
        }
    }
    assert!(differing.len() > 100, "only {} values", differing.len());
}

fn everywhere<C: Compared<N>, const N: usize>() {
    let colours = colours::<N>();
    let field = |x: f64, y: f64, z: f64| 2.0 + (3.0 * x).sin() + (2.0 * y * z).cos();
    let one = Procedural::new(per_lane::<f32>(field), 4.1);
    let eight = Procedural::new(per_lane::<Lanes>(field), 4.1);
    let one = Coloured::new(one, colours).expect("valid colours");
    let eight = Coloured::new(eight, colours).expect("valid colours");
    compare::<C, N>(&one, &eight, [2.0, 1.5, 3.0]);
    let grid = TestGrid::cloud([33, 26, 25], 418);
    let cloud = Coloured::new(grid.medium(IDENTITY, 0.5), colours).expect("valid colours");
    compare::<C, N>(&cloud, &cloud, grid.dims.map(|n| f64::from(n - 1)));
}

pub(super) fn lanes_have_the_bits_of_scalars<T: Way, const N: usize>() {
    everywhere::<OfFlights<T>, N>();
}

#[test]
fn shadows_have_the_bits_of_scalars() {
    everywhere::<OfShadows, 1>();
    everywhere::<OfShadows, 3>();
    everywhere::<OfShadows, 4>();
    everywhere::<OfShadows, 8>();
}
