//! Quantities on grids of their own, interpolated where they are asked for.

use glam::{DAffine3, DVec3};

/// Samples of N numbers at the integers of a grid space, trilinear in between.
#[derive(Clone, Debug)]
pub struct Field<const N: usize> {
    /// x fastest; `dims` of them.
    pub(super) values: Vec<[f32; N]>,
    /// Samples along x, y, z; each at least 1.
    pub(super) dims: [usize; 3],
    /// From the rendered world.
    pub(super) world_to_grid: DAffine3,
    /// What lies beyond the samples.
    pub(super) beyond: Beyond<N>,
}

/// What a field is where it has no samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beyond<const N: usize> {
    /// One value everywhere; between it and the outermost samples it is interpolated, too.
    Value([f32; N]),
    /// That of the nearest place with samples.
    Nearest,
}

impl<const N: usize> Field<N> {
    /// The sample at an index.
    pub(super) fn sample(&self, index: [i64; 3]) -> [f32; N] {
        let mut at = [0_usize; 3];
        for axis in 0..3 {
            let last = self.dims[axis] as i64 - 1;
            let inside = index[axis].clamp(0, last);
            match self.beyond {
                Beyond::Value(value) if inside != index[axis] => return value,
                _ => at[axis] = inside as usize,
            }
        }
        let place = (at[2] * self.dims[1] + at[1]) * self.dims[0] + at[0];
        self.values.get(place).copied().unwrap_or([0.0; N])
    }

    /// The interpolant at a place of the rendered world.
    pub fn value(&self, place: DVec3) -> [f64; N] {
        let far = DVec3::from_array(self.dims.map(|n| n as f64));
        // One sample beyond either end is as far as interpolation reaches. A NaN comes to the lower end.
        let p = self.world_to_grid.transform_point3(place);
        let p = p.max(DVec3::NEG_ONE).min(far);
        let cell = p.floor();
        let w = p - cell;
        let [x, y, z] = cell.to_array().map(|c| c as i64);
        let mut sum = [0.0; N];
        for (dz, wz) in [(0, 1.0 - w.z), (1, w.z)] {
            for (dy, wy) in [(0, 1.0 - w.y), (1, w.y)] {
                for (dx, wx) in [(0, 1.0 - w.x), (1, w.x)] {
                    let weight = wx * wy * wz;
                    if weight == 0.0 {
                        continue;
                    }
                    let sample = self.sample([x + dx, y + dy, z + dz]);
                    for (sum, value) in sum.iter_mut().zip(sample) {
                        *sum += weight * f64::from(value);
                    }
                }
            }
        }
        sum
    }

    /// The largest of each number that interpolation can give in the box around these places of the world.
    ///
    /// Looks at every sample of the box: as many as the field has there.
    pub(super) fn largest(&self, places: impl IntoIterator<Item = DVec3>) -> [f32; N] {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for place in places {
            let p = self.world_to_grid.transform_point3(place);
            low = low.min(p);
            high = high.max(p);
        }
        let far = DVec3::from_array(self.dims.map(|n| n as f64));
        let bounded = |p: DVec3| p.max(DVec3::NEG_ONE).min(far).to_array();
        let (low, high) = (
            bounded(low.floor()).map(|v| v as i64),
            bounded(high.ceil()).map(|v| v as i64),
        );
        let mut largest = [f32::NEG_INFINITY; N];
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let sample = self.sample([x, y, z]);
                    for (largest, value) in largest.iter_mut().zip(sample) {
                        *largest = largest.max(value);
                    }
                }
            }
        }
        largest
    }

    /// The least and the largest of all samples and of what lies beyond them.
    pub(super) fn range(&self) -> ([f32; N], [f32; N]) {
        let beyond = match self.beyond {
            Beyond::Value(value) => Some(value),
            Beyond::Nearest => None,
        };
        let start = ([f32::INFINITY; N], [f32::NEG_INFINITY; N]);
        self.values
            .iter()
            .copied()
            .chain(beyond)
            .fold(start, |(low, high), value| {
                (
                    std::array::from_fn(|n| low[n].min(value[n])),
                    std::array::from_fn(|n| high[n].max(value[n])),
                )
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(beyond: Beyond<1>) -> Field<1> {
        let dims = [3, 2, 2];
        let values = (0..12).map(|i| [(i * i) as f32]).collect();
        Field {
            values,
            dims,
            world_to_grid: DAffine3::from_scale(DVec3::splat(2.0)),
            beyond,
        }
    }

    #[test]
    fn samples_are_met_and_means_lie_between() {
        let field = ramp(Beyond::Value([0.0]));
        for i in 0..12_usize {
            let index = DVec3::new((i % 3) as f64, (i / 3 % 2) as f64, (i / 6) as f64);
            assert_eq!(field.value(index * 0.5), [(i * i) as f64]);
        }
        // The centre of the first cell: the mean of samples 0, 1, 3, 4, 6, 7, 9, 10.
        let mean = (0.0 + 1.0 + 9.0 + 16.0 + 36.0 + 49.0 + 81.0 + 100.0) / 8.0;
        assert_eq!(field.value(DVec3::splat(0.25)), [mean]);
    }

    #[test]
    fn beyond_the_samples_is_what_was_said() {
        let fading = ramp(Beyond::Value([2.0]));
        assert_eq!(fading.value(DVec3::new(-0.25, 0.0, 0.0)), [1.0]);
        assert_eq!(fading.value(DVec3::splat(1e30)), [2.0]);
        assert_eq!(fading.value(DVec3::splat(f64::NAN)), [2.0]);
        let nearest = ramp(Beyond::Nearest);
        assert_eq!(nearest.value(DVec3::splat(1e30)), [121.0]);
        assert_eq!(nearest.value(DVec3::splat(-1e30)), [0.0]);
    }

    #[test]
    fn nothing_exceeds_the_largest() {
        let field = ramp(Beyond::Value([5.0]));
        let (low, high) = (DVec3::new(-0.3, 0.1, 0.0), DVec3::new(0.6, 0.2, 0.4));
        let [bound] = field.largest([low, high]);
        for i in 0..1000_u32 {
            let u = DVec3::new(
                f64::from(i % 10) / 9.0,
                f64::from(i / 10 % 10) / 9.0,
                f64::from(i / 100) / 9.0,
            );
            let [value] = field.value(low + (high - low) * u);
            assert!(value <= f64::from(bound));
        }
        assert_eq!(field.range(), ([0.0], [121.0]));
    }
}
