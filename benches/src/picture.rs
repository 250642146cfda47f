//! A picture with what each pixel needs to know its own error.

/// Sums over the samples of each pixel.
#[derive(Clone, Debug)]
pub struct Picture {
    sums: Vec<Sums>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    count: f64,
    first: [f64; 3],
    second: [f64; 3],
}

impl Picture {
    /// Black, without samples.
    pub fn new(pixels: usize) -> Self {
        Self {
            sums: vec![Sums::default(); pixels],
        }
    }

    /// Adds a sample to a pixel.
    pub fn add(&mut self, pixel: usize, radiance: [f32; 3]) {
        let sums = &mut self.sums[pixel];
        sums.count += 1.0;
        for (c, value) in radiance.map(f64::from).into_iter().enumerate() {
            sums.first[c] += value;
            sums.second[c] += value * value;
        }
    }

    /// Of each pixel, the mean and the variance of the mean by colour.
    pub fn pixels(&self) -> Vec<Pixel> {
        let of = |sums: &Sums| Pixel {
            mean: sums.first.map(|s| s / sums.count),
            variance: std::array::from_fn(|c| {
                let mean = sums.first[c] / sums.count;
                let spread = (sums.second[c] / sums.count - mean * mean).max(0.0);
                spread / (sums.count - 1.0).max(1.0)
            }),
        };
        self.sums.iter().map(of).collect()
    }
}

/// A pixel's estimate by colour.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pixel {
    /// Mean over samples.
    pub mean: [f64; 3],
    /// Variance of that mean, from the spread of samples.
    pub variance: [f64; 3],
}
