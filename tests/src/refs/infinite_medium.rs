//! The infinite homogeneous medium: fluence of a point source, and moments of the random walk.
//!
//! Lengths in mean free paths. Uncertainty relative: fluence 10⁻¹¹, orders 10⁻⁸, moments 10⁻¹³.

use serde::Deserialize;

/// Fluence around an isotropic point of power 1, isotropic scattering.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Fluence {
    /// Single-scattering albedo.
    #[serde(rename = "a")]
    pub albedo: f64,
    /// At each radius of [`Table::r`], unscattered part included.
    pub fluence: Vec<f64>,
}

/// Fluence of light that scattered exactly n times, albedo 1.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Order {
    /// Scatterings.
    pub n: u32,
    /// At each radius of [`Table::r`].
    pub fluence: Vec<f64>,
}

/// Moments of the position after `flights` flights that start along +z.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(from = "(f64, u32, f64, f64, f64, f64)")]
pub struct Walk {
    /// Mean cosine (Henyey–Greenstein).
    pub g: f64,
    /// N; N − 1 scatterings lie between.
    pub flights: u32,
    /// ⟨z⟩.
    pub z: f64,
    /// ⟨z²⟩.
    pub z2: f64,
    /// ⟨x²⟩ = ⟨y²⟩.
    pub x2: f64,
    /// ⟨r²⟩.
    pub r2: f64,
}

impl From<(f64, u32, f64, f64, f64, f64)> for Walk {
    fn from((g, flights, z, z2, x2, r2): (f64, u32, f64, f64, f64, f64)) -> Self {
        Self {
            g,
            flights,
            z,
            z2,
            x2,
            r2,
        }
    }
}

/// Moments of the position where an analogue photon is absorbed.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Absorption {
    /// Single-scattering albedo: survival probability of a collision.
    #[serde(rename = "a")]
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// ⟨z⟩ for a start along +z.
    pub mean_z: f64,
    /// ⟨r²⟩.
    pub mean_r2: f64,
    /// Collisions, the last included.
    pub mean_collisions: f64,
}

/// The whole file.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Table {
    /// Radii of the fluences.
    pub r: Vec<f64>,
    /// All orders together.
    pub greens: Vec<Fluence>,
    /// Order by order.
    pub orders: Vec<Order>,
    /// Random walks.
    pub moments: Vec<Walk>,
    /// Where photons die.
    pub absorption_moments: Vec<Absorption>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Table {
    super::parse(
        "infinite_medium",
        include_str!("../../refs/infinite_medium.json"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refs::quadrature::close;
    use std::f64::consts::PI;

    #[test]
    fn moments_follow_their_closed_forms() {
        let table = load();
        for walk in &table.moments {
            let (g, n) = (walk.g, f64::from(walk.flights));
            let power = g.powf(n);
            let power = if g < 0.0 {
                g.abs().powf(n) * (-1.0_f64).powi(walk.flights as i32)
            } else {
                power
            };
            close("z", walk.z, (1.0 - power) / (1.0 - g), 1e-12);
            let r2 = 2.0 * (n / (1.0 - g) - g * (1.0 - power) / (1.0 - g).powi(2));
            close("r2", walk.r2, r2, 1e-12);
            close("x2", walk.x2, 0.5 * (walk.r2 - walk.z2), 1e-12);
        }
        for end in &table.absorption_moments {
            close("z", end.mean_z, 1.0 / (1.0 - end.albedo * end.g), 1e-12);
            let r2 = 2.0 / ((1.0 - end.albedo) * (1.0 - end.albedo * end.g));
            close("r2", end.mean_r2, r2, 1e-12);
            close("N", end.mean_collisions, 1.0 / (1.0 - end.albedo), 1e-12);
        }
    }

    #[test]
    fn unscattered_light_falls_as_it_must() {
        let table = load();
        assert_eq!(table.orders[0].n, 0);
        for (i, &r) in table.r.iter().enumerate() {
            let direct = (-r).exp() / (4.0 * PI * r * r);
            close("order 0", table.orders[0].fluence[i] / direct, 1.0, 1e-8);
            for all in &table.greens {
                // The listed orders are part of the sum.
                let some: f64 = table
                    .orders
                    .iter()
                    .map(|o| all.albedo.powi(o.n as i32) * o.fluence[i])
                    .sum();
                assert!(all.fluence[i] > some * (1.0 - 1e-8));
            }
        }
    }
}
