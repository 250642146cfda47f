//! Reflectance and transmittance of plane slabs without surface reflection.
//!
//! Albedo and phase do not depend on depth, so the numbers hold for *every* extinction profile of the same vertical
//! optical thickness: the best test of a heterogeneous tracker. Uncertainty: 10⁻⁹ absolute.

use serde::Deserialize;

/// Reflected and transmitted share of the incident flux; the transmitted includes what never scattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluxes {
    /// R: leaves the lit face. Also the radiance seen there when its side is lit by radiance 1.
    pub reflectance: f64,
    /// T: leaves the far face. Also the radiance seen when only the far side is lit by radiance 1.
    pub transmittance: f64,
}

/// A homogeneous Henyey–Greenstein slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Vertical optical thickness.
    pub tau: f64,
    /// Mean cosine.
    pub g: f64,
    /// For a beam whose cosine to the inward normal is 1, 0.5, 0.1.
    pub beams: [(f64, Fluxes); 3],
    /// For uniform radiance over the hemisphere.
    pub diffuse: Fluxes,
}

/// A slab with another phase function, layers, a ground or an albedo that varies with depth.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Special {
    /// Its name.
    pub id: String,
    /// What it is made of.
    pub inputs: Inputs,
    /// Cosines of the beams.
    pub mu0: Vec<f64>,
    /// Reflectance for each, ground included.
    #[serde(rename = "R")]
    pub reflectance: Vec<f64>,
    /// Transmittance for each; over a ground, all flux that hits it.
    #[serde(rename = "T")]
    pub transmittance: Vec<f64>,
    /// Reflectance for uniform radiance.
    #[serde(rename = "Rdif")]
    pub diffuse_reflectance: f64,
    /// Transmittance for uniform radiance.
    #[serde(rename = "Tdif")]
    pub diffuse_transmittance: f64,
    /// Albedo of the Lambertian ground directly below; 0 is black.
    pub ground_albedo: f64,
}

/// What a special slab is made of.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
#[serde(deny_unknown_fields)]
pub enum Inputs {
    /// Homogeneous layers from the lit side, each (τ, albedo, g).
    Layers {
        /// From the lit side down.
        layers: Vec<[f64; 3]>,
    },
    /// Albedo a₀ + (a₁ − a₀) t/τ at optical depth t from the lit face, Henyey–Greenstein.
    AlbedoGradient {
        /// Albedo at the lit face.
        a0: f64,
        /// Albedo at the far face.
        a1: f64,
        /// Optical thickness.
        tau: f64,
        /// Mean cosine.
        g: f64,
    },
    /// Two Henyey–Greenstein lobes.
    Mixture {
        /// `hg_mixture`.
        phase: String,
        /// Mean cosine of the first.
        g1: f64,
        /// Mean cosine of the second.
        g2: f64,
        /// Share of the first.
        w: f64,
        /// Single-scattering albedo.
        albedo: f64,
        /// Optical thickness.
        tau: f64,
    },
    /// One phase function by name: `rayleigh`, `draine` (g is its parameter) or `hg`.
    Named {
        /// Its name.
        phase: String,
        /// Its g, where it has one.
        #[serde(default)]
        g: f64,
        /// Its α, where it has one.
        #[serde(default)]
        alpha: f64,
        /// Single-scattering albedo.
        albedo: f64,
        /// Optical thickness.
        tau: f64,
    },
}

/// The whole file.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// 64 homogeneous slabs.
    pub slabs: Vec<Slab>,
    /// The special ones.
    pub special: Vec<Special>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types, or its columns are not the ones read here.
