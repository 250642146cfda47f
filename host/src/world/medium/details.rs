//! What packet kernels cannot do: colours by voxel, light from within, extinction by formula.

use super::cloud::CloudDensity;
use super::emission::Emission;
use super::field::Field;

/// What a voxel does by colour, relative to its sample, which is the extinction of its most opaque colour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Share {
    pub(super) absorbed: [f32; 3],
    pub(super) scattered: [f32; 3],
}

impl Share {
    /// What neither absorbs nor scatters.
    pub(super) const NOTHING: Self = Self {
        absorbed: [0.0; 3],
        scattered: [0.0; 3],
    };

    /// The largest coefficient of all colours together, and what each does by it.
    pub(super) fn of(sigma_a: [f64; 3], sigma_s: [f64; 3]) -> (f64, Self) {
        let largest = (0..3).map(|c| sigma_a[c] + sigma_s[c]).fold(0.0, f64::max);
        if largest == 0.0 {
            return (0.0, Self::NOTHING);
        }
        let share = Self {
            absorbed: sigma_a.map(|s| (s / largest) as f32),
            scattered: sigma_s.map(|s| (s / largest) as f32),
        };
        (largest, share)
    }

    /// Extinction by colour relative to the sample, in [0, 1].
    pub(super) fn extinction(&self) -> [f64; 3] {
        // Two roundings may come to more than one.
        std::array::from_fn(|c| {
            (f64::from(self.absorbed[c]) + f64::from(self.scattered[c])).min(1.0)
        })
    }

    /// Whether extinction differs between colours.
    pub(super) fn is_chromatic(&self) -> bool {
        let [r, g, b] = self.extinction();
        r != g || g != b
    }

    /// Single-scattering albedo by colour; zero where there is no extinction.
    pub(super) fn albedo(&self) -> [f64; 3] {
        std::array::from_fn(|c| {
            let whole = f64::from(self.absorbed[c]) + f64::from(self.scattered[c]);
            if whole > 0.0 {
                f64::from(self.scattered[c]) / whole
            } else {
                0.0
            }
        })
    }
}

/// What a medium has beyond its record.
#[derive(Clone, Debug, Default)]
pub struct Details {
    /// Absorption and scattering by voxel, in the order of the grid's samples.
    pub(super) shares: Option<Vec<Share>>,
    /// Whether some of them differ between colours in what they take away.
    pub(super) chromatic: bool,
    /// Albedo by place, in place of the record's.
    pub(super) albedo: Option<Field<3>>,
    /// The density by formula; the record's grid has blocks and no samples.
    pub(super) cloud: Option<CloudDensity>,
    /// Light from within.
    pub(super) emission: Option<Emission>,
}

impl Details {
    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.is_light_alone() && self.emission.is_none()
    }

    /// Whether there are none but light from within.
    pub(super) fn is_light_alone(&self) -> bool {
        self.shares.is_none() && self.albedo.is_none() && self.cloud.is_none()
    }

    /// Light from within, if there is.
    pub fn emission(&self) -> Option<&Emission> {
        self.emission.as_ref()
    }
}
