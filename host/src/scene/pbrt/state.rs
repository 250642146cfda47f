//! The graphics state: what `AttributeBegin` saves and `AttributeEnd` restores.

use std::sync::Arc;

use glam::{DAffine3, DMat4, DVec3};

use super::super::{MaterialId, Place, SceneError};
use super::param::Param;

/// A medium's name with the place that mentions it; `None` is vacuum.
pub(super) type MediumName = Option<Arc<(String, Place)>>;

/// What a shape would be made of.
#[derive(Clone, Debug)]
pub(super) enum Material {
    /// pbrt's default, `diffuse`.
    Default,
    /// One that the scene describes.
    Made(MaterialId),
    /// No matter at all.
    Interface,
    /// Refused; we are lenient, or it would have been an error.
    Unsupported,
    /// To be looked up when all materials are known.
    Named(Arc<(String, Place)>),
}

/// The light that shapes send out.
#[derive(Clone, Debug)]
pub(super) struct AreaLight {
    /// `L` times `scale`; with `power` only its colour and the factor on that.
    pub(super) radiance: [f64; 3],
    pub(super) two_sided: bool,
    /// What a shape sends out in all \[W\].
    pub(super) power: Option<f64>,
    pub(super) place: Place,
}

/// The current transformation at the shutter's opening and closing.
pub(super) type Transforms = [DMat4; 2];

/// Parameters from `Attribute`, by target.
#[derive(Clone, Debug, Default)]
pub(super) struct Inherited {
    pub(super) shape: Arc<Vec<Arc<Param>>>,
    pub(super) light: Arc<Vec<Arc<Param>>>,
    pub(super) material: Arc<Vec<Arc<Param>>>,
    pub(super) medium: Arc<Vec<Arc<Param>>>,
    pub(super) texture: Arc<Vec<Arc<Param>>>,
}

/// The state that directives change and objects take over.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Maps object space to the world; before `WorldBegin` the world to the camera.
    pub(super) transforms: Transforms,
    /// Which of the two `Translate` and the like change.
    pub(super) active: [bool; 2],
    pub(super) reverse_orientation: bool,
    pub(super) material: Material,
    pub(super) light: Option<Arc<AreaLight>>,
    pub(super) inside: MediumName,
    pub(super) outside: MediumName,
    pub(super) inherited: Inherited,
}

impl Default for State {
    fn default() -> Self {
        Self {
            transforms: [DMat4::IDENTITY; 2],
            active: [true; 2],
            reverse_orientation: false,
            material: Material::Default,
            light: None,
            inside: None,
            outside: None,
            inherited: Inherited::default(),
        }
    }
}

impl State {
    /// Replaces the active transforms; `place` is the directive that does so.
    pub(super) fn change(
        &mut self,
        place: &Place,
        new: impl Fn(DMat4) -> DMat4,
    ) -> Result<(), SceneError> {
        for (transform, active) in self.transforms.iter_mut().zip(self.active) {
            if active {
                *transform = new(*transform);
                if invertible(transform).is_none() {
                    let message = "the transformation is singular or not finite from here on";
                    return Err(SceneError::at(place, message));
                }
            }
        }
        Ok(())
    }
}

/// The affine map of an invertible matrix.
fn invertible(matrix: &DMat4) -> Option<DAffine3> {
    let affine = DAffine3::from_mat4(*matrix);
    let inverse = affine.matrix3.inverse();
    let fine = matrix.is_finite() && affine.matrix3.determinant() != 0.0 && inverse.is_finite();
    fine.then_some(affine)
}

/// A matrix as an affine map with its inverse.
///
/// # Errors
/// A projective, singular or infinite one.
pub(super) fn affine(matrix: &DMat4, place: &Place) -> Result<[DAffine3; 2], SceneError> {
    let w = matrix.row(3);
    if w.truncate() != DVec3::ZERO || w.w != 1.0 {
        let message = "the transformation here is not affine";
        return Err(SceneError::at(place, message)
            .help("the last entry of each of its four columns must be 0 0 0 1"));
    }
    let found = invertible(matrix).map(|forth| [forth, forth.inverse()]);
    match found {
        Some([forth, back]) if back.is_finite() => Ok([forth, back]),
        _ => {
            let message = "the transformation here is singular or not finite";
            Err(SceneError::at(place, message))
        }
    }
}

/// Rotation by `degrees` about an axis: Rodrigues' formula. Sine and cosine come from libm, so that
/// every machine reads the same scene; quarter turns are exact.
pub(super) fn rotation(degrees: f64, axis: DVec3) -> DMat4 {
    let (s, c) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        turned => libm::sincos(turned.to_radians()),
    };
    let DVec3 { x, y, z } = axis / axis.length();
    let k = 1.0 - c;
    DMat4::from_cols_array(&[
        x * x * k + c,
        x * y * k + z * s,
        x * z * k - y * s,
        0.0,
        x * y * k - z * s,
        y * y * k + c,
        y * z * k + x * s,
        0.0,
        x * z * k + y * s,
        y * z * k - x * s,
        z * z * k + c,
        0.0,
        0.0,
        0.0,
        0.0,
        1.0,
    ])
}

/// The world seen from `eye`: to camera space with +z towards `at` and +y as near to `up` as can be,
/// left-handed, hence x to the right. `None` if the three leave that undefined.
pub(super) fn look_at(eye: DVec3, at: DVec3, up: DVec3) -> Option<DMat4> {
    let forward = (at - eye).try_normalize()?;
    let right = up.try_normalize()?.cross(forward).try_normalize()?;
    let upward = forward.cross(right);
    let to_world = DMat4::from_cols(
        right.extend(0.0),
        upward.extend(0.0),
        forward.extend(0.0),
        eye.extend(1.0),
    );
    let inverse = to_world.inverse();
    inverse.is_finite().then_some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_turns_are_exact_and_right_handed_in_formula() {
        let m = rotation(90.0, DVec3::Z * 3.0);
        assert_eq!(m.transform_vector3(DVec3::X), DVec3::Y);
        let m = rotation(-90.0, DVec3::X);
        assert_eq!(m.transform_vector3(DVec3::Z), DVec3::Y);
        let m = rotation(30.0, DVec3::new(1.0, 2.0, 3.0));
        let oracle =
            DMat4::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 30.0_f64.to_radians());
        assert!(m.abs_diff_eq(oracle, 1e-15));
    }

    #[test]
    fn look_at_is_left_handed() {
        let m = look_at(DVec3::new(0.0, 0.0, -5.0), DVec3::ZERO, DVec3::Y).expect("defined");
        assert_eq!(m.transform_point3(DVec3::ZERO), DVec3::new(0.0, 0.0, 5.0));
        assert_eq!(m.transform_vector3(DVec3::X), DVec3::X);
        assert!(look_at(DVec3::ZERO, DVec3::Y, DVec3::Y).is_none());
        assert!(look_at(DVec3::ZERO, DVec3::ZERO, DVec3::Y).is_none());
    }

    #[test]
    fn only_invertible_affine_maps_pass() {
        let place = Place::new(&super::super::super::Source::new("t", Vec::new()), 0, 0);
        assert!(affine(&DMat4::IDENTITY, &place).is_ok());
        assert!(affine(&DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)), &place).is_err());
        let mut projective = DMat4::IDENTITY;
        projective.x_axis.w = 0.1;
        assert!(affine(&projective, &place).is_err());
    }
}
