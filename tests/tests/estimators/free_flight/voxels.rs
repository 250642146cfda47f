//! Voxels of constant extinction: every sampler that serves them, on rays along faces and edges as well.

use super::{COARSE, PATHS, SHARP, distance, judge};
use woodcock_core::free_flight::Flight;
use woodcock_core::medium::{Controlled, IDENTITY, PiecewiseConstant};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::Stream;
use woodcock_tests::each_width;
use woodcock_tests::rows::Serves;
use woodcock_tests::rows::free_flight::Sampler;
use woodcock_tests::stats::{assert_verdict, samples, seed};
use woodcock_tests::voxels;
use woodcock_tests::widths::{collect, everyone, ray, width};

fn sample<T: Sampler, R: Real, M: PiecewiseConstant<R> + Controlled<R>>(
    medium: &M,
    ray: &Ray<R>,
    t_max: R,
    rng: &mut impl Stream<R>,
) -> Flight<R> {
    let all = everyone::<R>();
    match T::SERVES {
        Serves::PiecewiseConstant => T::in_cells(medium, ray, t_max, rng, all),
        _ => T::in_any(medium, ray, t_max, rng, all),
    }
}

pub(super) fn law<T: Sampler>() {
    if T::SERVES == Serves::ClosedForm {
        return;
    }
    for (pixel, (name, voxels, chord, scale)) in (0..).zip(voxels::cases()) {
        let once = f64::from(scale);
        let depth = voxels.depth(chord.origin, chord.direction, chord.t_max, once);
        let medium = voxels.medium(IDENTITY, scale);
        each_width!(R, S => {
            let along: Ray<R> = ray(chord.origin, chord.direction);
            let end = R::splat(chord.t_max as f32);
            let sharp = width::<R>() == "f32";
            let (n, resolution) = if sharp { (PATHS, SHARP) } else { (PATHS / 8, COARSE) };
            let flights = collect::<R, S>(seed(17), pixel, samples(n), |rng| {
                distance(sample::<T, R, _>(&medium, &along, end, rng), end)
            });
            let (law, share) = judge(flights, chord.t_max, resolution, |t| depth.collided(t));
            let name = format!("{name}, {}", width::<R>());
            assert_verdict(&name, law);
            assert_verdict(&name, share);
        });
    }
}
