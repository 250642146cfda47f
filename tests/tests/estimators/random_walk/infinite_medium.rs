//! The infinite medium: where walks stand after n flights and where they die, and the light around a point.
//!
//! Fluence is scored at every collision by what a particle sent on in all directions alike brings to the sphere of
//! radius r about the source, averaged over that sphere:
//!
//! ```text
//! φ(r) = E Σ w [E₁(|ρ − r|) − E₁(ρ + r)] / (8πρr),   ρ the distance of the collision from the source
//! ```
//!
//! which is e^(−s)/(4πs²) averaged over the distances s from |ρ − r| to ρ + r. Left out: fluence at albedo 1, whose
//! walks never end (its first orders are compared), and light that never scattered, which no walk is needed for.

use super::{Ledger, honest_and, names, record};
use std::f64::consts::PI;
use woodcock_core::vec3::Vec3;
use woodcock_tests::refs::infinite_medium::{Table, Walk as Moments, load};
use woodcock_tests::refs::quadrature::{close, integrate};
use woodcock_tests::stats::{Mutants, Sample, judge, judge_within};
use woodcock_tests::walker::{
    Closed, HenyeyGreenstein, Isotropic, Law, Mistake, Run, Space, Walk, ray, tally,
};

fn walk<L: Law>(law: L) -> Walk<Space, Closed, L> {
    Walk::new(Space, Closed::new(1.0), law)
}

/// Positions in `f64`.
fn place(origin: Vec3<f32>) -> [f64; 3] {
    origin.lane(0).map(f64::from)
}

fn squared(place: [f64; 3]) -> f64 {
    place.iter().map(|c| c * c).sum()
}

const UPWARDS: [f64; 3] = [0.0, 0.0, 1.0];

/// Means of z, z², x², r² after each of the numbers of flights in `after`, ascending.
fn moments<L: Law>(walk: &Walk<Space, Closed, L>, run: Run, after: &[u32]) -> Vec<Sample> {
    tally(run, 4 * after.len(), |draws, scores| {
        let mut ray = ray([0.0; 3], UPWARDS);
        let mut flights = 0;
        for (stop, row) in after.iter().zip(scores.chunks_mut(4)) {
            while flights < *stop {
                if flights > 0 {
                    walk.scatter(&mut ray, draws);
                }
                walk.fly(&mut ray, draws);
                flights += 1;
            }
            let [x, y, z] = place(ray.origin);
            row[0] += z;
            row[1] += z * z;
            // x² and y² are one number.
            row[2] += 0.5 * (x * x + y * y);
            row[3] += squared([x, y, z]);
        }
    })
}

/// The rows of the table with one mean cosine.
fn of_cosine(table: &Table, g: f64) -> Vec<Moments> {
    table.moments.iter().copied().filter(|w| w.g == g).collect()
}

#[test]
fn positions_after_n_flights() {
    let table = load();
    let mut ledger = Ledger::new("infinite_medium");
    for (i, g) in [0.0, 0.5, 0.9, -0.4].into_iter().enumerate() {
        let rows = of_cosine(&table, g);
        let after: Vec<u32> = rows.iter().map(|w| w.flights).collect();
        let run = Run::new(90, i as u32, 1 << 16);
        let samples = moments(&walk(HenyeyGreenstein(g as f32)), run, &after);
        for (row, samples) in rows.iter().zip(samples.chunks(4)) {
            let name = format!("g {g}, {} flights", row.flights);
            // The drift is small against the spread, whose standard deviation is the measure.
            let spread = row.z2.sqrt();
            ledger.within(
                format_args!("{name} z"),
                &samples[0],
                row.z,
                0.0,
                0.01 * spread,
            );
            ledger.agrees(format_args!("{name} z²"), &samples[1], row.z2, 0.015);
            ledger.within(
                format_args!("{name} x²"),
                &samples[2],
                row.x2,
                0.0,
                0.025 * row.x2,
            );
            ledger.agrees(format_args!("{name} r²"), &samples[3], row.r2, 0.015);
        }
    }
    ledger.finish(4 * 6 * 4);
}

