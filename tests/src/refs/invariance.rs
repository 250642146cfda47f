//! Exact invariants of scattering bodies under uniform isotropic light.
//!
//! Photons enter a convex body at uniform points of its surface, Lambertian about the inward normal, and scatter
//! without loss until they leave. For *any* density and *any* phase function the mean path is 4V/S, the mean number of
//! real collisions (4/S) ∫ σ_s dV, of null collisions under a constant majorant (4/S) ∫ (σ̄ − σ_s) dV, and the mean path
//! within a part of volume v is 4v/S. Exact to rounding. Source: [Blanco, Fournier 2003].

use serde::Deserialize;

/// The body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A ball at the origin, by its radius \[length\].
    Sphere(f64),
    /// [0, a] × [0, b] × [0, c] \[length\].
    Block([f64; 3]),
}

/// The scattering coefficient inside [1/length].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// The same everywhere.
    Homogeneous(f64),
    /// s₀ + k · x: s₀, then k.
    Linear([f64; 4]),
    /// A e^(−|x − c|²/2s²): A, then c, then s.
    Gaussian([f64; 5]),
    /// A in even cells of edge h, else B: A, B, h.
    Checkerboard([f64; 3]),
    /// A (1 + B sin kx sin ky sin kz): A, B, k.
    SineProduct([f64; 3]),
}

impl Density {
    /// Scattering coefficient at a point [1/length].
    pub fn sigma_s(&self, x: f64, y: f64, z: f64) -> f64 {
        match *self {
            Self::Homogeneous(sigma) => sigma,
            Self::Linear([s0, kx, ky, kz]) => s0 + kx * x + ky * y + kz * z,
            Self::Gaussian([peak, cx, cy, cz, s]) => {
                let squared = (x - cx).powi(2) + (y - cy).powi(2) + (z - cz).powi(2);
                peak * (-squared / (2.0 * s * s)).exp()
            }
            Self::Checkerboard([even, odd, h]) => {
                let cells = (x / h).floor() + (y / h).floor() + (z / h).floor();
                if cells.rem_euclid(2.0) == 0.0 {
                    even
                } else {
                    odd
                }
            }
            Self::SineProduct([mean, amplitude, k]) => {
                mean * (1.0 + amplitude * (k * x).sin() * (k * y).sin() * (k * z).sin())
            }
        }
    }
}

/// A body and its invariants.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
    /// What scatters inside.
    pub density: Density,
    /// σ̄, a bound of the density [1/length].
    pub majorant: f64,
    /// V \[length³\].
    pub volume: f64,
    /// S \[length²\].
    pub surface: f64,
    /// Centre of a small ball inside the body.
    pub part_center: [f64; 3],
    /// Its radius \[length\].
    pub part_radius: f64,
    /// Mean path per photon \[length\].
    pub mean_path: f64,
    /// Mean number of real collisions per photon.
    pub mean_collisions: f64,
    /// Mean number of null collisions per photon.
    pub mean_null: f64,
    /// Mean path within the small ball \[length\].
    pub mean_path_part: f64,
}

/// Probability of leaving a homogeneous ball without a collision.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct FirstFlight {
    /// Optical radius.
    pub t: f64,
    /// P₀, for photons born uniformly and isotropically inside.
    #[serde(rename = "P0")]
    pub escape: f64,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Bodies.
    pub cases: Vec<Case>,
    /// First flights.
    pub first_flight: Vec<FirstFlight>,
}

#[derive(Deserialize)]
struct RawCase {
    case: String,
    #[serde(rename = "R")]
    radius: Option<f64>,
    abc: Option<[f64; 3]>,
    sigma: serde_json::Value,
    #[serde(rename = "s0,kx,ky,kz")]
    linear: Option<[f64; 4]>,
    #[serde(rename = "A,cx,cy,cz,s")]
    gaussian: Option<[f64; 5]>,
    #[serde(rename = "A,B,h")]
    checkerboard: Option<[f64; 3]>,
    #[serde(rename = "A,B,k")]
    sine: Option<[f64; 3]>,
    #[serde(rename = "V")]
    volume: f64,
    #[serde(rename = "S")]
    surface: f64,
    majorant: f64,
    sub_sphere_center_radius: [f64; 4],
    mean_path: f64,
    mean_collisions: f64,
    mean_null: f64,
    mean_path_sub: f64,
}

