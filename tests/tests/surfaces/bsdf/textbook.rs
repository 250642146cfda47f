//! Rough surfaces as textbooks write them, with tangents and both indices: [Walter 2007], equations 8, 16, 20, 21 and
//! 25, with the widths of [Heitz 2014] and his masking of correlated heights. Normals are flat and +z.

use glam::DVec3;

/// Λ of one direction.
fn lambda([ax, ay]: [f64; 2], w: DVec3) -> f64 {
    let tan2 = (1.0 - w.z * w.z) / (w.z * w.z);
    if tan2 <= 0.0 {
        return 0.0;
    }
    let phi = w.y.atan2(w.x);
    let width = (ax * phi.cos()).powi(2) + (ay * phi.sin()).powi(2);
    ((1.0 + width * tan2).sqrt() - 1.0) / 2.0
}

/// G2.
pub(super) fn masking(alpha: [f64; 2], v: DVec3, w: DVec3) -> f64 {
    1.0 / (1.0 + lambda(alpha, v) + lambda(alpha, w))
}

/// D.
fn facets([ax, ay]: [f64; 2], m: DVec3) -> f64 {
    let theta = m.z.clamp(-1.0, 1.0).acos();
    let phi = m.y.atan2(m.x);
    let width = (phi.cos() / ax).powi(2) + (phi.sin() / ay).powi(2);
    let e = theta.tan().powi(2) * width;
    1.0 / (std::f64::consts::PI * ax * ay * theta.cos().powi(4) * (1.0 + e).powi(2))
}

/// Fresnel's law by angles, for η₁ to η₂: [Born, Wolf 1999], section 1.5.2.
pub(super) fn fresnel(cosine: f64, n1: f64, n2: f64) -> f64 {
    let i = cosine.clamp(0.0, 1.0).acos();
    let sin_t = n1 / n2 * i.sin();
    if sin_t >= 1.0 {
        return 1.0;
    }
    let t = sin_t.asin();
    if i < 1e-4 {
        return ((n1 - n2) / (n1 + n2)).powi(2);
    }
    let s = (i - t).sin() / (i + t).sin();
    let p = (i - t).tan() / (i + t).tan();
    (s * s + p * p) / 2.0
}

/// f(o, i) of a rough boundary for radiance that comes from `i` and leaves to `o`.
pub(super) fn dielectric(eta: f64, alpha: [f64; 2], o: DVec3, i: DVec3) -> f64 {
    let index = |w: DVec3| if w.z > 0.0 { 1.0 } else { eta };
    let (n_o, n_i) = (index(o), index(i));
    let h = if o.z * i.z > 0.0 {
        (o + i) * o.z.signum()
    } else {
        -(i * n_i + o * n_o)
    };
    let h = h.normalize();
    // Normals point outside, whatever the order of the indices.
    let m = if h.z < 0.0 { -h } else { h };
    let (om, im) = (o.dot(m), i.dot(m));
    if om * o.z <= 0.0 || im * i.z <= 0.0 {
        return 0.0;
    }
    let common = facets(alpha, m) * masking(alpha, o, i);
    let reflected = fresnel(om.abs(), n_o, if n_o == 1.0 { eta } else { 1.0 });
    if o.z * i.z > 0.0 {
        reflected * common / (4.0 * (o.z * i.z).abs())
    } else {
        let root = n_i * im + n_o * om;
        (om * im / (o.z * i.z)).abs() * n_o * n_o * (1.0 - reflected) * common / (root * root)
    }
}

/// f of a rough metal that reflects everything.
pub(super) fn white_metal(alpha: [f64; 2], o: DVec3, i: DVec3) -> f64 {
    if o.z * i.z <= 0.0 {
        return 0.0;
    }
    let m = (o + i).normalize() * o.z.signum();
    facets(alpha, m) * masking(alpha, o, i) / (4.0 * o.z * i.z)
}