#[test]
fn where_photons_die() {
    let mut ledger = Ledger::new("infinite_medium");
    let table = load();
    for (i, end) in table.absorption_moments.iter().enumerate() {
        let walk = walk(HenyeyGreenstein(end.g as f32));
        // Long lives need few photons.
        let run = Run::new(
            91,
            i as u32,
            if end.mean_collisions > 50.0 {
                1 << 15
            } else {
                1 << 18
            },
        );
        let samples = tally(run, 3, |draws, scores| {
            let mut ray = ray([0.0; 3], UPWARDS);
            let mut collisions = 0.0;
            walk.follow(&mut ray, draws, |_, draws| {
                collisions += 1.0;
                f64::from(draws.uniform()) < end.albedo
            });
            let place = place(ray.origin);
            scores[0] += place[2];
            scores[1] += squared(place);
            scores[2] += collisions;
        });
        let name = format!("absorbed at albedo {} g {}", end.albedo, end.g);
        let spread = (end.mean_r2 / 3.0).sqrt();
        ledger.within(
            format_args!("{name} z"),
            &samples[0],
            end.mean_z,
            0.0,
            0.01 * spread,
        );
        ledger.agrees(format_args!("{name} r²"), &samples[1], end.mean_r2, 0.02);
        ledger.agrees(
            format_args!("{name} collisions"),
            &samples[2],
            end.mean_collisions,
            0.01,
        );
    }
    ledger.finish(4 * 3);
}

/// E₁(x) = ∫ e^(−t)/t dt over [x, ∞), x > 0: its series below 1, its continued fraction above. Error 2·10⁻⁷ relative.
fn e1(x: f64) -> f64 {
    const EULER: f64 = 0.577_215_664_901_532_9;
    if x < 1.0 {
        let (mut sum, mut term) = (-EULER - x.ln(), -1.0);
        for k in 1..11 {
            let k = f64::from(k);
            term *= -x / k;
            sum += term / k;
        }
        return sum;
    }
    // e^(−x)/(x + 1 − 1/(x + 3 − 4/(x + 5 − …))), from the far end; n terms leave e^(−4√(nx)).
    let terms = (20.0 / x) as u32 + 3;
    let mut fraction = 0.0;
    for k in (1..terms).rev() {
        let k = f64::from(k);
        fraction = k * k / (x + 2.0 * k + 1.0 - fraction);
    }
    (-x).exp() / (x + 1.0 - fraction)
}

#[test]
fn the_exponential_integral_is_right() {
    for x in [1e-6, 0.01, 0.5, 0.999, 1.0, 1.7, 5.0, 20.0] {
        // With t = x + s/(1 − s) the range is [0, 1].
        let exact = integrate(0.0, 1.0, 400, |s| {
            let t = x + s / (1.0 - s);
            (-(t - x)).exp() / (t * (1.0 - s).powi(2))
        });
        if x >= 0.01 {
            close("E1", e1(x) * x.exp() / exact, 1.0, 3e-7);
        }
    }
    close(
        "E1 near 0",
        e1(1e-6),
        -0.577_215_664_901_532_9 - 1e-6_f64.ln() + 1e-6,
        1e-11,
    );
}

/// What an isotropic emitter of power 1 at distance `rho` brings to the sphere of radius `r`, on average.
fn on_sphere(rho: f64, r: f64) -> f64 {
    // Very near the source the difference cancels, and the sphere is as good as its centre is far.
    if rho < 1e-4 * r {
        return (-r).exp() / (4.0 * PI * r * r);
    }
    let nearest = (rho - r).abs().max(1e-12);
    (e1(nearest) - e1(rho + r)) / (8.0 * PI * rho * r)
}

/// Which walks score fluence, and how many particles for it.
#[derive(Clone, Copy)]
enum Light {
    /// Everything, at an albedo; roulette ends walks.
    All(f64),
    /// By number of scatterings, at albedo 1.
    Orders,
}

