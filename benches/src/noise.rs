//! Shapes for made-up volumes: balls, and noise of several octaves.

/// A ball, and how deep within it a place lies.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    centre: [f32; 3],
    radius: f32,
}

impl Ball {
    /// A ball.
    pub const fn new(centre: [f32; 3], radius: f32) -> Self {
        Self { centre, radius }
    }

    /// One at the centre, zero on the surface, negative outside.
    pub fn depth(&self, p: [f32; 3]) -> f32 {
        let squares = [0, 1, 2].map(|a| (p[a] - self.centre[a]).powi(2));
        1.0 - squares.iter().sum::<f32>().sqrt() / self.radius
    }
}

/// A number in [0, 1) for each point of the integer lattice.
fn lattice([x, y, z]: [i32; 3]) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x8da6_b343)
        ^ (y as u32).wrapping_mul(0xd816_3841)
        ^ (z as u32).wrapping_mul(0xcb1a_b31f);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    ((h ^ (h >> 16)) >> 8) as f32 / 16_777_216.0
}

/// Smooth noise with features of size one, in [0, 1).
fn value(p: [f32; 3]) -> f32 {
    let cell = p.map(f32::floor);
    let w = [0, 1, 2].map(|a| {
        let t = p[a] - cell[a];
        t * t * (3.0 - 2.0 * t)
    });
    let [x, y, z] = cell.map(|c| c as i32);
    let mix = |a: f32, b: f32, w: f32| a + (b - a) * w;
    let row = |y, z| mix(lattice([x, y, z]), lattice([x + 1, y, z]), w[0]);
    let sheet = |z| mix(row(y, z), row(y + 1, z), w[1]);
    mix(sheet(z), sheet(z + 1), w[2])
}

/// Noise whose features halve in size and in strength from octave to octave, in [0, 1), 1/2 on average.
pub fn fractal(p: [f32; 3], octaves: u32) -> f32 {
    let (mut sum, mut total, mut strength, mut scale) = (0.0, 0.0, 1.0_f32, 1.0_f32);
    for octave in 0..octaves {
        let shift = 17.3 * octave as f32;
        sum += strength * value(p.map(|c| c * scale + shift));
        total += strength;
        strength *= 0.5;
        scale *= 2.0;
    }
    sum / total
}
