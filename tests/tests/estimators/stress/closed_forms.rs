//! Optical depths and their inverses over sixty decades, against the same laws in double precision.

use super::{Worst, along_x, decades, ray, relative, stream};
use woodcock_core::line_integral;
use woodcock_core::medium::{ClosedForm, Exponential, Homogeneous, Linear, Medium};
use woodcock_core::real::Real;
use woodcock_core::transmittance;

/// Optical depths over 24 decades.
fn depths() -> impl Iterator<Item = f32> + Clone {
    decades(-12, 12, 3)
}

#[test]
fn homogeneous_media_lose_half_an_ulp() {
    let [mut tau, mut back, mut t_of] =
        [const { None }; 3].map(|w: Option<Worst>| w.unwrap_or_default());
    for sigma_t in decades(-30, 30, 1) {
        let fog = Homogeneous::new(sigma_t).expect("a valid extinction");
        for depth in depths() {
            let t = depth / sigma_t;
            if !(1e-37..1e30).contains(&t) {
                continue;
            }
            let exact = f64::from(sigma_t) * f64::from(t);
            let at = || format!("sigma_t {sigma_t:e}, t {t:e}");
            tau.see(relative(fog.optical_depth(&along_x(), t), exact), at);
            let length = f64::from(depth) / f64::from(sigma_t);
            back.see(relative(fog.distance(&along_x(), depth), length), at);
            // The argument of the exponential is rounded, relative; its result by an ulp.
            let found = transmittance::analytic::estimate(&fog, &along_x(), t);
            let error = relative(found, (-exact).exp()) / (1.2e-7 + 6e-8 * exact.min(200.0));
            t_of.see(error, at);
        }
    }
    tau.within("depth in fog", 6e-8, 5000);
    back.within("distance in fog", 6e-8, 5000);
    t_of.within("transmittance in fog, in units of its bound", 1.0, 5000);
    for sigma_t in [0.0_f32, -0.0] {
        let vacuum = Homogeneous::new(sigma_t).expect("nothing is valid");
        assert_eq!(vacuum.optical_depth(&along_x(), 1e30).abs(), 0.0);
        assert_eq!(
            transmittance::analytic::estimate(&vacuum, &along_x(), 1e30),
            1.0
        );
        assert_eq!(vacuum.distance(&along_x(), 1.0).abs(), f32::INFINITY);
    }
}

/// 1 − e^−τ, which thin media are all about.
fn collided(probability: impl Fn(f32) -> f32) -> Worst {
    let mut worst = Worst::default();
    for depth in decades(-30, 3, 1) {
        let exact = -(-f64::from(depth)).exp_m1();
        worst.see(relative(probability(depth), exact), || {
            format!("depth {depth:e}")
        });
    }
    worst
}

#[test]
fn thin_media_keep_their_collisions() {
    const BOUND: f64 = 2e-7;
    collided(|depth| -(-depth).exp_m1()).within("1 - T", BOUND, 100);
    // The whole of Algorithm 2 with a source of one and nothing behind: the same number, without variance.
    let fog = Homogeneous::new(1.0).expect("a valid extinction");
    let line = |depth: f32| {
        let one = |_, _| 1.0_f32;
        line_integral::collisions(&fog, &along_x(), depth, 4, one, 0.0, &mut stream(1), true)
    };
    collided(line).within("a line integral over fog", BOUND, 100);
    collided(|depth| 1.0 - Real::exp(-depth)).must_fail("1 - exp", BOUND);
}

/// A ramp a + bt in double precision.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    a: f64,
    b: f64,
}

impl Ramp {
    fn depth(self, t: f64) -> f64 {
        let Self { a, b } = self;
        let crossing = -a / b;
        match (a >= 0.0, b > 0.0) {
            (true, true) => t * (a + 0.5 * b * t),
            (true, false) => {
                let end = t.min(crossing);
                end * (a + 0.5 * b * end)
            }
            (false, true) => 0.5 * b * (t - crossing).max(0.0).powi(2),
            (false, false) => 0.0,
        }
    }
}

/// Ramps over sixty decades of extinction and thirty of length.
fn ramps() -> impl Iterator<Item = (f32, f32)> {
    let signs = [(1.0_f32, 1.0_f32), (1.0, -1.0), (-1.0, 1.0)];
    decades(-30, 30, 5)
        .flat_map(move |a| {
            decades(-15, 15, 4)
                .flat_map(move |length| signs.map(|(s, r)| (s * a, r * (a / length))))
        })
        .filter(|(_, b)| (1e-36..1e36).contains(&b.abs()))
}

