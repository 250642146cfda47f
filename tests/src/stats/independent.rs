//! Random numbers for testing the harness: a generator that shares nothing with the one under test.
//!
//! The state walks by a constant; two multiplications and shifts mix it. Source: [Steele, Lea, Flood 2014].

/// SplitMix64: 64 bits of state, 64 bits out.
#[derive(Clone, Debug)]
pub struct SplitMix(u64);

impl SplitMix {
    /// A generator for each seed, on its own stretch of the one cycle.
    pub fn new(seed: u64) -> Self {
        // Seeds 0, 1, 2 … must not start on overlapping stretches of the one cycle.
        let mut scatter = Self(seed ^ 0x5851_F42D_4C95_7F2D);
        Self(scatter.bits())
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in (0, 1): 52 bits and a half, so that a logarithm is always finite.
    pub fn uniform(&mut self) -> f64 {
        ((self.bits() >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// Exponential of rate 1.
    pub fn exponential(&mut self) -> f64 {
        -self.uniform().ln()
    }

    /// Standard normal: one half of a Box–Muller pair.
    pub fn normal(&mut self) -> f64 {
        let radius = (2.0 * self.exponential()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
