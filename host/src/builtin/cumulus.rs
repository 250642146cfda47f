//! A cumulus: the union of soft puffs, eroded by value noise of five octaves that also displaces them: dense inside, wispy at the
//! rim, flat below.

/// Centre and radius of each puff, in a box of 1.2 × 0.7 × 1.
const PUFFS: [([f32; 3], f32); 13] = [
    ([0.60, 0.22, 0.50], 0.20),
    ([0.44, 0.18, 0.46], 0.15),
    ([0.78, 0.18, 0.54], 0.16),
    ([0.30, 0.14, 0.52], 0.10),
    ([0.93, 0.14, 0.48], 0.10),
    ([0.56, 0.38, 0.48], 0.14),
    ([0.68, 0.34, 0.58], 0.12),
    ([0.60, 0.50, 0.50], 0.10),
    ([0.48, 0.31, 0.60], 0.11),
    ([0.82, 0.29, 0.44], 0.09),
    ([0.52, 0.16, 0.30], 0.12),
    ([0.70, 0.15, 0.72], 0.12),
    ([0.40, 0.26, 0.38], 0.09),
];

/// Size of its box.
pub(crate) const SIZE: [f32; 3] = [1.2, 0.7, 1.0];

/// Density at the centres of voxels, x fastest, and how many there are along x, y, z.
///
/// * `nx`: voxels along x.
pub(crate) fn cumulus(nx: usize) -> ([usize; 3], Vec<f32>) {
    let nx = nx.max(1);
    let [ny, nz] = [7, 10].map(|part| (nx * part / 12).max(1));
    let cell = SIZE[0] / nx as f32;
    let mut density = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                density.push(cloud([x, y, z].map(|i| (i as f32 + 0.5) * cell)));
            }
        }
    }
    ([nx, ny, nz], density)
}

/// Density at a place of the cloud's box.
fn cloud(p: [f32; 3]) -> f32 {
    let warp = [0.0, 17.0, 31.0].map(|shift| octaves(p.map(|c| c * 6.0 + shift), 3) - 0.5);
    let q = [0, 1, 2].map(|i| p[i] + 0.12 * warp[i]);
    let mut inside = 0.0_f32;
    for (centre, radius) in PUFFS {
        let d = [0, 1, 2].map(|i| q[i] - centre[i]);
        let distance = (d[0] * d[0] + d[1] * d[1] * 1.2 + d[2] * d[2]).sqrt();
        // Soft union: a sum of bumps that saturates.
        inside += (1.0 - distance / (radius * 1.35)).max(0.0);
    }
    if inside == 0.0 {
        return 0.0; // and spare the noise
    }
    let erosion = octaves(p.map(|c| c * 13.0 + 5.0), 5);
    let base = smooth(((q[1] - 0.055) * 16.0).clamp(0.0, 1.0));
    let shape = inside.min(1.0) * base - 1.25 * (erosion - 0.36).max(0.0) - 0.03;
    smooth((shape * 7.0).clamp(0.0, 1.0))
}

fn smooth(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// Value noise summed over octaves, in [0, 1].
fn octaves(p: [f32; 3], count: u32) -> f32 {
    let (mut sum, mut weight, mut total) = (0.0, 1.0, 0.0);
    let mut scale = 1.0;
    for octave in 0..count {
        let shift = octave as f32 * 7.3;
        sum += weight * noise(p.map(|c| c * scale + shift));
        total += weight;
        weight *= 0.55;
        scale *= 2.03;
    }
    sum / total
}

/// Smoothly interpolated random values at the integers, in [0, 1].
fn noise(p: [f32; 3]) -> f32 {
    let cell = p.map(|c| c.floor());
    let t = [0, 1, 2].map(|i| smooth(p[i] - cell[i]));
    let corner = |dx: i32, dy: i32, dz: i32| {
        let [x, y, z] = cell.map(|c| c as i32);
        random([x + dx, y + dy, z + dz])
    };
    let lerp = |t: f32, a: f32, b: f32| a + (b - a) * t;
    let row = |dy, dz| lerp(t[0], corner(0, dy, dz), corner(1, dy, dz));
    let slice = |dz| lerp(t[1], row(0, dz), row(1, dz));
    lerp(t[2], slice(0), slice(1))
}

/// A random value of a lattice point, in [0, 1).
fn random(p: [i32; 3]) -> f32 {
    let [x, y, z] = p.map(i32::cast_unsigned);
    let mut h =
        x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ z.wrapping_mul(0xcb1a_b31f);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    (h >> 8) as f32 / 16_777_216.0
}
