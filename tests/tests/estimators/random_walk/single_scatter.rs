//! Light that scattered exactly once: a free flight from the camera, then a shadow ray to the light.
//!
//! ```text
//! L₁ = E [1(collided) α p(cos) T(x → light) irradiance(x)]
//! ```
//!
//! The flight takes care of extinction and transmittance on the camera's side, core's estimators of transmittance of
//! the way to the light: the closed form in homogeneous media, ratio tracking in the Gaussian.

use super::{Ledger, judge_near, record_named};
use std::f64::consts::PI;
use woodcock_core::ray::Ray;
use woodcock_core::vec3::Vec3;
use woodcock_tests::refs::single_scatter::{self, Case, Setting, load};
use woodcock_tests::stats::{Mutants, Sample};
use woodcock_tests::walker::{
    Ball, Body, Closed, Draws, Flights, HenyeyGreenstein, Law, Run, Slab, Stretch, UnderBound,
    Walk, ray, tally, vector,
};

/// A planted mistake in what a collision scores.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Slip {
    /// The cosine lies between the way back and the way to the light.
    WayBack,
    /// Nothing is lost between the light and the collision.
    NoShadow,
    /// Light falls with distance, not with its square.
    OnePower,
}

/// The mistakes that these comparisons must reject.
pub(super) const SLIPS: [&str; 3] = [
    "phase function of the way back",
    "no loss on the way from the light",
    "light falls with distance, not its square",
];

const ALL: [Slip; 3] = [Slip::WayBack, Slip::NoShadow, Slip::OnePower];

/// What lights a place: the direction to it, how far it is through the medium, and the irradiance without medium.
type Lamp<'a> = Box<dyn Fn(Vec3<f32>) -> (Vec3<f32>, f32, f64) + 'a>;

/// A point of power 1.
fn point(light: [f64; 3]) -> Lamp<'static> {
    Box::new(move |at| {
        let way = vector(light) - at;
        let squared = way.dot(way);
        (
            way.normalised(),
            squared.sqrt(),
            1.0 / (4.0 * PI * f64::from(squared)),
        )
    })
}

/// Parallel light of irradiance 1, up to the boundary of a body.
fn parallel<'a>(travels: [f64; 3], body: &'a impl Body) -> Lamp<'a> {
    Box::new(move |at| {
        let direction = -vector(travels);
        let way = Ray {
            origin: at,
            direction,
        };
        (direction, body.exit(&way), 1.0)
    })
}

/// L₁ along a ray.
fn once<F: Flights>(
    walk: &Walk<Stretch, F, HenyeyGreenstein>,
    from: Ray<f32>,
    albedo: f64,
    lamp: &Lamp<'_>,
    run: Run,
    slip: Option<Slip>,
) -> Sample {
    let mut samples = tally(run, 1, |draws: &mut Draws, scores| {
        let mut ray = from;
        if !walk.fly(&mut ray, draws).collided {
            return;
        }
        let (direction, distance, irradiance) = lamp(ray.origin);
        let way = Ray {
            origin: ray.origin,
            direction,
        };
        let mut cosine = ray.direction.dot(direction);
        let mut score = albedo * irradiance;
        if slip == Some(Slip::WayBack) {
            cosine = -cosine;
        }
        if slip != Some(Slip::NoShadow) {
            score *= f64::from(walk.flights.transmittance(&way, distance, draws.stream()));
        }
        if slip == Some(Slip::OnePower) {
            score *= f64::from(distance);
        }
        scores[0] += score * f64::from(walk.law.density(&ray.origin, cosine));
    });
    samples.remove(0)
}

