//! Densities with known optical depth: what a tracker flies through when it must hit a number.
//!
//! Twelve fields with four rays each, from the table [`crate::refs::transmittance`]. Positions are `f64`, extinctions
//! [1/length]. A field is a function of position; [`Fixture::along`] is the same along a ray. Everything an
//! unbiased estimator promises follows from four numbers per ray:
//!
//! ```text
//! delta:           E W = T                E W² = T
//! ratio:           E W = T                E W² = e^(−2τ + ∫σ²/σ̄)               look-ups Poisson(σ̄L)
//! residual ratio:  E W = T                E W² = e^(−2τ + ∫(σ−c)²/r)           look-ups Poisson(rL)
//! ```
//!
//! for a constant majorant σ̄, control c and residual rate r ≥ |σ − c|. So a wrong variance is an error like a wrong
//! mean. Rounding a position to `f32` moves the optical depth by about 10⁻⁶ of itself, more across the jumps of
//! `checkerboard`, `nearest_grid` and `thin_shell`. Source: [Novák, Selle, Jarosz 2014].

use crate::refs::transmittance::{Case, Field, Grid, Ray, load};
use crate::widths::per_lane;
use woodcock_core::medium::Procedural;
use woodcock_core::real::Real;
use woodcock_core::vec3::Vec3;

/// One field with one ray through it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fixture {
    /// Field and ray, for messages: `linear/0`.
    pub name: String,
    /// The density.
    pub field: Field,
    /// σ̄ ≥ σ_t everywhere in `bounds` [1/length].
    pub majorant: f64,
    /// Box that the majorant covers; none for `planet`, whose majorant holds outside its ground.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// The ray and what is known along it.
    pub ray: Ray,
}

/// All fixtures, four per field.
///
/// # Panics
/// When the table is damaged.
pub fn all() -> Vec<Fixture> {
    let fixtures = |case: Case| {
        let Case {
            field,
            bounds,
            majorant,
            rays,
        } = case;
        rays.into_iter().enumerate().map(move |(i, ray)| Fixture {
            name: format!("{}/{i}", field.name()),
            field: field.clone(),
            majorant,
            bounds,
            ray,
        })
    };
    load().into_iter().flat_map(fixtures).collect()
}

/// The four fixtures of one field.
///
/// # Panics
/// When no field is called that.
pub fn of_field(name: &str) -> Vec<Fixture> {
    let mut fixtures = all();
    fixtures.retain(|fixture| fixture.field.name() == name);
    assert!(!fixtures.is_empty(), "no field is called {name:?}");
    fixtures
}

impl Fixture {
    /// The field as a function of position.
    pub fn sigma_t(&self) -> impl Fn(f64, f64, f64) -> f64 + '_ {
        move |x, y, z| self.field.sigma_t(x, y, z)
    }

    /// The field as a function of distance along the ray.
    pub fn along(&self) -> impl Fn(f64) -> f64 + '_ {
        move |t| {
            let [x, y, z] = self.ray.at(t);
            self.field.sigma_t(x, y, z)
        }
    }

    /// Below the field everywhere on its ray [1/length]: nine tenths of the least of many values there.
    pub fn minimum(&self) -> f64 {
        let at = |i: u32| self.along()(self.ray.t_max * f64::from(i) / 4096.0);
        0.9 * (0..=4096).map(at).fold(self.majorant, f64::min)
    }

    /// The field's mean on its ray [1/length].
    pub fn mean(&self) -> f64 {
        self.ray.optical_depth / self.ray.t_max
    }

    /// The field as a medium for its ray, under its bound times `loose`, and with its controls.
    pub fn medium<R: Real>(&self, loose: f32) -> Procedural<impl Fn(Vec3<R>) -> R + '_> {
        let majorant = (self.majorant as f32).next_up() * loose;
        Procedural::new(per_lane(self.sigma_t()), majorant)
            .with_control(self.minimum() as f32, self.mean() as f32)
    }

    /// E W² of ratio tracking with a constant `majorant` [1/length]; at least σ_t is not needed, positive is.
    pub fn ratio_second_moment(&self, majorant: f64) -> f64 {
        self.residual_second_moment(0.0, majorant)
    }

    /// E W² of residual ratio tracking with constant `control` and residual `rate` [1/length].
    pub fn residual_second_moment(&self, control: f64, rate: f64) -> f64 {
        let ray = &self.ray;
        let squared = ray.squared_integral - 2.0 * control * ray.optical_depth
            + control * control * ray.t_max;
        (squared / rate - 2.0 * ray.optical_depth).exp()
    }

    /// Variance of one weight of delta tracking, T(1 − T).
    pub fn delta_variance(&self) -> f64 {
        self.ray.transmittance * -(-self.ray.optical_depth).exp_m1()
    }

    /// Mean number of look-ups of delta tracking: tentative collisions up to the real one or the end.
    pub fn delta_lookups(&self, majorant: f64) -> f64 {
        majorant * self.ray.mean_free_flight
    }

    /// Mean number of look-ups of ratio tracking, which walks the whole ray.
    pub fn ratio_lookups(&self, majorant: f64) -> f64 {
        majorant * self.ray.t_max
    }

    /// P(collision) before a quarter, half and three quarters of the ray, and before its end.
    pub fn collision_probabilities(&self) -> [(f64, f64); 4] {
        let [first, half, third] = self.ray.quarter_depths;
        let depths = [first, half, third, self.ray.optical_depth];
        std::array::from_fn(|i| {
            let t = self.ray.t_max * (i + 1) as f64 / 4.0;
            (t, -(-depths[i]).exp_m1())
        })
    }

    /// Distances along the ray, ascending and within it, where the field jumps or has a kink.
    ///
    /// Quadrature must not straddle them; between them the field is smooth.
    pub fn breaks(&self) -> Vec<f64> {
        let ray = &self.ray;
        let mut breaks = match &self.field {
            Field::Checkerboard { h, .. } => ray.crossings(*h),
            Field::TrilinearGrid { .. } | Field::NearestGrid { .. } => ray.crossings(1.0),
            Field::Cone { c, radius, .. } => ray.sphere(*c, *radius).to_vec(),
            Field::ThinShell { c, r1, r2, .. } => {
                [ray.sphere(*c, *r1), ray.sphere(*c, *r2)].concat()
            }
            _ => Vec::new(),
        };
        breaks.retain(|&t| t > 0.0 && t < ray.t_max);
        breaks.sort_by(f64::total_cmp);
        breaks
    }
}