/// Backward errors: the depth of the distance found, over the depth asked for.
fn ramp_distances(distance: impl Fn(f32, f32, f32) -> f32) -> Worst {
    let mut worst = Worst::default();
    for (a, b) in ramps() {
        let exact = Ramp {
            a: a.into(),
            b: b.into(),
        };
        for depth in depths() {
            let asked = f64::from(depth);
            let all = if b < 0.0 {
                exact.depth(f64::INFINITY)
            } else {
                f64::INFINITY
            };
            let found = f64::from(distance(a, b, depth));
            let at = || format!("a {a:e}, b {b:e}, depth {depth:e}: {found:e}");
            if found == f64::INFINITY {
                // Never, or beyond the range of numbers.
                let beyond = exact.depth(1e37) < asked;
                worst.see(
                    if beyond {
                        0.0
                    } else {
                        (1.0 - asked / all).max(0.0)
                    },
                    at,
                );
            } else if a < 0.0 {
                let t = -exact.a / exact.b + (2.0 * asked / exact.b).sqrt();
                worst.see((found / t - 1.0).abs(), at);
            } else if found > 1e-37 {
                worst.see((exact.depth(found) / asked - 1.0).abs(), at);
            }
        }
    }
    worst
}

#[test]
fn ramps_are_inverted_to_a_few_ulps() {
    const BOUND: f64 = 1e-6;
    let medium = |a: f32, b: f32| Linear::new(a, [b, 0.0, 0.0]).expect("finite");
    ramp_distances(|a, b, e| medium(a, b).distance(&along_x(), e)).within(
        "distance on a ramp",
        BOUND,
        10_000,
    );
    let textbook = |a: f32, b: f32, e: f32| ((a * a + 2.0 * b * e).max(0.0).sqrt() - a) / b;
    ramp_distances(textbook).must_fail("the textbook's root", BOUND);
}

#[test]
fn ramps_have_their_depth() {
    let mut worst = Worst::default();
    for (a, b) in ramps() {
        let exact = Ramp {
            a: a.into(),
            b: b.into(),
        };
        let medium = Linear::new(a, [b, 0.0, 0.0]).expect("finite");
        for part in [1e-6_f32, 1e-3, 0.3, 0.7, 0.999, 1.0, 1.001, 1.5, 1e3] {
            let t = part * (a / b).abs();
            let depth = exact.depth(t.into());
            if !(1e-36..1e36).contains(&depth) || !(1e-18..1e18).contains(&t) {
                continue;
            }
            // A ramp that begins below zero begins at a place that is rounded.
            let begin = if a < 0.0 {
                f64::from(t) / (f64::from(t) + exact.a / exact.b)
            } else {
                1.0
            };
            let found = medium.optical_depth(&along_x(), t);
            worst.see(relative(found, depth) / begin, || {
                format!("a {a:e}, b {b:e}, t {t:e}: {found:e}, {depth:e}")
            });
        }
    }
    worst.within("depth of a ramp, per condition", 4e-7, 5_000);
}

/// An atmosphere σ₀ e^(−(h + kt)) in double precision.
#[derive(Clone, Copy, Debug)]
struct Air {
    sigma_0: f64,
    h: f64,
    k: f64,
}

impl Air {
    fn sigma_t(self, t: f64) -> f64 {
        (self.sigma_0.ln() - self.h - self.k * t).exp()
    }
    fn depth(self, t: f64) -> f64 {
        let heights = self.k * t;
        let length = if heights == 0.0 {
            t
        } else {
            -(-heights).exp_m1() / self.k
        };
        self.sigma_t(0.0) * length
    }
    /// What the rounding of exponents costs: their size in units of what a factor loses.
    fn condition(self, t: f64) -> f64 {
        1.0 + 0.3 * (self.h.abs() + (self.k * t).abs())
    }
}

/// Atmospheres whose air is neither denser nor thinner than `f32` can tell where the ray begins.
fn airs() -> impl Iterator<Item = (f32, f32, f32)> {
    decades(-30, 30, 6)
        .flat_map(|sigma_0| {
            decades(-15, 15, 5).flat_map(move |height| {
                [-150.0_f32, -90.0, -20.0, 0.0, 0.3, 20.0, 80.0, 140.0]
                    .into_iter()
                    .flat_map(move |h| {
                        [1.0_f32, -1.0].map(move |sign| (sigma_0, sign / height, h * height * sign))
                    })
            })
        })
        .filter(|&(sigma_0, k, origin)| {
            let ln = f64::from(sigma_0).ln() - f64::from(k) * f64::from(origin);
            (-85.0..85.0).contains(&ln)
        })
}

fn air(sigma_0: f32, k: f32, origin: f32) -> Air {
    Air {
        sigma_0: sigma_0.into(),
        h: f64::from(k) * f64::from(origin),
        k: k.into(),
    }
}

