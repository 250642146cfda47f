//! Balls and cubes in a uniform environment: what a ray through them sees, and what they absorb.
//!
//! ```text
//! L = E αᴺ,   D = E αᴺ cos(way out, ray),   absorbed = 1 − E αᴺ under uniform light,   φ(centre) = 4π E αᴺ
//! ```
//!
//! N the collisions of a walk until it leaves. Cubes of varying density are flown through by delta tracking. Left
//! out: the closed cavity, whose walls are surfaces.

use super::{Ledger, honest_and, judge_near, names, record};
use std::f64::consts::PI;
use woodcock_core::ray::Ray;
use woodcock_tests::refs::furnace::{Density, load};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{
    Ball, Block, Body, Closed, Draws, Flights, HenyeyGreenstein, Isotropic, Law, Lit, Mistake,
    Rayleigh, Run, UnderBound, Walk, ray, tally,
};

const BALL: Ball = Ball { radius: 1.0 };

/// L and D of the rays that `enter` makes.
fn seen<B: Body, F: Flights, L: Law>(
    walk: &Walk<B, F, L>,
    albedo: f64,
    run: Run,
    enter: impl Fn(&mut Draws) -> Ray<f32>,
) -> Vec<Sample> {
    tally(run, 2, |draws, scores| {
        let mut ray = enter(draws);
        let along = ray.direction;
        let mut weight = 1.0;
        let left = walk.follow(&mut ray, draws, |_, draws| {
            weight = walk.absorb(weight, albedo);
            weight *= walk.roulette(weight, 0.1, draws);
            weight > 0.0
        });
        if left {
            scores[0] += weight;
            scores[1] += weight * f64::from(ray.direction.dot(along));
        }
    })
}

/// A ray along z at distance `b` from the centre of the unit ball.
fn past_the_centre(b: f64) -> Ray<f32> {
    ray([b, 0.0, -(1.0 - b * b).sqrt()], [0.0, 0.0, 1.0])
}

#[test]
fn isotropic_balls() {
    let mut ledger = Ledger::new("furnace");
    for (i, ball) in load().isotropic.iter().enumerate() {
        let walk = Walk::new(BALL, Closed::new(ball.t), Isotropic);
        let run = |j: usize| Run::new(100, (16 * i + j) as u32, 1 << 16);
        let name = format!("isotropic, t {} albedo {}", ball.t, ball.albedo);
        for (j, (&b, &known)) in ball.b_over_rho.iter().zip(&ball.radiance).enumerate() {
            let samples = seen(&walk, ball.albedo, run(j), |_| past_the_centre(b));
            ledger.agrees(format_args!("{name}, L at {b}"), &samples[0], known, 0.005);
        }
        let samples = seen(&walk, ball.albedo, run(8), |draws| {
            let u = std::array::from_fn(|_| draws.uniform());
            let (origin, normal) = BALL.surface(u);
            Ray {
                origin,
                direction: draws.lambertian(normal),
            }
        });
        let escaping = 1.0 - ball.absorptance;
        ledger.agrees(
            format_args!("{name}, escaping"),
            &samples[0],
            escaping,
            0.005,
        );
        let samples = seen(&walk, ball.albedo, run(9), |draws| Ray {
            origin: ray([0.0; 3], [0.0, 0.0, 1.0]).origin,
            direction: draws.isotropic(),
        });
        let centre = ball.fluence_center / (4.0 * PI);
        // Little light reaches the centre of the thickest.
        ledger.agrees(format_args!("{name}, centre"), &samples[0], centre, 0.01);
    }
    ledger.finish(5 * (6 + 2));
}

#[test]
fn balls_that_scatter_forward_and_back() {
    let mut ledger = Ledger::new("furnace");
    for (i, ball) in load().hg.iter().enumerate() {
        let law = HenyeyGreenstein(ball.g as f32);
        let walk = Walk::new(BALL, Closed::new(ball.t), law);
        for (j, &b) in ball.b_over_rho.iter().enumerate() {
            let run = Run::new(101, (16 * i + j) as u32, 1 << 17);
            let samples = seen(&walk, ball.albedo, run, |_| past_the_centre(b));
            let name = format!("g {} t {} albedo {} b {b}", ball.g, ball.t, ball.albedo);
            let (l, error) = (ball.radiance[j], ball.radiance_error[j]);
            ledger.within(format_args!("{name}, L"), &samples[0], l, error, 0.005 * l);
            let (d, error) = (ball.dipole[j], ball.dipole_error[j]);
            ledger.within(format_args!("{name}, D"), &samples[1], d, error, 0.005 * l);
        }
    }
    ledger.finish(4 * 3 * 2);
}

