//! Reflectance and transmittance of plane slabs between smooth faces that reflect and refract.
//!
//! Refractive index n inside, 1 outside; at both faces Fresnel's reflectance of unpolarised light, from either side. R
//! includes what the lit face mirrors, T what never scattered. Henyey–Greenstein. Uncertainty: 2·10⁻⁸ absolute.

use super::slab_matched::Fluxes;
use serde::Deserialize;

/// A beam on a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Cosine of incidence, outside.
    pub mu0: f64,
    /// What the lit face mirrors at once.
    pub specular: f64,
    /// All that leaves either face.
    pub fluxes: Fluxes,
}

/// A homogeneous slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Single-scattering albedo.
    pub albedo: f64,
    /// Vertical optical thickness; `None` is a half-space.
    pub tau: Option<f64>,
    /// Mean cosine.
    pub g: f64,
    /// Refractive index.
    pub n: f64,
    /// For a beam whose cosine to the inward normal is 1, 0.5.
    pub beams: [Beam; 2],
    /// For uniform radiance over the hemisphere outside.
    pub diffuse: Fluxes,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types, or its columns are not the ones read here.
pub fn load() -> Vec<Slab> {
    #[derive(Deserialize)]
    struct File {
        columns: Vec<String>,
        rows: Vec<[Option<f64>; 12]>,
    }
    let file: File = super::parse(
        "slab_mismatched",
        include_str!("../../refs/slab_mismatched.json"),
    );
    assert_eq!(
        file.columns.join(" "),
        "albedo tau (null = semi-infinite) g n r_specular(mu0=1) R(mu0=1) T(mu0=1) \
         r_specular(mu0=0.5) R(mu0=0.5) T(mu0=0.5) Rdif Tdif"
    );
    file.rows.iter().map(slab).collect()
}

fn slab(row: &[Option<f64>; 12]) -> Slab {
    let at = |column: usize| row[column].expect("only a thickness may be missing");
    let fluxes = |column| Fluxes {
        reflectance: at(column),
        transmittance: at(column + 1),
    };
    let beam = |mu0, column| Beam {
        mu0,
        specular: at(column),
        fluxes: fluxes(column + 1),
    };
    Slab {
        albedo: at(0),
        tau: row[1],
        g: at(2),
        n: at(3),
        beams: [beam(1.0, 4), beam(0.5, 7)],
        diffuse: fluxes(10),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::quadrature::close;
    use crate::refs::surfaces;

    /// Reflectance of a smooth face by Fresnel's equations, seen from outside.
    fn fresnel(n: f64, cos: f64) -> f64 {
        let refracted = (n * n - 1.0 + cos * cos).sqrt();
        let across = (cos - refracted) / (cos + refracted);
        let along = (n * n * cos - refracted) / (n * n * cos + refracted);
        0.5 * (across * across + along * along)
    }

    #[test]
    fn slabs_lose_only_what_they_absorb() {
        let slabs = load();
        assert_eq!(slabs.len(), 12);
        assert_eq!(slabs.iter().filter(|s| s.tau.is_none()).count(), 3);
        for slab in &slabs {
            let beams = slab.beams.iter().map(|b| b.fluxes);
            for fluxes in beams.chain([slab.diffuse]) {
                let sum = fluxes.reflectance + fluxes.transmittance;
                if slab.albedo == 1.0 {
                    close("balance", sum, 1.0, 3e-8);
                } else {
                    assert!(sum < 1.0, "{slab:?}");
                }
                assert_eq!(fluxes.transmittance == 0.0, slab.tau.is_none());
            }
            for beam in slab.beams {
                close("mirrored", beam.specular, fresnel(slab.n, beam.mu0), 1e-9);
                assert!(beam.fluxes.reflectance > beam.specular, "{slab:?}");
            }
        }
    }

    #[test]
    fn what_does_not_scatter_is_a_plate() {
        let slabs = load();
        let clear = slabs.iter().find(|s| s.albedo == 0.0).expect("a plate");
        let plates = surfaces::load().plate;
        let same =
            |p: &&surfaces::Plate| p.n == clear.n && Some(p.tau) == clear.tau && p.mu0 == 1.0;
        let plate = plates.iter().find(same).expect("in both tables");
        let fluxes = clear.beams[0].fluxes;
        close("R", fluxes.reflectance, plate.reflectance, 3e-8);
        close("T", fluxes.transmittance, plate.transmittance, 3e-8);
    }

    #[test]
    fn a_published_half_space_is_among_them() {
        // Giovanelli's of 1955: albedo 0.9, isotropic, index 1.5, four digits.
        let slabs = load();
        let same = |s: &&Slab| s.tau.is_none() && s.n == 1.5 && s.albedo == 0.9 && s.g == 0.0;
        let slab = slabs.iter().find(same).expect("in the table");
        close("R", slab.beams[0].fluxes.reflectance, 0.26, 1e-4);
    }
}
