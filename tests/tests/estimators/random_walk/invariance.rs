//! Invariants of scattering bodies under uniform light: lengths of paths, and numbers of collisions, real and null.
//!
//! A look-up of the extinction is a tentative collision; a counter inside the medium counts them, and those that are
//! not real are null. Any phase function gives the same means, so each body gets another. Left out: bodies that are
//! neither ball nor block, which would test the geometry of this file only.

use super::{Ledger, honest_and, judge_near, names, record};
use std::cell::Cell;
use woodcock_core::ray::{FAR, Ray, clip_to_unit_sphere};
use woodcock_core::vec3::Vec3;
use woodcock_tests::refs::invariance::{Case, FirstFlight, Shape, load};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{
    Ball, Block, Closed, Draws, Flights, HenyeyGreenstein, Isotropic, Law, Lit, Mistake, Rayleigh,
    Run, UnderBound, Walk, ray, tally, vector,
};

/// A ray that uniform light sends into a body.
fn enter(body: &impl Lit, draws: &mut Draws) -> Ray<f32> {
    let u = std::array::from_fn(|_| draws.uniform());
    let (origin, normal) = body.surface(u);
    Ray {
        origin,
        direction: draws.lambertian(normal),
    }
}

/// The length of `[0, t)` of a ray within a ball.
fn within(ray: &Ray<f32>, t: f32, center: Vec3<f32>, radius: f32) -> f32 {
    let scale = 1.0 / radius;
    let part = clip_to_unit_sphere((ray.origin - center) * scale, ray.direction * scale);
    (part.t1.min(t) - part.t0).max(0.0)
}

/// Length of the path, the part of it in the small ball, real collisions, null collisions.
fn walked<B: Lit, F: Flights, L: Law>(
    walk: &Walk<B, F, L>,
    lookups: &Cell<u64>,
    case: &Case,
    run: Run,
) -> Vec<Sample> {
    let (center, radius) = (vector(case.part_center), case.part_radius as f32);
    tally(run, 4, |draws, scores| {
        let before = lookups.get();
        let mut ray = enter(&walk.body, draws);
        let (mut path, mut part, mut real) = (0.0, 0.0, 0);
        loop {
            let start = ray;
            let flight = walk.fly(&mut ray, draws);
            path += f64::from(flight.t);
            // The same mistake in the small ball: up to its far side instead of the collision.
            let unclipped = walk.mistake == Some(Mistake::Unclipped);
            let end = if unclipped { FAR } else { flight.t };
            part += f64::from(within(&start, end, center, radius));
            if !flight.collided {
                break;
            }
            real += 1;
            walk.scatter(&mut ray, draws);
        }
        scores[0] += path;
        scores[1] += part;
        scores[2] += f64::from(real);
        scores[3] += (lookups.get() - before) as f64 - f64::from(real);
    })
}

/// A case walked by delta tracking, under its majorant.
fn tracked<L: Law>(case: &Case, law: L, mistake: Option<Mistake>, run: Run) -> Vec<Sample> {
    let lookups = Cell::new(0);
    let sigma_s = |x, y, z| {
        lookups.set(lookups.get() + 1);
        case.density.sigma_s(x, y, z)
    };
    let flights = sigma_s.under(case.majorant);
    match case.shape {
        Shape::Sphere(radius) => {
            let radius = radius as f32;
            let mut walk = Walk::new(Ball { radius }, flights, law);
            walk.mistake = mistake;
            walked(&walk, &lookups, case, run)
        }
        Shape::Block(edges) => {
            let mut walk = Walk::new(Block::new(edges), flights, law);
            walk.mistake = mistake;
            walked(&walk, &lookups, case, run)
        }
    }
}

#[test]
fn paths_and_collisions() {
    let mut ledger = Ledger::new("invariance");
    let mut without_null = 0;
    for (i, case) in load().cases.iter().enumerate() {
        let law: Box<dyn Law> = match i % 4 {
            0 => Box::new(HenyeyGreenstein(0.8)),
            1 => Box::new(Rayleigh),
            2 => Box::new(HenyeyGreenstein(-0.4)),
            _ => Box::new(Isotropic),
        };
        let samples = tracked(case, law, None, Run::new(95, i as u32, 1 << 18));
        let name = &case.name;
        ledger.agrees(
            format_args!("{name}, path"),
            &samples[0],
            case.mean_path,
            0.005,
        );
        ledger.agrees(
            format_args!("{name}, part"),
            &samples[1],
            case.mean_path_part,
            0.02,
        );
        ledger.agrees(
            format_args!("{name}, real"),
            &samples[2],
            case.mean_collisions,
            0.005,
        );
        if case.mean_null == 0.0 {
            // The bound is the extinction, up to the rounding of both.
            assert!(samples[3].moments().mean() < 1e-4, "{name}");
            without_null += 1;
        } else {
            ledger.agrees(
                format_args!("{name}, null"),
                &samples[3],
                case.mean_null,
                0.005,
            );
        }
    }
    assert_eq!(without_null, 3);
    ledger.finish(7 * 4 - without_null);
}

/// Photons born uniformly and isotropically in a ball: the share that leaves without a collision.
#[test]
fn first_flights_out_of_a_ball() {
    let mut ledger = Ledger::new("invariance");
    for (i, FirstFlight { t, escape }) in load().first_flight.into_iter().enumerate() {
        let ball = Ball { radius: 1.0 };
        let walk = Walk::new(ball, Closed::new(t), Isotropic);
        let samples = tally(Run::new(96, i as u32, 1 << 18), 1, |draws, scores| {
            let cube = f64::from(draws.uniform());
            let mut ray = ray([0.0; 3], [0.0, 0.0, 1.0]);
            ray.origin = draws.isotropic() * cube.cbrt() as f32;
            ray.direction = draws.isotropic();
            if !walk.fly(&mut ray, draws).collided {
                scores[0] += 1.0;
            }
        });
        ledger.agrees(
            format_args!("optical radius {t}"),
            &samples[0],
            escape,
            0.01,
        );
    }
    ledger.finish(5);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 2] = [Mistake::NullScatters, Mistake::Unclipped];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("invariance", &names(&MISTAKES));
    let cases = load().cases;
    let case = cases.iter().find(|c| c.name == "cube checkerboard");
    let case = case.expect("a case of the table");
    for mistake in honest_and(&MISTAKES) {
        let samples = tracked(case, Isotropic, mistake, Run::new(97, 0, 1 << 18));
        let mut check = |name, i: usize, known: f64| {
            let verdict = judge_near(samples[i].moments(), known, 0.0, 0.05 * known);
            record(&mut suite, name, mistake, verdict);
        };
        check("path", 0, case.mean_path);
        check("path in part of it", 1, case.mean_path_part);
        check("real collisions", 2, case.mean_collisions);
        check("null collisions", 3, case.mean_null);
    }
    suite.finish();
}
