//! What a medium is at a place.

use glam::DVec3;
use woodcock_core::path::RecordKind;

use super::{Medium, Tables};

/// Coefficients at a place, by colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Local {
    /// Extinction [1/length]: at most the medium's majorant there.
    pub sigma_t: [f64; 3],
    /// Single-scattering albedo, in [0, 1].
    pub albedo: [f64; 3],
    /// Radiance that is sent out per length, σ_a · L_e \[W/(m³ sr)\], times the film's factor.
    pub emission: [f64; 3],
}

/// Extinction and scattering of a sample, by colour [1/length].
#[derive(Clone, Copy, Default)]
pub(super) struct Coefficients {
    sigma_t: [f64; 3],
    sigma_s: [f64; 3],
    pub(super) sigma_a: [f64; 3],
}

impl Coefficients {
    fn add(&mut self, weight: f64, other: &Self) {
        for c in 0..3 {
            self.sigma_t[c] += weight * other.sigma_t[c];
            self.sigma_s[c] += weight * other.sigma_s[c];
            self.sigma_a[c] += weight * other.sigma_a[c];
        }
    }
}

impl Medium {
    /// What the medium is at a place of the rendered world.
    ///
    /// * `tap`: the index among all samples of the one that a stochastic look-up picked; extinction, scattering and
    ///   absorption are that sample's, so that their expectations are the interpolants. Without it a grid is
    ///   interpolated: the expectation itself, at the cost of eight look-ups.
    /// * `place`: for what has no samples, or other ones: formulas, temperatures, albedos of their own.
    pub fn local(&self, tables: &Tables, tap: Option<u32>, place: DVec3) -> Local {
        let mut found = match tap {
            Some(tap) if self.has_samples() => self.at_sample(tables, tap),
            _ if self.has_samples() => self.interpolated(tables, place),
            _ => {
                let density = self.cloud().map_or(1.0, |cloud| cloud.value(place));
                self.constant(f64::from(self.record.scale) * density, density)
            }
        };
        let details = self.details.as_deref();
        let mut albedo = self.record.albedo.map(f64::from);
        if let Some(field) = details.and_then(|d| d.albedo.as_ref()) {
            albedo = field.value(place);
            found.sigma_a = std::array::from_fn(|c| found.sigma_t[c] * (1.0 - albedo[c]));
        } else if details.is_some_and(|d| d.shares.is_some()) {
            let ratio = |c: usize| found.sigma_s[c] / found.sigma_t[c];
            albedo = std::array::from_fn(|c| {
                if found.sigma_t[c] > 0.0 {
                    ratio(c).min(1.0)
                } else {
                    0.0
                }
            });
        }
        let emission = match details.and_then(|d| d.emission.as_ref()) {
            Some(emission) if found.sigma_a.iter().any(|s| *s > 0.0) => {
                let radiance = emission.radiance(place);
                std::array::from_fn(|c| found.sigma_a[c] * radiance[c])
            }
            _ => [0.0; 3],
        };
        Local {
            sigma_t: found.sigma_t,
            albedo,
            emission,
        }
    }

    /// What is the same for all samples, at a density.
    ///
    /// * `extinction`: of the most opaque colour [1/length].
    fn constant(&self, extinction: f64, density: f64) -> Coefficients {
        let record = &self.record;
        let sigma_t = record.colour.map(|c| extinction * f64::from(c));
        Coefficients {
            sigma_t,
            sigma_s: std::array::from_fn(|c| sigma_t[c] * f64::from(record.albedo[c])),
            sigma_a: self.absorption.map(|s| s * density),
        }
    }

    /// What a sample is.
    pub(super) fn at_sample(&self, tables: &Tables, tap: u32) -> Coefficients {
        let sample = tables.sample(tap);
        // As kernels round it: below their majorant.
        let extinction = f64::from(sample * self.record.scale);
        let Some(shares) = self.details.as_ref().and_then(|d| d.shares.as_ref()) else {
            return self.constant(extinction, f64::from(sample));
        };
        let first = match self.record.kind {
            RecordKind::Grid { samples, .. } => samples,
            RecordKind::Homogeneous => 0,
        };
        let Some(share) = shares.get(tap.wrapping_sub(first) as usize) else {
            return Coefficients::default();
        };
        Coefficients {
            sigma_t: share.extinction().map(|e| extinction * e),
            sigma_s: share.scattered.map(|s| extinction * f64::from(s)),
            sigma_a: share.absorbed.map(|s| extinction * f64::from(s)),
        }
    }

    /// The interpolant of a grid at a place; nothing beyond its samples.
    fn interpolated(&self, tables: &Tables, place: DVec3) -> Coefficients {
        let mut sum = Coefficients::default();
        let RecordKind::Grid { dims, samples, .. } = self.record.kind else {
            return sum;
        };
        let Some(map) = self.world_to_grid() else {
            return sum;
        };
        let p = map.transform_point3(place);
        let last = DVec3::from_array(dims.map(|n| f64::from(n - 1)));
        // A place on the outermost faces may come out beyond them by rounding.
        let slack = DVec3::splat(1e-4);
        if !(p.cmpge(-slack).all() && p.cmple(last + slack).all()) {
            return sum;
        }
        let p = p.max(DVec3::ZERO).min(last);
        let cell = p.floor().min(last - DVec3::ONE);
        let w = p - cell;
        let [x, y, z] = cell.to_array().map(|c| c as u32);
        for i in 0..8_u32 {
            let [dx, dy, dz] = [i & 1, i >> 1 & 1, i >> 2];
            let side = |far: u32, w: f64| if far == 1 { w } else { 1.0 - w };
            let weight = side(dx, w.x) * side(dy, w.y) * side(dz, w.z);
            if weight > 0.0 {
                let tap = tables.tap(samples, dims, [x + dx, y + dy, z + dz]);
                sum.add(weight, &self.at_sample(tables, tap));
            }
        }
        sum
    }
}
