//! Reflectance and transmittance of slabs: 64 homogeneous ones, their heterogeneous equals, and special ones.
//!
//! A particle enters the lit face, keeps the product of the albedos it met as weight, and scores where it leaves. No
//! albedo bends a path, so one walk serves all albedos.

use super::{Ledger, honest_and, names, record};
use woodcock_core::ray::Ray;
use woodcock_tests::refs::slab_matched::{self, Fluxes};
use woodcock_tests::stats::{Mutants, Sample, judge};
use woodcock_tests::walker::{
    Body, Closed, Draws, Flights, HenyeyGreenstein, Law, Mistake, Run, Slab, Walk, ray, tally,
};

mod deep;
mod profiles;
mod special;

/// The slab of every walk here.
const UNIT: Slab = Slab { thickness: 1.0 };

/// What falls on the face z = 0.
#[derive(Clone, Copy, Debug)]
enum Light {
    /// A beam, by its cosine to the inward normal.
    Beam(f64),
    /// Uniform radiance.
    Diffuse,
}

impl Light {
    fn enter(self, draws: &mut Draws) -> Ray<f32> {
        match self {
            Self::Beam(mu) => ray([0.0; 3], [(1.0 - mu * mu).sqrt(), 0.0, mu]),
            Self::Diffuse => {
                let mut ray = ray([0.0; 3], [0.0, 0.0, 1.0]);
                ray.direction = draws.lambertian(ray.direction);
                ray
            }
        }
    }
}

/// What a homogeneous slab does to light.
fn of_slab(slab: &slab_matched::Slab) -> [(Light, Fluxes); 4] {
    let [a, b, c] = slab.beams.map(|(mu, fluxes)| (Light::Beam(mu), fluxes));
    [a, b, c, (Light::Diffuse, slab.diffuse)]
}

/// Reflectance and transmittance for each of `albedos`, ascending, in turn. Weights below a quarter face roulette.
fn fluxes<B: Body, F: Flights, L: Law>(
    walk: &Walk<B, F, L>,
    run: Run,
    light: Light,
    albedos: &[f64],
) -> Vec<Sample> {
    let last = albedos.len() - 1;
    let mut weights = vec![1.0; albedos.len()];
    tally(run, 2 * albedos.len(), |draws, scores| {
        let mut ray = light.enter(draws);
        weights.fill(1.0);
        let left = walk.follow(&mut ray, draws, |_, draws| {
            for (weight, albedo) in weights.iter_mut().zip(albedos) {
                *weight = walk.absorb(*weight, *albedo);
            }
            let factor = walk.roulette(weights[last], 0.25, draws);
            weights.iter_mut().for_each(|weight| *weight *= factor);
            factor > 0.0
        });
        if left {
            let far = usize::from(ray.direction.z > 0.0);
            for (i, weight) in weights.iter().enumerate() {
                scores[2 * i + far] += weight;
            }
        }
    })
}

/// Light that so few weights bring through that it takes a window to see it.
fn is_deep(albedo: f64, tau: f64) -> bool {
    albedo == 0.5 && tau >= 4.0 || albedo == 0.9 && tau >= 16.0
}

/// Albedos that are walked together, and by how many particles. Absorbing slabs end walks early.
fn groups(tau: f64) -> &'static [(&'static [f64], usize)] {
    const ALL: &[f64] = &[0.5, 0.9, 0.99, 1.0];
    match tau {
        0.1 => &[(ALL, 1 << 20)],
        1.0 => &[(ALL, 1 << 18)],
        4.0 => &[(&[0.5, 0.9], 1 << 17), (&[0.99, 1.0], 1 << 16)],
        16.0 => &[(&[0.5, 0.9], 1 << 17), (&[0.99, 1.0], 1 << 16)],
        _ => panic!("the table has no slab of thickness {tau}"),
    }
}

const GS: [f64; 4] = [0.0, 0.5, 0.85, -0.3];
const TAUS: [f64; 4] = [0.1, 1.0, 4.0, 16.0];

