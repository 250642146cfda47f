//! What the visitor chooses.

use glam::DVec3;
use woodcock_core::camera::{Camera, Projection};
use woodcock_core::light::{Distant, Lights};
use woodcock_core::path::{MediumRecord, RecordKind, Settings, ShadowEstimator};

/// What the page writes: angles in degrees, lengths in halves of the volume's longest side.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct Controls {
    /// Pixels.
    pub(crate) width: u32,
    pub(crate) height: u32,
    /// Whether eight lanes trace paths, or one.
    pub(crate) packets: u32,
    /// Which [estimator](Self::settings) of transmittance.
    pub(crate) estimator: u32,
    /// Where the camera is, as seen from the middle of the volume.
    pub(crate) turn: f32,
    pub(crate) height_angle: f32,
    pub(crate) distance: f32,
    /// Extinction where the volume is densest.
    pub(crate) density: f32,
    /// Mean cosine of scattering.
    pub(crate) g: f32,
    pub(crate) albedo: f32,
    /// Where the sun is.
    pub(crate) sun_turn: f32,
    pub(crate) sun_height: f32,
    /// Irradiance of the sun and radiance of the sky, relative to those of a clear afternoon.
    pub(crate) sun: f32,
    pub(crate) sky: f32,
}

/// The most that [`density`](Controls::density) may be.
pub(crate) const MOST_DENSITY: f32 = 1e3;
/// Angle of view along the shorter side \[degrees\].
pub(crate) const FIELD_OF_VIEW: f64 = 30.0;

const SUN: [f32; 3] = [5.5, 5.06, 4.4];
const SKY: [f32; 3] = [0.09, 0.18, 0.4];

/// A unit vector from angles \[degrees\]: at zero it points against z, where cameras stand.
fn towards(turn: f32, height: f32) -> DVec3 {
    let [turn, height] = [turn, height].map(|angle| f64::from(angle).to_radians());
    let (sin, cos) = height.sin_cos();
    DVec3::new(cos * turn.sin(), sin, -cos * turn.cos())
}

impl Controls {
    pub(crate) fn eye(&self) -> DVec3 {
        towards(self.turn, self.height_angle) * f64::from(self.distance)
    }

    pub(crate) fn sunwards(&self) -> DVec3 {
        towards(self.sun_turn, self.sun_height)
    }

    pub(crate) fn irradiance(&self) -> [f32; 3] {
        SUN.map(|x| x * self.sun)
    }

    pub(crate) fn radiance(&self) -> [f32; 3] {
        SKY.map(|x| x * self.sky)
    }

    /// A camera that looks at the middle of the volume, y upwards.
    pub(crate) fn camera(&self) -> Camera {
        let eye = self.eye();
        let forward = -eye.normalize_or(-DVec3::Z);
        let right = DVec3::Y.cross(forward).normalize_or(DVec3::X);
        let up = forward.cross(right);
        let half = 0.5 * FIELD_OF_VIEW.to_radians();
        let half = half.tan() as f32;
        let [width, height] = [self.width, self.height].map(|n| n.max(1) as f32);
        let step = 2.0 * half / width.min(height);
        let row = |i: usize| [right[i], up[i], forward[i], eye[i]].map(|x| x as f32);
        Camera {
            projection: Projection::Perspective,
            screen: [[-0.5 * step * width, step], [0.5 * step * height, -step]],
            camera_to_world: [0, 1, 2].map(row),
            lens_radius: 0.0,
            focal_distance: 1.0,
        }
    }

    /// The sun, if it shines.
    pub(crate) fn distant(&self) -> Option<Distant> {
        let to_sun = self.sunwards().as_vec3().to_array();
        let shines = self.sun > 0.0;
        shines.then(|| Distant::new(to_sun, self.irradiance()).ok())?
    }

    /// The sun and a sky that paths meet as they escape.
    pub(crate) fn lights<'a>(&self, distant: &'a [Distant]) -> Lights<'a> {
        Lights {
            distant,
            environment: self.radiance(),
            sample_environment: false,
        }
    }

    /// A medium of so much extinction where samples are one, or everywhere.
    pub(crate) fn record(&self, kind: RecordKind, scale: f32) -> MediumRecord {
        MediumRecord {
            kind,
            scale,
            colour: [1.0; 3],
            albedo: [self.albedo; 3],
            g: self.g,
            rayleigh: false,
        }
    }

    /// How paths are traced: shadow rays by ratio tracking, each by what it would bring (0); all of them (1); by delta tracking (2).
    pub(crate) fn settings(&self) -> Settings {
        let (shadow, faint) = match self.estimator {
            0 => (ShadowEstimator::ByNeed, Settings::default().faint),
            1 => (ShadowEstimator::Ratio, Settings::ALL_SHADOW_RAYS),
            _ => (ShadowEstimator::Delta, Settings::ALL_SHADOW_RAYS),
        };
        Settings {
            shadow,
            faint,
            ..Settings::default()
        }
    }
}