impl Ray {
    /// The point at distance `t` \[length\].
    pub fn at(&self, t: f64) -> [f64; 3] {
        std::array::from_fn(|i| self.origin[i] + t * self.dir[i])
    }

    /// Where it crosses planes at whole multiples of `h` on any axis.
    fn crossings(&self, h: f64) -> Vec<f64> {
        let end = self.at(self.t_max);
        let mut crossings = Vec::new();
        for (axis, far) in end.iter().enumerate() {
            let near = self.origin[axis];
            let first = (near.min(*far) / h).ceil() as i64;
            let last = (near.max(*far) / h).floor() as i64;
            for k in first..=last {
                crossings.push((k as f64 * h - near) / self.dir[axis]);
            }
        }
        crossings
    }

    /// Where it enters and leaves a sphere; NaN where it misses, which no range contains.
    fn sphere(&self, center: [f64; 3], radius: f64) -> [f64; 2] {
        let from: [f64; 3] = std::array::from_fn(|i| self.origin[i] - center[i]);
        let along: f64 = (0..3).map(|i| from[i] * self.dir[i]).sum();
        let squared: f64 = from.iter().map(|v| v * v).sum();
        let half = (along * along - squared + radius * radius).sqrt();
        [-along - half, -along + half]
    }
}

impl Field {
    /// Its name in the table.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Linear { .. } => "linear",
            Self::ExponentialZ { .. } => "exponential_z",
            Self::Planet { .. } => "planet",
            Self::Gaussian { .. } => "gaussian",
            Self::ThreeGaussians { .. } => "three_gaussians",
            Self::PlaneWave { .. } => "plane_wave",
            Self::SineProduct { .. } => "sine_product",
            Self::Checkerboard { .. } => "checkerboard",
            Self::TrilinearGrid { .. } => "trilinear_grid",
            Self::NearestGrid { .. } => "nearest_grid",
            Self::Cone { .. } => "cone",
            Self::ThinShell { .. } => "thin_shell",
        }
    }

    /// Extinction at a point [1/length]. Total: grids repeat their outermost values beyond their domain.
    pub fn sigma_t(&self, x: f64, y: f64, z: f64) -> f64 {
        let gaussian = |peak: f64, c: [f64; 3], s: f64| {
            let d = distance([x, y, z], c);
            peak * (-d * d / (2.0 * s * s)).exp()
        };
        match self {
            Self::Linear { s0, k } => s0 + k[0] * x + k[1] * y + k[2] * z,
            Self::ExponentialZ { s0, height } => s0 * (-z / height).exp(),
            Self::Planet { s0, height, ground } => {
                s0 * ((ground - distance([x, y, z], [0.0; 3])) / height).exp()
            }
            Self::Gaussian { peak, c, s } => gaussian(*peak, *c, *s),
            Self::ThreeGaussians { blobs } => {
                blobs.iter().map(|&(a, c, s)| gaussian(a, c, s)).sum()
            }
            Self::PlaneWave {
                mean,
                amplitude,
                k,
                phi,
            } => mean * (1.0 + amplitude * (k[0] * x + k[1] * y + k[2] * z + phi).sin()),
            Self::SineProduct {
                mean,
                amplitude,
                k,
                p,
            } => {
                let product = (k * x + p[0]).sin() * (k * y + p[1]).sin() * (k * z + p[2]).sin();
                mean * (1.0 + amplitude * product)
            }
            Self::Checkerboard { even, odd, h } => {
                let cells = (x / h).floor() + (y / h).floor() + (z / h).floor();
                if cells.rem_euclid(2.0) == 0.0 {
                    *even
                } else {
                    *odd
                }
            }
            Self::TrilinearGrid { scale, grid } => scale * trilinear(grid, [x, y, z]),
            Self::NearestGrid { scale, grid } => {
                let [i, j, k] = [x, y, z].map(|v| v.floor().clamp(0.0, 4.0) as usize);
                scale * grid[i][j][k]
            }
            Self::Cone { peak, c, radius } => {
                peak * (1.0 - distance([x, y, z], *c) / radius).max(0.0)
            }
            Self::ThinShell { inside, c, r1, r2 } => {
                let d = distance([x, y, z], *c);
                if *r1 < d && d < *r2 { *inside } else { 0.0 }
            }
        }
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// Trilinear between values at whole coordinates.
fn trilinear(grid: &Grid, position: [f64; 3]) -> f64 {
    let lower = position.map(|v| v.floor().clamp(0.0, 3.0));
    let share: [f64; 3] = std::array::from_fn(|i| (position[i] - lower[i]).clamp(0.0, 1.0));
    let [i, j, k] = lower.map(|v| v as usize);
    let mut value = 0.0;
    for corner in 0..8 {
        let bit = [corner & 1, corner >> 1 & 1, corner >> 2];
        let weight: f64 = (0..3)
            .map(|a| {
                if bit[a] == 1 {
                    share[a]
                } else {
                    1.0 - share[a]
                }
            })
            .product();
        value += weight * grid[i + bit[0]][j + bit[1]][k + bit[2]];
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::quadrature::{close, integrate};
    use crate::stats::independent::SplitMix;
    use crate::stats::{KolmogorovSmirnov, Sample, assert_agrees, assert_verdict};

    /// Smooth stretches of [0, end), short against any wave of the fields.
    fn stretches(fixture: &Fixture, end: f64) -> Vec<[f64; 2]> {
        let mut edges = fixture.breaks();
        edges.retain(|&t| t < end);
        let step = fixture.ray.t_max / 64.0;
        edges.extend((0..64).map(|i| f64::from(i) * step).filter(|&t| t < end));
        edges.push(end);
        edges.sort_by(f64::total_cmp);
        edges.windows(2).map(|w| [w[0], w[1]]).collect()
    }

    fn depth(fixture: &Fixture, end: f64) -> f64 {
        let sigma_t = fixture.along();
        let parts = stretches(fixture, end);
        parts
            .iter()
            .map(|&[a, b]| integrate(a, b, 1, &sigma_t))
            .sum()
    }

    #[test]
    fn quadrature_of_the_fields_reproduces_every_number() {
        let fixtures = all();
        assert_eq!(fixtures.len(), 48);
        for fixture in &fixtures {
            let (name, ray) = (&fixture.name, &fixture.ray);
            let sigma_t = fixture.along();
            let (mut start, mut flight, mut emission, mut squared) = (0.0, 0.0, 0.0, 0.0);
            for [a, b] in stretches(fixture, ray.t_max) {
                let attenuation = |t: f64| (-(start + integrate(a, t, 1, &sigma_t))).exp();
                flight += integrate(a, b, 1, attenuation);
                emission += integrate(a, b, 1, |t| {
                    sigma_t(t) * attenuation(t) * (1.0 + ray.at(t)[0])
                });
                squared += integrate(a, b, 1, |t| sigma_t(t).powi(2));
                start += integrate(a, b, 1, &sigma_t);
            }
            close(name, start, ray.optical_depth, 1e-11);
            close(name, (-start).exp(), ray.transmittance, 1e-11);
            close(name, flight, ray.mean_free_flight, 1e-11);
            close(name, emission, ray.emission, 1e-11);
            close(name, squared, ray.squared_integral, 1e-11);
            for (t, probability) in fixture.collision_probabilities() {
                close(name, -(-depth(fixture, t)).exp_m1(), probability, 1e-11);
            }
        }
    }

    #[test]
    fn majorants_bound_their_fields() {
        let mut rng = SplitMix::new(401);
        for fixture in all() {
            let bounded = |sigma_t: f64, at: &dyn std::fmt::Debug| {
                let inside = (0.0..=fixture.majorant * (1.0 + 1e-12)).contains(&sigma_t);
                assert!(inside, "{}: {sigma_t} at {at:?}", fixture.name);
            };
            let length: f64 = fixture.ray.dir.iter().map(|d| d * d).sum();
            close("unit direction", length, 1.0, 1e-12);
            for i in 0..=1000 {
                let t = fixture.ray.t_max * f64::from(i) / 1000.0;
                bounded(fixture.along()(t), &t);
            }
            if let Some([low, high]) = fixture.bounds {
                for _ in 0..2000 {
                    let x = low.map(|_| rng.uniform());
                    let x: [f64; 3] = std::array::from_fn(|i| low[i] + x[i] * (high[i] - low[i]));
                    bounded(fixture.sigma_t()(x[0], x[1], x[2]), &x);
                }
                for t in [0.0, fixture.ray.t_max] {
                    let x = fixture.ray.at(t);
                    let inside = (0..3).all(|i| x[i] >= low[i] - 1e-6 && x[i] <= high[i] + 1e-6);
                    assert!(inside, "{}: {x:?} at {t}", fixture.name);
                }
            }
        }
    }

    /// Ratio tracking in double precision: (weight, look-ups).
    fn ratio(fixture: &Fixture, control: f64, rate: f64, rng: &mut SplitMix) -> (f64, f64) {
        let sigma_t = fixture.along();
        let (mut t, mut weight, mut lookups) = (0.0, (-control * fixture.ray.t_max).exp(), 0.0);
        loop {
            t += rng.exponential() / rate;
            if t >= fixture.ray.t_max {
                return (weight, lookups);
            }
            lookups += 1.0;
            weight *= 1.0 - (sigma_t(t) - control) / rate;
        }
    }

    #[test]
    fn estimators_have_the_stated_moments() {
        for fixture in of_field("linear")
            .into_iter()
            .chain(of_field("sine_product"))
        {
            let (name, majorant) = (&fixture.name, fixture.majorant);
            let control = 0.5 * majorant;
            let mut rng = SplitMix::new(402);
            let [mut mean, mut square, mut lookups, mut residual] = [Sample::new(); 4];
            for _ in 0..1 << 17 {
                let (weight, count) = ratio(&fixture, 0.0, majorant, &mut rng);
                mean.push(weight);
                square.push(weight * weight);
                lookups.push(count);
                residual.push(
                    ratio(&fixture, control, 0.75 * majorant, &mut rng)
                        .0
                        .powi(2),
                );
            }
            let expected = fixture.residual_second_moment(control, 0.75 * majorant);
            assert_agrees(name, &mean, fixture.ray.transmittance, 0.05);
            assert_agrees(name, &square, fixture.ratio_second_moment(majorant), 0.1);
            assert_agrees(name, &lookups, fixture.ratio_lookups(majorant), 0.01);
            assert_agrees(name, &residual, expected, 0.1);
        }
    }

    #[test]
    fn flights_follow_the_stated_law() {
        for fixture in of_field("linear") {
            let sigma_t = fixture.along();
            let mut rng = SplitMix::new(403);
            let (mut distances, mut escaped, mut lookups) = (Vec::new(), 0, Sample::new());
            for _ in 0..1 << 17 {
                let (mut t, mut count) = (0.0, 0.0);
                loop {
                    t += rng.exponential() / fixture.majorant;
                    if t >= fixture.ray.t_max {
                        escaped += 1;
                        break;
                    }
                    count += 1.0;
                    if rng.uniform() * fixture.majorant < sigma_t(t) {
                        distances.push(t);
                        break;
                    }
                }
                lookups.push(count);
            }
            // σ is linear along the ray, so its integral is the trapezium.
            let cdf = |t: f64| -(-0.5 * t * (sigma_t(0.0) + sigma_t(t))).exp_m1();
            let ks = KolmogorovSmirnov::censored(&mut distances, escaped, fixture.ray.t_max, cdf);
            assert_verdict(&fixture.name, ks.verdict(0.01));
            let expected = fixture.delta_lookups(fixture.majorant);
            assert_agrees(&fixture.name, &lookups, expected, 0.01);
        }
    }
}