/// Fluences at the radii of the table: of all light, or of each order of the table.
fn fluences(
    walk: &Walk<Space, Closed, Isotropic>,
    run: Run,
    table: &Table,
    light: Light,
) -> Vec<Sample> {
    let radii = table.r.len();
    let orders = match light {
        Light::All(_) => 1,
        Light::Orders => table.orders.len(),
    };
    tally(run, radii * orders, |draws, scores| {
        let mut ray = ray([0.0; 3], UPWARDS);
        ray.direction = draws.isotropic();
        let (mut weight, mut scatterings) = (1.0, 0);
        let mut score = |scatterings: u32, weight: f64, rho: f64| {
            let row = match light {
                Light::All(_) => Some(0),
                Light::Orders => table.orders.iter().position(|o| o.n == scatterings),
            };
            if let Some(row) = row {
                let scores = scores[row * radii..].iter_mut();
                for (score, &r) in scores.zip(&table.r) {
                    *score += weight * on_sphere(rho, r);
                }
            }
        };
        score(0, 1.0, 0.0);
        walk.follow(&mut ray, draws, |ray, draws| {
            scatterings += 1;
            if let Light::All(albedo) = light {
                weight = walk.absorb(weight, albedo);
                weight *= walk.roulette(weight, 0.5, draws);
            }
            score(scatterings, weight, squared(place(ray.origin)).sqrt());
            weight > 0.0 && !(matches!(light, Light::Orders) && scatterings == 5)
        });
    })
}

#[test]
fn fluence_around_a_point() {
    let table = load();
    let mut ledger = Ledger::new("infinite_medium");
    for (i, row) in table.greens.iter().enumerate() {
        if row.albedo == 1.0 {
            continue;
        }
        // Where little is absorbed walks are long.
        let particles = if row.albedo > 0.9 { 1 << 15 } else { 1 << 17 };
        let run = Run::new(92, i as u32, particles);
        let samples = fluences(&walk(Isotropic), run, &table, Light::All(row.albedo));
        for ((r, known), sample) in table.r.iter().zip(&row.fluence).zip(samples) {
            let name = format_args!("fluence at {r}, albedo {}", row.albedo);
            ledger.agrees(name, &sample, *known, asked(*r));
        }
    }
    ledger.finish(3 * 6);
}

#[test]
fn fluence_by_order_of_scattering() {
    let table = load();
    let mut ledger = Ledger::new("infinite_medium");
    let samples = fluences(
        &walk(Isotropic),
        Run::new(93, 0, 1 << 18),
        &table,
        Light::Orders,
    );
    for (order, samples) in table.orders.iter().zip(samples.chunks(table.r.len())) {
        if order.n == 0 {
            continue;
        }
        for ((r, known), sample) in table.r.iter().zip(&order.fluence).zip(samples) {
            ledger.agrees(
                format_args!("order {} at {r}", order.n),
                sample,
                *known,
                asked(*r),
            );
        }
    }
    ledger.finish(4 * 6);
}

/// The standard error asked for: far from the source few collisions bring most of the light.
fn asked(r: f64) -> f64 {
    if r > 4.0 { 0.06 } else { 0.03 }
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 6] = [
    Mistake::PhaseReversed,
    Mistake::StaleFlight,
    Mistake::ShortFrame,
    Mistake::HalfTurn,
    Mistake::AlbedoTwice,
    Mistake::LossyRoulette,
];

#[test]
fn mutants_die() {
    let table = load();
    let mut suite = Mutants::new("infinite_medium", &names(&MISTAKES));
    let rows = of_cosine(&table, 0.5);
    let after: Vec<u32> = rows.iter().map(|w| w.flights).collect();
    for mistake in honest_and(&MISTAKES) {
        let mut particles = walk(HenyeyGreenstein(0.5));
        particles.mistake = mistake;
        let samples = moments(&particles, Run::new(94, 0, 1 << 15), &after);
        // After ten flights.
        let (row, samples) = (rows[4], &samples[4 * 4..]);
        let verdict = judge_within(samples[0].moments(), row.z, 0.1);
        record(&mut suite, "drift", mistake, verdict);
        let verdict = judge(samples[3].moments(), row.r2, 0.03);
        record(&mut suite, "spread", mistake, verdict);
        let mut light = walk(Isotropic);
        light.mistake = mistake;
        let samples = fluences(&light, Run::new(94, 1, 1 << 14), &table, Light::All(0.8));
        let verdict = judge(samples[2].moments(), table.greens[1].fluence[2], 0.03);
        record(&mut suite, "fluence", mistake, verdict);
    }
    suite.finish();
}
