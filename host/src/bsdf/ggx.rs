//! Rough surfaces as heaps of tiny mirrors: the GGX distribution, anisotropic, with Smith's masking.
//!
//! ```text
//! D(m)  = 1 / (π αx αy (mx²/αx² + my²/αy² + mz²)²)                       normals per area and solid angle
//! s(w)  = √(wz² + αx² wx² + αy² wy²)
//! G1(w) = 2 |wz| / (|wz| + s(w))                                         seen from w
//! G2(v, w) = 2 |vz| |wz| / (|vz| s(w) + |wz| s(v))                       seen from both, heights correlated
//! Dv(m) = G1(v) max(0, v·m) D(m) / |vz| = 2 max(0, v·m) D(m) / (|vz| + s(v))     normals that v sees
//! ```
//!
//! G2 is 1 / (1 + Λ(v) + Λ(w)) with Λ = (s/|z| − 1) / 2, written without its poles at grazing angles, and Dv
//! integrates to one. Vectors are in the surface's frame, z the normal. What light does after a second meeting of
//! the heap is lost, as in all models of single scattering. Of light that comes evenly from above, that is
//!
//! | α | 0.25 | 0.5 | 1 |
//! |---|---|---|---|
//! | a metal that absorbs nothing | 11.8 % | 30.0 % | 59.1 % |
//! | glass, η = 1.5 | 2.9 % | 7.9 % | 20.1 % |
//!
//! Sources: [Walter 2007] for D, [Heitz 2014] for G2 and Dv, [Dupuy, Benyoub 2023] for the sampling.

use core::f64::consts::{PI, TAU};

use glam::DVec3;

/// A roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    alpha: [f64; 2],
}

impl Ggx {
    /// Widths below this count as smooth.
    pub const SMOOTH: f64 = 1e-3;
    /// The narrowest of two widths, where the other is not smooth.
    const NARROWEST: f64 = 1e-4;

    /// The roughness of widths along x and y (finite, not negative); `None` if both are below [`SMOOTH`](Self::SMOOTH).
    pub fn new(alpha: [f64; 2]) -> Option<Self> {
        let [x, y] = alpha;
        (x.max(y) >= Self::SMOOTH).then(|| Self {
            alpha: alpha.map(|a| a.max(Self::NARROWEST)),
        })
    }

    /// D [1/sr] of a unit normal with mz ≥ 0.
    pub fn density(&self, m: DVec3) -> f64 {
        let [ax, ay] = self.alpha;
        let (x, y) = (m.x / ax, m.y / ay);
        let e = x * x + y * y + m.z * m.z;
        1.0 / (PI * ax * ay * e * e)
    }

    /// s of a unit vector: at least |wz|.
    pub fn stretch(&self, w: DVec3) -> f64 {
        let [x, y] = [self.alpha[0] * w.x, self.alpha[1] * w.y];
        (w.z * w.z + x * x + y * y).sqrt()
    }

    /// G2 over |vz| |wz|.
    pub fn masking_over_cosines(&self, v: DVec3, w: DVec3) -> f64 {
        2.0 / (v.z.abs() * self.stretch(w) + w.z.abs() * self.stretch(v))
    }

    /// G2 over G1 of `v`, in [0, 1].
    pub fn masking_given(&self, v: DVec3, w: DVec3) -> f64 {
        let (vz, wz) = (v.z.abs(), w.z.abs());
        let s = self.stretch(v);
        wz * (vz + s) / (vz * self.stretch(w) + wz * s)
    }

    /// Dv over v·m [1/sr], for v with vz ≥ 0 and a normal that it sees.
    pub fn visible_over_cosine(&self, v: DVec3, m: DVec3) -> f64 {
        2.0 * self.density(m) / (v.z.abs() + self.stretch(v))
    }

    /// A normal with density Dv, for a unit `v` with vz ≥ 0.
    ///
    /// Stretched to a hemisphere of roughness one, the mirror directions of what `v` sees fill a spherical cap evenly.
    pub fn sample(&self, v: DVec3, u: [f64; 2]) -> DVec3 {
        let [ax, ay] = self.alpha;
        let v = DVec3::new(ax * v.x, ay * v.y, v.z).normalize();
        let (sin, cos) = libm::sincos(TAU * u[0]);
        let up = (1.0 - u[1]) * (1.0 + v.z); // cz + vz, positive
        let z = up - v.z;
        let r = (1.0 - z * z).max(0.0).sqrt();
        // Half way between v and the direction of the cap, before normalisation.
        let h = DVec3::new(r * cos + v.x, r * sin + v.y, up);
        DVec3::new(ax * h.x, ay * h.y, h.z).normalize()
    }
}