impl RawCase {
    fn density(&self) -> Option<Density> {
        self.sigma
            .as_f64()
            .map(Density::Homogeneous)
            .or(self.linear.map(Density::Linear))
            .or(self.gaussian.map(Density::Gaussian))
            .or(self.checkerboard.map(Density::Checkerboard))
            .or(self.sine.map(Density::SineProduct))
    }
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types, or names a density that is not known here.
pub fn load() -> Table {
    #[derive(Deserialize)]
    struct File {
        cases: Vec<RawCase>,
        first_flight_sphere: Vec<FirstFlight>,
    }
    let file: File = super::parse("invariance", include_str!("../../refs/invariance.json"));
    let cases = file.cases.into_iter().map(|raw| {
        let Some(density) = raw.density() else {
            panic!("refs/invariance.json: {}: no such density", raw.case)
        };
        // Bodies without a size of their own are the unit cube.
        let block = Shape::Block(raw.abc.unwrap_or([1.0; 3]));
        let [x, y, z, part_radius] = raw.sub_sphere_center_radius;
        Case {
            name: raw.case,
            shape: raw.radius.map_or(block, Shape::Sphere),
            density,
            majorant: raw.majorant,
            volume: raw.volume,
            surface: raw.surface,
            part_center: [x, y, z],
            part_radius,
            mean_path: raw.mean_path,
            mean_collisions: raw.mean_collisions,
            mean_null: raw.mean_null,
            mean_path_part: raw.mean_path_sub,
        }
    });
    Table {
        cases: cases.collect(),
        first_flight: file.first_flight_sphere,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::quadrature::{close, integrate};
    use crate::refs::walk::{Body, walk};
    use crate::stats::independent::SplitMix;
    use crate::stats::{Sample, assert_agrees};
    use std::f64::consts::PI;

    #[test]
    fn invariants_follow_from_volume_surface_and_density() {
        let table = load();
        assert_eq!(table.cases.len(), 7);
        for case in &table.cases {
            let name = &case.name;
            let per_surface = 4.0 / case.surface;
            let (volume, surface, collisions) = match case.shape {
                Shape::Sphere(r) => {
                    let volume = 4.0 / 3.0 * PI * r.powi(3);
                    (
                        volume,
                        4.0 * PI * r * r,
                        volume * case.density.sigma_s(0.0, 0.0, 0.0),
                    )
                }
                Shape::Block([a, b, c]) => {
                    let total = integrate(0.0, a, 8, |x| {
                        integrate(0.0, b, 8, |y| {
                            integrate(0.0, c, 8, |z| case.density.sigma_s(x, y, z))
                        })
                    });
                    (a * b * c, 2.0 * (a * b + b * c + c * a), total)
                }
            };
            close(name, volume, case.volume, 1e-13);
            close(name, surface, case.surface, 1e-13);
            close(name, per_surface * volume, case.mean_path, 1e-13);
            close(name, per_surface * collisions, case.mean_collisions, 1e-11);
            let null = per_surface * (case.majorant * volume - collisions);
            close(name, null, case.mean_null, 1e-11);
            let part = 4.0 / 3.0 * PI * case.part_radius.powi(3);
            close(name, per_surface * part, case.mean_path_part, 1e-13);
        }
    }

    #[test]
    fn a_plain_walk_finds_them_too() {
        for (i, case) in load().cases.iter().enumerate() {
            let sigma = |x: f64, y: f64, z: f64| case.density.sigma_s(x, y, z);
            let body = match case.shape {
                Shape::Sphere(r) => Body::sphere(r, case.majorant, &sigma),
                Shape::Block(abc) => Body::block(abc, case.majorant, &sigma),
            };
            let mut rng = SplitMix::new(300 + i as u64);
            let (mut path, mut real, mut null) = (Sample::new(), Sample::new(), Sample::new());
            for _ in 0..100_000 {
                let (point, dir) = body.enter(&mut rng);
                let end = walk(&body, 0.4, point, dir, &mut rng);
                path.push(end.path);
                real.push(f64::from(end.real));
                null.push(f64::from(end.null));
            }
            assert_agrees(&case.name, &path, case.mean_path, 0.02);
            assert_agrees(&case.name, &real, case.mean_collisions, 0.02);
            assert_agrees(&case.name, &null, case.mean_null, 0.02);
        }
    }

    #[test]
    fn first_flights_follow_their_formula() {
        for FirstFlight { t, escape } in load().first_flight {
            // P₀ = S/(4Vσ) ⟨1 − e^{−σ l}⟩ over chords l = 2Rμ of density 2μ, and S/(4V) = 3/(4R).
            let expected = 1.5 / t * integrate(0.0, 1.0, 8, |mu| mu * -(-2.0 * t * mu).exp_m1());
            close("first flight", expected, escape, 1e-12);
        }
    }
}