/// A case of the table, its ray walked by so many particles.
fn airlight(case: &Case, run: Run, slip: Option<Slip>) -> Sample {
    let (from, law) = (ray(case.origin, case.dir), HenyeyGreenstein(case.g as f32));
    let stretch = Stretch(case.t_max as f32);
    match case.setting {
        Setting::PointInHomogeneous {
            light,
            sigma_t,
            sigma_s,
        } => {
            let walk = Walk::new(stretch, Closed::new(sigma_t), law);
            once(&walk, from, sigma_s / sigma_t, &point(light), run, slip)
        }
        Setting::DirectionalOnSphere {
            radius,
            light_dir,
            sigma_t,
            sigma_s,
        } => {
            let walk = Walk::new(stretch, Closed::new(sigma_t), law);
            let ball = Ball {
                radius: radius as f32,
            };
            let lamp = parallel(light_dir, &ball);
            once(&walk, from, sigma_s / sigma_t, &lamp, run, slip)
        }
        Setting::PointInGaussian {
            light,
            peak,
            c,
            s,
            albedo,
        } => {
            let sigma_t = move |x: f64, y: f64, z: f64| {
                let squared = (x - c[0]).powi(2) + (y - c[1]).powi(2) + (z - c[2]).powi(2);
                peak * (-squared / (2.0 * s * s)).exp()
            };
            let walk = Walk::new(stretch, sigma_t.under(peak), law);
            once(&walk, from, albedo, &point(light), run, slip)
        }
    }
}

#[test]
fn airlight_integrals() {
    let mut ledger = Ledger::new("single_scatter");
    for (i, case) in load().cases.iter().enumerate() {
        // The light that almost touches its ray, and the one seen through eight mean free paths, need more.
        let particles = if matches!(i, 2 | 6) { 1 << 21 } else { 1 << 18 };
        let sample = airlight(case, Run::new(110, i as u32, particles), None);
        ledger.agrees(
            format_args!("{:?}", case.setting),
            &sample,
            case.radiance,
            0.02,
        );
    }
    ledger.finish(7);
}

/// A slab lit from z = 0, seen from the lit side or from the far one.
fn slab(case: &single_scatter::Slab, far: bool, run: Run, slip: Option<Slip>) -> Sample {
    let slab = Slab { thickness: 1.0 };
    let out = |mu: f64, phi: f64| {
        let (sin, cos) = phi.to_radians().sin_cos();
        let across = (1.0 - mu * mu).sqrt();
        [across * cos, across * sin, mu]
    };
    // The camera looks against the way out.
    let leaving = out(if far { case.mu } else { -case.mu }, case.phi_deg);
    let face = if far { 1.0 } else { 0.0 };
    let from = ray([0.0, 0.0, face], leaving.map(|c| -c));
    let law = HenyeyGreenstein(case.g as f32);
    let walk = Walk::new(Stretch(slab.exit(&from)), Closed::new(case.tau), law);
    let lamp = parallel(out(case.mu0, 0.0), &slab);
    once(&walk, from, case.albedo, &lamp, run, slip)
}

#[test]
fn slabs() {
    let mut ledger = Ledger::new("single_scatter");
    for (i, case) in load().slab.iter().enumerate() {
        for (far, known) in [(false, case.reflected), (true, case.transmitted)] {
            let sample = slab(case, far, Run::new(111, i as u32, 1 << 17), None);
            ledger.agrees(format_args!("slab {i}, far {far}"), &sample, known, 0.005);
        }
    }
    ledger.finish(4);
}

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("single_scatter", &SLIPS);
    let table = load();
    let slips = ALL
        .into_iter()
        .zip(SLIPS)
        .map(|(slip, name)| (Some(slip), Some(name)));
    for (slip, name) in [(None, None)].into_iter().chain(slips) {
        let mut check = |check: &str, sample: &Sample, known: f64| {
            let verdict = judge_near(sample.moments(), known, 0.0, 0.02 * known);
            record_named(&mut suite, check, name, verdict);
        };
        // A peaked lobe near its light, and a Gaussian.
        for (i, name) in [(1, "homogeneous"), (3, "Gaussian")] {
            let sample = airlight(&table.cases[i], Run::new(112, i as u32, 1 << 18), slip);
            check(name, &sample, table.cases[i].radiance);
        }
        let sample = slab(&table.slab[0], true, Run::new(112, 9, 1 << 16), slip);
        check("slab", &sample, table.slab[0].transmitted);
    }
    suite.finish();
}
