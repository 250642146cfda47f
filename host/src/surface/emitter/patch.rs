//! Bilinear patches, chosen about by area.
//!
//! The normal N = cross(∂p/∂u, ∂p/∂v) is affine in u and v: N(u, v) = N₀₀ + u (N₁₀ − N₀₀) + v (N₀₁ − N₀₀). Its length is
//! the area per du dv.

use glam::{DVec2, DVec3};

use super::super::patch::Patch;
use super::Choice;
use crate::ray::Anchor;

/// Where the corners are in u and v.
const CORNERS: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];

/// Abscissas and weights of Gauss and Legendre for the interval [0, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_92),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_92),
];

/// ∫∫ |N| du dv, by adaptive quadrature: exact for plane patches that do not fold.
pub(super) fn area(patch: &Patch) -> f64 {
    let whole = panel(patch, DVec2::ZERO, 1.0);
    refine(patch, DVec2::ZERO, 1.0, whole, whole * 1e-10, 12)
}

fn panel(patch: &Patch, corner: DVec2, size: f64) -> f64 {
    let mut sum = 0.0;
    for (x, weight_x) in GAUSS {
        for (y, weight_y) in GAUSS {
            let at = corner + DVec2::new(x, y) * size;
            sum += weight_x * weight_y * patch.normal(at).length();
        }
    }
    sum * size * size
}

fn refine(
    patch: &Patch,
    corner: DVec2,
    size: f64,
    coarse: f64,
    tolerance: f64,
    levels: u32,
) -> f64 {
    let half = 0.5 * size;
    let quarters = CORNERS.map(|c| corner + c * half);
    let fine = quarters.map(|c| panel(patch, c, half));
    let sum = fine[0] + fine[1] + fine[2] + fine[3];
    if levels == 0 || (sum - coarse).abs() <= tolerance {
        return sum;
    }
    (0..4)
        .map(|i| refine(patch, quarters[i], half, fine[i], tolerance, levels - 1))
        .sum()
}

/// A cone around N: the normals at the corners span all of them.
pub(super) fn cone(patch: &Patch) -> (DVec3, f64) {
    let normals = CORNERS.map(|c| patch.normal(c).normalize_or_zero());
    let axis = normals.iter().sum::<DVec3>().normalize_or_zero();
    let cosine = normals
        .iter()
        .fold(1.0_f64, |least, n| least.min(n.dot(axis)));
    // A cone of more than a hemisphere is not convex: then nothing is known. The last digits are given away.
    if cosine > 1e-6 {
        (axis, (cosine - 1e-12).max(-1.0))
    } else {
        (DVec3::Z, -1.0)
    }
}

/// |N| at the corners, and their mean.
fn weights(patch: &Patch) -> ([f64; 4], f64) {
    let weights = CORNERS.map(|c| patch.normal(c).length());
    (
        weights,
        0.25 * (weights[0] + weights[1] + weights[2] + weights[3]),
    )
}

/// Density per area of a choice by the bilinear interpolation of the corners' |N|.
fn pdf_at(patch: &Patch, at: DVec2) -> f64 {
    let ([a, b, c, d], mean) = weights(patch);
    let (u, v) = (at.x, at.y);
    let weight = (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v;
    let pdf = weight / (mean * patch.normal(at).length());
    if pdf.is_finite() { pdf } else { 0.0 }
}

/// Inverts the distribution function of a density that goes linearly from `a` to `b` on [0, 1].
fn sample_linear(u: f64, a: f64, b: f64) -> f64 {
    let root = (a * a * (1.0 - u) + b * b * u).sqrt();
    if a + root > 0.0 {
        (u * (a + b) / (a + root)).min(1.0)
    } else {
        0.0
    }
}

pub(super) fn sample_area(patch: &Patch, u: [f64; 2]) -> Choice {
    let ([a, b, c, d], _) = weights(patch);
    let v = sample_linear(u[1], a + b, c + d);
    let along = sample_linear(u[0], a * (1.0 - v) + c * v, b * (1.0 - v) + d * v);
    let at = DVec2::new(along, v);
    Choice {
        at,
        near: DVec3::ZERO,
        pdf: pdf_at(patch, at),
    }
}

pub(super) fn area_pdf(patch: &Patch, point: &Anchor) -> f64 {
    patch
        .invert(point.point, point.normal)
        .map_or(0.0, |at| pdf_at(patch, at))
}