/// A cube's medium: by delta tracking unless it is homogeneous.
fn filling(density: Density) -> Box<dyn Flights> {
    match density {
        Density::Homogeneous(sigma_t) => Box::new(Closed::new(sigma_t)),
        _ => Box::new((move |x, y, z| density.sigma_t(x, y, z)).under(1.1 * density.majorant())),
    }
}

#[test]
fn cubes() {
    let mut ledger = Ledger::new("furnace");
    for (i, cube) in load().cubes.iter().enumerate() {
        let law = HenyeyGreenstein(cube.g as f32);
        let walk = Walk::new(Block::unit(), filling(cube.density), law);
        for (j, known) in cube.rays.iter().enumerate() {
            let run = Run::new(102, (16 * i + j) as u32, 1 << 17);
            let (origin, direction) = (known.ray_origin, known.ray_dir);
            let samples = seen(&walk, cube.albedo, run, |_| ray(origin, direction));
            let name = format!("{:?}, ray {j}", cube.density);
            let (l, error) = (known.radiance, known.radiance_error);
            ledger.within(format_args!("{name}, L"), &samples[0], l, error, 0.005 * l);
            let (d, error) = (known.dipole, known.dipole_error);
            ledger.within(format_args!("{name}, D"), &samples[1], d, error, 0.005 * l);
        }
    }
    ledger.finish(3 * 3 * 2);
}

/// Without absorption every single walk leaves, and brings exactly 1.
#[test]
fn white_furnaces_are_white() {
    let laws: [Box<dyn Law>; 4] = [
        Box::new(Isotropic),
        Box::new(HenyeyGreenstein(0.9)),
        Box::new(HenyeyGreenstein(-0.9)),
        Box::new(Rayleigh),
    ];
    let mut furnaces = 0;
    for law in &laws {
        for cube in load().cubes {
            let walk = Walk::new(Block::unit(), filling(cube.density), law.as_ref());
            for (j, known) in cube.rays.iter().enumerate() {
                let (origin, direction) = (known.ray_origin, known.ray_dir);
                let run = Run::new(103, j as u32, 1 << 12);
                let samples = seen(&walk, 1.0, run, |_| ray(origin, direction));
                let m = samples[0].moments();
                assert_eq!((m.min(), m.max()), (1.0, 1.0), "{:?} {j}", cube.density);
                furnaces += 1;
            }
        }
    }
    assert_eq!(furnaces, 4 * 9);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 6] = [
    Mistake::PhaseReversed,
    Mistake::StaleFlight,
    Mistake::ShortFrame,
    Mistake::HalfTurn,
    Mistake::NullScatters,
    Mistake::AlbedoTwice,
];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("furnace", &names(&MISTAKES));
    // The linear cube, on its oblique ray.
    let cube = &load().cubes[1];
    let known = &cube.rays[2];
    for mistake in honest_and(&MISTAKES) {
        let law = HenyeyGreenstein(cube.g as f32);
        let mut walk = Walk::new(Block::unit(), filling(cube.density), law);
        walk.mistake = mistake;
        let run = Run::new(104, 0, 1 << 17);
        let samples = seen(&walk, cube.albedo, run, |_| {
            ray(known.ray_origin, known.ray_dir)
        });
        let (l, error) = (known.radiance, known.radiance_error);
        let verdict = judge_near(samples[0].moments(), l, error, 0.01 * l);
        record(&mut suite, "L", mistake, verdict);
        let (d, error) = (known.dipole, known.dipole_error);
        let verdict = judge_near(samples[1].moments(), d, error, 0.01 * l);
        record(&mut suite, "D", mistake, verdict);
    }
    suite.finish();
}
