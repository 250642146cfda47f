//! Smooth interfaces and plain emitters: Fresnel reflectances and their averages, plates, irradiances.
//!
//! Reflectances are for unpolarised light. A diffuse average is 2 ∫₀¹ F(c) c dc. Uncertainty: 10⁻¹³, of the
//! diffuse averages 10⁻¹².

use serde::Deserialize;

/// Reflectance F = (Rs + Rp) / 2 of a smooth boundary between transparent matters.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "[f64; 7]")]
pub struct Dielectric {
    /// Refractive index on the side that light comes from.
    pub n1: f64,
    /// Refractive index on the other side.
    pub n2: f64,
    /// Cosine of incidence.
    pub cos_i: f64,
    /// F; 1 beyond the critical angle.
    pub reflectance: f64,
    /// Rs, the reflectance of light polarised across the plane of incidence.
    pub perpendicular: f64,
    /// Rp, the reflectance of light polarised in the plane of incidence.
    pub parallel: f64,
    /// Cosine of refraction; 0 beyond the critical angle.
    pub cos_t: f64,
}

impl From<[f64; 7]> for Dielectric {
    fn from([n1, n2, cos_i, reflectance, perpendicular, parallel, cos_t]: [f64; 7]) -> Self {
        Self {
            n1,
            n2,
            cos_i,
            reflectance,
            perpendicular,
            parallel,
            cos_t,
        }
    }
}

/// Reflectance of a metal in vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "[f64; 6]")]
pub struct Conductor {
    /// Real part of the refractive index.
    pub eta: f64,
    /// Its extinction coefficient: the index is η + ik.
    pub k: f64,
    /// Cosine of incidence.
    pub cos_i: f64,
    /// F.
    pub reflectance: f64,
    /// Rs, the reflectance of light polarised across the plane of incidence.
    pub perpendicular: f64,
    /// Rp, the reflectance of light polarised in the plane of incidence.
    pub parallel: f64,
}

impl From<[f64; 6]> for Conductor {
    fn from([eta, k, cos_i, reflectance, perpendicular, parallel]: [f64; 6]) -> Self {
        Self {
            eta,
            k,
            cos_i,
            reflectance,
            perpendicular,
            parallel,
        }
    }
}

/// Reflectances of a smooth boundary for uniform light: 1 − F_internal = (1 − F_external) / n².
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "[f64; 3]")]
pub struct DiffuseAverage {
    /// Refractive index of the matter.
    pub n: f64,
    /// Light in vacuum.
    pub external: f64,
    /// Light in the matter.
    pub internal: f64,
}

impl From<[f64; 3]> for DiffuseAverage {
    fn from([n, external, internal]: [f64; 3]) -> Self {
        Self {
            n,
            external,
            internal,
        }
    }
}

/// A smooth plate that absorbs and does not scatter, in vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Plate {
    /// Refractive index.
    pub n: f64,
    /// Optical thickness across.
    pub tau: f64,
    /// Cosine of incidence, outside.
    pub mu0: f64,
    /// Reflectance with the unpolarised F at every bounce.
    #[serde(rename = "R")]
    pub reflectance: f64,
    /// Transmittance with the unpolarised F at every bounce.
    #[serde(rename = "T")]
    pub transmittance: f64,
    /// Reflectance of light whose polarisation is kept track of.
    #[serde(rename = "R_pol")]
    pub polarised_reflectance: f64,
    /// Transmittance of light whose polarisation is kept track of.
    #[serde(rename = "T_pol")]
    pub polarised_transmittance: f64,
}

/// A Lambertian emitter of radiance 1 over a surface at the origin whose normal is +z, in vacuum.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Emitter {
    /// A sphere, fully above the horizon.
    Sphere {
        /// Its radius.
        #[serde(rename = "R")]
        radius: f64,
        /// Distance of its centre.
        #[serde(rename = "d")]
        distance: f64,
        /// Angle between the normal and the direction to the centre, degrees.
        angle_deg: f64,
    },
    /// A disk parallel to the surface around the normal.
    Disk {
        /// Its radius.
        #[serde(rename = "R")]
        radius: f64,
        /// Its height.
        #[serde(rename = "h")]
        height: f64,
    },
    /// A rectangle [x0, x1] × [y0, y1] parallel to the surface.
    Rectangle {
        /// x0, x1, y0, y1 and its height.
        #[serde(rename = "x0,x1,y0,y1,h")]
        extent: [f64; 5],
    },
}

/// What arrives from an emitter.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Irradiance {
    /// Which emitter.
    #[serde(flatten)]
    pub emitter: Emitter,
    /// E.
    #[serde(rename = "E")]
    pub irradiance: f64,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Tables {
    /// Smooth boundaries of transparent matters.
    pub dielectric: Vec<Dielectric>,
    /// Smooth metals.
    pub conductor: Vec<Conductor>,
    /// Smooth boundaries under uniform light.
    pub diffuse_average: Vec<DiffuseAverage>,
    /// Absorbing plates.
    pub plate: Vec<Plate>,
    /// Emitters over a surface.
    pub irradiance: Vec<Irradiance>,
}

/// Reads the tables.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Tables {
    super::parse("surfaces", include_str!("../../refs/surfaces.json"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_tables_are_whole_and_agree_with_themselves() {
        let tables = load();
        assert_eq!(tables.dielectric.len(), 15);
        assert_eq!(tables.conductor.len(), 6);
        assert_eq!(tables.diffuse_average.len(), 4);
        assert_eq!(tables.plate.len(), 3);
        assert_eq!(tables.irradiance.len(), 3);
        for row in &tables.dielectric {
            let mean = (row.perpendicular + row.parallel) / 2.0;
            assert!((row.reflectance - mean).abs() < 1e-13, "{row:?}");
            let sin2 = (row.n1 / row.n2).powi(2) * (1.0 - row.cos_i * row.cos_i);
            let cos_t = (1.0 - sin2).max(0.0).sqrt();
            assert!((row.cos_t - cos_t).abs() < 1e-13, "{row:?}");
        }
        for row in &tables.conductor {
            let mean = (row.perpendicular + row.parallel) / 2.0;
            assert!((row.reflectance - mean).abs() < 1e-13, "{row:?}");
        }
        for row in &tables.diffuse_average {
            let reciprocal = (1.0 - row.internal) * row.n * row.n;
            assert!((1.0 - row.external - reciprocal).abs() < 1e-12, "{row:?}");
        }
        for row in &tables.plate {
            let kept = row.reflectance + row.transmittance;
            assert!(kept < 1.0 + 1e-12 && (row.tau > 0.0 || kept > 1.0 - 1e-12));
        }
    }

    #[test]
    fn irradiances_follow_closed_forms() {
        for row in load().irradiance {
            let expected = match row.emitter {
                Emitter::Sphere {
                    radius,
                    distance,
                    angle_deg,
                } => PI * (radius / distance).powi(2) * angle_deg.to_radians().cos(),
                Emitter::Disk { radius, height } => {
                    PI * radius * radius / (radius * radius + height * height)
                }
                Emitter::Rectangle {
                    extent: [x0, x1, y0, y1, h],
                } => {
                    // The corner formula of the view factor from a point to a parallel rectangle.
                    let corner = |x: f64, y: f64| {
                        let (a, b) = (x / x.hypot(h), y / y.hypot(h));
                        0.5 * (a * (y / x.hypot(h)).atan() + b * (x / y.hypot(h)).atan())
                    };
                    corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0)
                }
            };
            assert!((row.irradiance - expected).abs() < 1e-12, "{row:?}");
        }
    }
}