pub fn load() -> Table {
    #[derive(Deserialize)]
    struct File {
        columns: Vec<String>,
        rows: Vec<[f64; 11]>,
        special_cases: Vec<Special>,
    }
    let file: File = super::parse("slab_matched", include_str!("../../refs/slab_matched.json"));
    assert_eq!(
        file.columns.join(" "),
        "albedo tau g R(mu0=1) T(mu0=1) R(mu0=0.5) T(mu0=0.5) R(mu0=0.1) T(mu0=0.1) Rdif Tdif"
    );
    let fluxes = |row: &[f64; 11], column: usize| Fluxes {
        reflectance: row[column],
        transmittance: row[column + 1],
    };
    let slabs = file.rows.iter().map(|row| Slab {
        albedo: row[0],
        tau: row[1],
        g: row[2],
        beams: [
            (1.0, fluxes(row, 3)),
            (0.5, fluxes(row, 5)),
            (0.1, fluxes(row, 7)),
        ],
        diffuse: fluxes(row, 9),
    });
    Table {
        slabs: slabs.collect(),
        special: file.special_cases,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::quadrature::{close, integrate};

    #[test]
    fn slabs_lose_only_what_they_absorb() {
        let table = load();
        assert_eq!(table.slabs.len(), 64);
        for slab in &table.slabs {
            for (mu0, f) in slab.beams {
                let sum = f.reflectance + f.transmittance;
                if slab.albedo == 1.0 {
                    close("balance", sum, 1.0, 2e-9);
                } else {
                    // At most all collided light is lost, at least the share lost at the first collision.
                    let collided = -(-slab.tau / mu0).exp_m1();
                    assert!(1.0 - sum < collided && 1.0 - sum > (1.0 - slab.albedo) * collided);
                }
                assert!(f.transmittance > (-slab.tau / mu0).exp() * (1.0 - 1e-9));
            }
        }
    }

    #[test]
    fn weak_scattering_tends_to_the_single_scattering_integral() {
        // R₁(1) = (a/2) ∫ dμ ∫ dt e^{−t(1 + 1/μ)} for an isotropic slab; later orders add a few times a τ of it.
        let table = load();
        let thin = table.slabs.iter().filter(|s| s.g == 0.0 && s.tau <= 0.1);
        for slab in thin {
            let first = 0.5
                * slab.albedo
                * integrate(0.0, 1.0, 40, |mu| {
                    let rate = 1.0 + 1.0 / mu;
                    -(-slab.tau * rate).exp_m1() / rate
                });
            let all = slab.beams[0].1.reflectance;
            let bound = first / (1.0 - slab.albedo * 2.5 * slab.tau);
            assert!(all > first && all < bound, "{first} {all} {bound}");
        }
    }

    #[test]
    fn published_slabs_are_among_them() {
        // Isotropic, perpendicular incidence; figures from an independent solver, six digits.
        let known = [
            (1.0, 1.0, 0.341_329, 0.658_671),
            (0.9, 1.0, 0.267_410, 0.591_625),
            (0.5, 1.0, 0.099_119, 0.446_058),
            (1.0, 4.0, 0.690_926, 0.309_074),
        ];
        let table = load();
        let mut found = 0;
        for (albedo, tau, r, t) in known {
            let same = |s: &&Slab| s.albedo == albedo && s.tau == tau && s.g == 0.0;
            if let Some(slab) = table.slabs.iter().find(same) {
                close("R", slab.beams[0].1.reflectance, r, 1e-6);
                close("T", slab.beams[0].1.transmittance, t, 1e-6);
                found += 1;
            }
        }
        assert!(found >= 2, "only {found} in common");
    }

    #[test]
    fn special_slabs_are_read_as_what_they_are() {
        let special = load().special;
        let named = |id: &str| special.iter().find(|s| s.id == id).expect("a special slab");
        assert!(matches!(named("layers").inputs, Inputs::Layers { .. }));
        assert!(matches!(
            named("albedo_gradient").inputs,
            Inputs::AlbedoGradient { .. }
        ));
        assert!(matches!(
            named("two_term_hg").inputs,
            Inputs::Mixture { .. }
        ));
        assert!(
            matches!(&named("draine").inputs, Inputs::Named { phase, alpha, .. }
            if phase == "draine" && *alpha == 1.0)
        );
        assert!(
            matches!(&named("rayleigh_tau0.5_a1").inputs, Inputs::Named { phase, .. }
            if phase == "rayleigh")
        );
        assert_eq!(named("ground").ground_albedo, 0.5);
        // Reciprocity: a stack transmits diffuse light alike from both sides.
        close(
            "reciprocity",
            named("layers").diffuse_transmittance,
            named("layers_reversed").diffuse_transmittance,
            2e-9,
        );
    }
}