/// Compares both shares that slabs of optical thickness `tau` make of `light`, for all albedos.
///
/// Asks for a standard error of 0.5 % of the larger share, not below 7.5·10⁻⁴ of what falls on the slab, and of 3 % of
/// each share, all times `coarser`.
fn compare<B: Body + Copy>(
    ledger: &mut Ledger,
    (body, flights, profile): (B, &dyn Flights, &str),
    tau: f64,
    g: f64,
    light: usize,
    coarser: usize,
) {
    let table = slab_matched::load();
    let walk = Walk::new(body, flights, HenyeyGreenstein(g as f32));
    for (albedos, particles) in groups(tau) {
        let known = albedos.iter().map(|&albedo| {
            let same = |s: &&slab_matched::Slab| s.albedo == albedo && s.tau == tau && s.g == g;
            of_slab(table.slabs.iter().find(same).expect("a slab of the table"))[light]
        });
        let known: Vec<(Light, Fluxes)> = known.collect();
        let (light, _) = known[0];
        let pixel = 1000 * (10.0 * tau) as u32 + ledger.comparisons as u32;
        let run = Run::new(70 + coarser as u64, pixel, particles / (coarser * coarser));
        let scores = fluxes(&walk, run, light, albedos);
        for ((albedo, (_, known)), scores) in albedos.iter().zip(known).zip(scores.chunks(2)) {
            let (r, t) = (known.reflectance, known.transmittance);
            let name = format!("{profile}, albedo {albedo} tau {tau} g {g} {light:?}");
            let larger = r.max(t).max(0.15);
            let asked = |share: f64| coarser as f64 * (0.005 * larger).min(0.03 * share);
            ledger.within(format_args!("{name} R"), &scores[0], r, 0.0, asked(r));
            if !is_deep(*albedo, tau) {
                ledger.within(format_args!("{name} T"), &scores[1], t, 0.0, asked(t));
            }
        }
    }
}

/// How many comparisons [`compare`] makes.
fn comparisons(tau: f64) -> usize {
    let deep = [0.5, 0.9, 0.99, 1.0]
        .into_iter()
        .filter(|a| is_deep(*a, tau));
    8 - deep.count()
}

fn homogeneous(tau: f64) {
    let mut ledger = Ledger::new("slab_matched");
    let flights = Closed::new(tau);
    for g in GS {
        for light in 0..4 {
            let medium = (UNIT, &flights as &dyn Flights, "homogeneous");
            compare(&mut ledger, medium, tau, g, light, 1);
        }
    }
    ledger.finish(16 * comparisons(tau));
}

#[test]
fn slabs_of_thickness_a_tenth() {
    homogeneous(0.1);
}

#[test]
fn slabs_of_thickness_1() {
    homogeneous(1.0);
}

#[test]
fn slabs_of_thickness_4() {
    homogeneous(4.0);
}

#[test]
fn slabs_of_thickness_16() {
    homogeneous(16.0);
}

/// The mistakes that these comparisons must reject.
pub(super) const MISTAKES: [Mistake; 5] = [
    Mistake::PhaseReversed,
    Mistake::StaleFlight,
    Mistake::NullScatters,
    Mistake::AlbedoTwice,
    Mistake::LossyRoulette,
];

#[test]
fn mutants_die() {
    let mut suite = Mutants::new("slab_matched", &names(&MISTAKES));
    let slabs = slab_matched::load().slabs;
    let same = |s: &&slab_matched::Slab| s.albedo == 0.9 && s.tau == 4.0 && s.g == 0.5;
    let slab = slabs.iter().find(same).expect("a slab of the table");
    let (light, known) = of_slab(slab)[1];
    let [(_, ramp), ..] = profiles::profiles(slab.tau);
    let law = HenyeyGreenstein(slab.g as f32);
    let rate = deep::decay(&slabs, slab.albedo, slab.g);
    for mistake in honest_and(&MISTAKES) {
        let mut walk = Walk::new(UNIT, &ramp, law);
        walk.mistake = mistake;
        let scores = fluxes(&walk, Run::new(75, 0, 1 << 16), light, &[slab.albedo]);
        let verdict = |i: usize, truth| judge(scores[i].moments(), truth, 0.02);
        record(
            &mut suite,
            "reflectance",
            mistake,
            verdict(0, known.reflectance),
        );
        record(
            &mut suite,
            "transmittance",
            mistake,
            verdict(1, known.transmittance),
        );
        let mut walk = Walk::new(deep::Layers { count: 4.0 }, Closed::new(slab.tau), law);
        walk.mistake = mistake;
        let window = deep::through(
            &walk,
            Run::new(75, 1, 1 << 16),
            light,
            (slab.albedo, slab.tau, rate),
        );
        let verdict = judge(window.moments(), known.transmittance, 0.02);
        record(&mut suite, "transmittance by a window", mistake, verdict);
    }
    suite.finish();
}
