//! Perlin's gradient noise, with pbrt's choice of gradients.
//!
//! A lattice of gradients, each along two axes, picked by a permutation; between the eight corners of a
//! cell their linear functions are blended with 6t⁵ − 15t⁴ + 10t³. Zero at every lattice point, period 256.
//!
//! pbrt picks the last four of its sixteen gradients otherwise than Perlin, (±x, y) and (±y, −z) instead of (y ± x) and
//! (−y ± z), and so do we: scenes were made with it. Source: [Perlin 2002].

use glam::DVec3;

/// Perlin's permutation of 0 to 255.
#[rustfmt::skip]
const PERMUTATION: [u8; 256] = [
    151, 160, 137, 91, 90, 15, 131, 13, 201, 95, 96, 53, 194, 233, 7, 225,
    140, 36, 103, 30, 69, 142, 8, 99, 37, 240, 21, 10, 23, 190, 6, 148,
    247, 120, 234, 75, 0, 26, 197, 62, 94, 252, 219, 203, 117, 35, 11, 32,
    57, 177, 33, 88, 237, 149, 56, 87, 174, 20, 125, 136, 171, 168, 68, 175,
    74, 165, 71, 134, 139, 48, 27, 166, 77, 146, 158, 231, 83, 111, 229, 122,
    60, 211, 133, 230, 220, 105, 92, 41, 55, 46, 245, 40, 244, 102, 143, 54,
    65, 25, 63, 161, 1, 216, 80, 73, 209, 76, 132, 187, 208, 89, 18, 169,
    200, 196, 135, 130, 116, 188, 159, 86, 164, 100, 109, 198, 173, 186, 3, 64,
    52, 217, 226, 250, 124, 123, 5, 202, 38, 147, 118, 126, 255, 82, 85, 212,
    207, 206, 59, 227, 47, 16, 58, 17, 182, 189, 28, 42, 223, 183, 170, 213,
    119, 248, 152, 2, 44, 154, 163, 70, 221, 153, 101, 155, 167, 43, 172, 9,
    129, 22, 39, 253, 19, 98, 108, 110, 79, 113, 224, 232, 178, 185, 112, 104,
    218, 246, 97, 228, 251, 34, 242, 193, 238, 210, 144, 12, 191, 179, 162, 241,
    81, 51, 145, 235, 249, 14, 239, 107, 49, 192, 214, 31, 181, 199, 106, 157,
    184, 84, 204, 176, 115, 121, 50, 45, 127, 4, 150, 254, 138, 236, 205, 93,
    222, 114, 67, 29, 24, 72, 243, 141, 128, 195, 78, 66, 215, 61, 156, 180,
];

/// No noise exceeds it in magnitude.
///
/// A corner's function is at most the sum of the two largest of its three offsets; the blend of those sums over a
/// cell stays below 1.05 (`nothing_exceeds_the_bound` proves it; its maximum is 1.0364).
pub(super) const BOUND: f64 = 1.05;

/// Distance of the differences in [`slope`].
const DELTA: f64 = 0.01;

fn permuted(n: usize) -> usize {
    usize::from(PERMUTATION[n & 255])
}

/// The linear function of a lattice point's gradient at an offset from it.
fn gradient(lattice: [usize; 3], offset: [f64; 3]) -> f64 {
    let [x, y, z] = offset;
    let h = permuted(permuted(permuted(lattice[0]) + lattice[1]) + lattice[2]) & 15;
    let (u, v) = match h {
        0..=3 | 12 | 13 => (x, y),
        4..=7 => (x, z),
        _ => (y, z),
    };
    let signed = |value: f64, negative: bool| if negative { -value } else { value };
    signed(u, h & 1 == 1) + signed(v, h & 2 == 2)
}