/// Backward errors of distances, over the condition.
fn air_distances(distance: impl Fn(f32, f32, f32, f32) -> f32) -> Worst {
    let mut worst = Worst::default();
    for (sigma_0, k, origin) in airs() {
        let exact = air(sigma_0, k, origin);
        for depth in decades(-12, 12, 6) {
            let asked = f64::from(depth);
            let found = f64::from(distance(sigma_0, k, origin, depth));
            let at = || {
                format!(
                    "sigma_0 {sigma_0:e}, k {k:e}, h {}, depth {depth:e}: {found:e}",
                    exact.h
                )
            };
            let error = if found == f64::INFINITY {
                let all = if k > 0.0 {
                    exact.sigma_t(0.0) / exact.k
                } else {
                    f64::INFINITY
                };
                let beyond = exact.depth(1e37) < asked;
                (if beyond {
                    0.0
                } else {
                    (1.0 - asked / all).max(0.0)
                }) / exact.condition(0.0)
            } else if found > 1e-37 {
                (exact.depth(found) / asked - 1.0).abs() / exact.condition(found)
            } else {
                0.0
            };
            worst.see(error, at);
        }
    }
    worst
}

#[test]
fn atmospheres_are_inverted_as_well_as_their_exponents_allow() {
    const BOUND: f64 = 1e-6;
    let medium = |sigma_0: f32, k: f32| Exponential::new(sigma_0, [k, 0.0, 0.0]).expect("finite");
    let real = |sigma_0: f32, k: f32, origin: f32, depth: f32| {
        medium(sigma_0, k).distance(&ray([origin, 0.0, 0.0], [1.0, 0.0, 0.0]), depth)
    };
    air_distances(real).within("distance in an atmosphere, per condition", BOUND, 5_000);
    // The extinction first, then the logarithm of what is left: digits go wherever it is thin or straight.
    let naive = |sigma_0: f32, k: f32, origin: f32, depth: f32| {
        let s = sigma_0 * Real::exp(-(k * origin));
        -Real::ln((1.0 - k * depth / s).max(0.0)) / k
    };
    air_distances(naive).must_fail("an atmosphere by its textbook", BOUND);
}

#[test]
fn atmospheres_have_their_depth_and_extinction() {
    let (mut depths, mut sigmas) = (Worst::default(), Worst::default());
    let mut naive = Worst::default();
    for (sigma_0, k, origin) in airs() {
        let exact = air(sigma_0, k, origin);
        let medium = Exponential::new(sigma_0, [k, 0.0, 0.0]).expect("finite");
        let ray = ray([origin, 0.0, 0.0], [1.0, 0.0, 0.0]);
        for heights in [0.0_f32, 1e-12, 1e-6, 1e-3, 1.0, 20.0, 100.0] {
            let t = heights / k.abs();
            let (depth, sigma_t) = (exact.depth(t.into()), exact.sigma_t(t.into()));
            let condition = exact.condition(t.into());
            let at = || {
                format!(
                    "sigma_0 {sigma_0:e}, k {k:e}, h {}, heights {heights}",
                    exact.h
                )
            };
            if (1e-12..1e36).contains(&depth) {
                depths.see(
                    relative(medium.optical_depth(&ray, t), depth) / condition,
                    at,
                );
            }
            if (1e-36..1e37).contains(&sigma_t) {
                let mut walk = Medium::<f32>::idle(&medium);
                medium.begin(&mut walk, &ray, true);
                while Medium::<f32>::segment(&medium, &walk).t_exit < t {
                    medium.next_segment(&mut walk, true);
                }
                let found = medium.sigma_t(&walk, t, &mut stream(0), true);
                sigmas.see(relative(found, sigma_t) / condition, at);
                let exponent = k * origin + k * t;
                naive.see(
                    relative((sigma_0 * Real::exp(-exponent)).min(f32::MAX), sigma_t) / condition,
                    at,
                );
            }
        }
    }
    depths.within("depth of an atmosphere, per condition", 6e-7, 2_000);
    sigmas.within("extinction of an atmosphere, per condition", 6e-7, 2_000);
    naive.must_fail("one factor where two are needed", 6e-7);
}

#[test]
fn an_empty_atmosphere_never_collides() {
    for k in [-1e6_f32, -1.0, -1e-6, 0.0, 1.0, 1e6] {
        let empty = Exponential::new(0.0, [k, 0.0, 0.0]).expect("nothing is valid");
        for x in [-1e6_f32, -300.0, 0.0, 300.0, 1e6] {
            let ray = ray([x, 0.0, 0.0], [1.0, 0.0, 0.0]);
            for depth in [1e-12_f32, 1.0, 100.0] {
                assert_eq!(
                    empty.distance(&ray, depth),
                    f32::INFINITY,
                    "k {k:e}, x {x:e}"
                );
            }
            assert_eq!(empty.optical_depth(&ray, 1e6), 0.0, "k {k:e}, x {x:e}");
            assert_eq!(
                woodcock_core::majorant::majorant_depth(&empty, &ray, 1e6, true),
                0.0
            );
        }
    }
}