/// The weight of the far corner at t in [0, 1].
fn weight(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

/// The noise at a place, within ±[`BOUND`]; zero where the place is not finite.
pub(super) fn noise(p: DVec3) -> f64 {
    if !p.is_finite() {
        return 0.0;
    }
    let cell = p.floor();
    let t = (p - cell).to_array();
    let lattice = cell.to_array().map(|c| c.rem_euclid(256.0) as usize);
    let corner = |i: usize| {
        let far = [i & 1, i >> 1 & 1, i >> 2];
        let offset = std::array::from_fn(|a| t[a] - far[a] as f64);
        gradient(std::array::from_fn(|a| lattice[a] + far[a]), offset)
    };
    let w = t.map(weight);
    let mix = |w: f64, a: f64, b: f64| (1.0 - w) * a + w * b;
    let row = |i: usize| mix(w[0], corner(i), corner(i + 1));
    let slice = |i: usize| mix(w[1], row(i), row(i + 2));
    mix(w[2], slice(0), slice(4))
}

/// Forward differences of the noise along the axes.
pub(super) fn slope(p: DVec3) -> DVec3 {
    let here = noise(p);
    let along = |axis: DVec3| (noise(p + axis * DELTA) - here) / DELTA;
    DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_permutation_is_one() {
        let mut seen = [false; 256];
        PERMUTATION
            .iter()
            .for_each(|&p| seen[usize::from(p)] = true);
        assert!(seen.iter().all(|s| *s));
    }

    #[test]
    fn lattice_points_are_zero_and_the_period_is_256() {
        for i in 0..200_i32 {
            let at = DVec3::new(f64::from(i - 100), f64::from(i * 7), f64::from(-i * 3));
            assert_eq!(noise(at), 0.0);
            let p = at + DVec3::new(0.3, 0.6, 0.1);
            assert!((noise(p) - noise(p + DVec3::splat(256.0))).abs() < 1e-12);
        }
    }

    #[test]
    fn slopes_are_continuous_across_cells() {
        for i in 0..100_i32 {
            let p = DVec3::new(f64::from(i), 0.37 + f64::from(i), 0.71);
            let step = DVec3::new(1e-7, 0.0, 0.0);
            let (before, after) = (noise(p) - noise(p - step), noise(p + step) - noise(p));
            assert!((before - after).abs() < 1e-12, "{i}");
        }
    }

    /// The bound of one cell: two largest offsets of each corner, blended.
    #[test]
    fn nothing_exceeds_the_bound() {
        // By symmetry 0 ≤ z ≤ y ≤ x ≤ 1/2 is enough. Along an axis a corner's sum changes by at most 1 per unit, the
        // weights by at most 15/8, and they blend sums that differ by at most 1: so between points 1/400 apart nothing
        // exceeds the larger by more than 3 (1 + 15/8) / 800.
        const HALF: u32 = 200;
        let blend = |t: [f64; 3]| {
            let w = t.map(weight);
            (0..8_usize)
                .map(|i| {
                    let side = |a: usize| i >> a & 1 == 1;
                    let offset: [f64; 3] =
                        std::array::from_fn(|a| if side(a) { 1.0 - t[a] } else { t[a] });
                    let weight: f64 = (0..3)
                        .map(|a| if side(a) { w[a] } else { 1.0 - w[a] })
                        .product();
                    let least = offset.iter().copied().fold(1.0, f64::min);
                    weight * (offset.iter().sum::<f64>() - least)
                })
                .sum::<f64>()
        };
        let mut largest = 0.0_f64;
        for i in 0..=HALF {
            for j in 0..=i {
                for k in 0..=j {
                    largest = largest.max(blend([i, j, k].map(|n| f64::from(n) / 400.0)));
                }
            }
        }
        assert!(largest > 1.036, "{largest}");
        assert!(largest + 3.0 * (1.0 + 1.875) / 800.0 < BOUND, "{largest}");
    }

    #[test]
    fn noise_stays_within_the_bound() {
        // Low-discrepancy places: additive recurrence by the plastic number.
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        for i in 0..200_000_u32 {
            let n = f64::from(i);
            let p = DVec3::new(
                n * 0.819_172_513_4,
                n * 0.671_043_606_7,
                n * 0.549_700_477_9,
            );
            let value = noise(p);
            low = low.min(value);
            high = high.max(value);
        }
        assert!(
            -BOUND < low && low < -0.8 && 0.8 < high && high < BOUND,
            "{low} {high}"
        );
    }
}
