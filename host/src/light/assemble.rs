//! Lights of a scene made ready: pictures read, factors applied, ranges checked.

use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};

use super::picture::SphericalPicture;
use super::source::{Painted, Source, scaled};
use super::spot::Cone;
use crate::image::read_picture;
use crate::scene::{Files, GoniometricLight, ImageLight, Light, Place, Scene, SceneError};
use crate::surface::Surfaces;
use crate::volume::Limits;

/// Luminance of linear Rec. 709 (the row Y of its primaries, ITU-R BT.709).
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// What a transform may differ from a rotation by, relative to its scale.
const SHEAR: f64 = 1e-6;

/// What all lights of a scene share.
pub(super) struct Assembly<'a> {
    /// The film's factor on every pixel.
    pub(super) factor: f64,
    pub(super) origin: DVec3,
    pub(super) files: &'a dyn Files,
    pub(super) limits: &'a Limits,
}

impl Assembly<'_> {
    /// A light of the scene that is no surface.
    pub(super) fn source(&self, light: &Light) -> Result<Source, SceneError> {
        let place = light.place();
        Ok(match light {
            Light::Distant(light) => Source::Distant {
                direction: light.direction_to_light,
                irradiance: self.bright(light.irradiance, place)?,
            },
            Light::Constant(light) => Source::Constant {
                radiance: self.bright(light.radiance, place)?,
            },
            Light::Image(light) => Source::Image(self.image(light)?),
            Light::Point(light) => Source::Point {
                position: self.local(light.position, place)?,
                intensity: self.bright(light.intensity, place)?,
            },
            Light::Spot(light) => Source::Spot {
                position: self.local(light.position, place)?,
                cone: Cone {
                    axis: light.axis,
                    cos_full: light.cos_falloff_start,
                    cos_dark: light.cos_total_width,
                },
                intensity: self.bright(light.intensity, place)?,
            },
            Light::Goniometric(light) => self.goniometric(light)?,
        })
    }

    /// Times the film's factor.
    fn bright(&self, value: [f64; 3], place: &Place) -> Result<[f64; 3], SceneError> {
        let value = scaled(value, self.factor);
        let lit = |c: &f64| *c >= 0.0 && (*c as f32).is_finite();
        if value.iter().all(lit) {
            return Ok(value);
        }
        Err(SceneError::at(
            place,
            format!(
                "the light's strength {value:?} is negative or beyond the range of 32-bit numbers"
            ),
        ))
    }

    /// Relative to the origin of rendering.
    fn local(&self, position: DVec3, place: &Place) -> Result<DVec3, SceneError> {
        let position = position - self.origin;
        if position.as_vec3().is_finite() {
            return Ok(position);
        }
        let message = "the light's place is beyond the range of 32-bit numbers";
        Err(SceneError::at(place, message))
    }

    fn picture(&self, filename: &Path, place: &Place) -> Result<SphericalPicture, SceneError> {
        let picture = read_picture(self.files, filename, None, self.limits);
        let picture = picture.and_then(SphericalPicture::new);
        picture.map_err(|error| SceneError::at(place, format!("{} {error}", filename.display())))
    }

    fn image(&self, light: &ImageLight) -> Result<Painted, SceneError> {
        let place = &light.place;
        let rotation = rotation(&light.light_to_world, place)?;
        let picture = self.picture(&light.filename, place)?;
        let scale = match light.illuminance {
            None => light.scale,
            Some(wanted) => {
                let luminance =
                    |c: [f64; 3]| LUMINANCE[0] * c[0] + LUMINANCE[1] * c[1] + LUMINANCE[2] * c[2];
                let given = picture.irradiance(luminance);
                if given <= 0.0 {
                    let message = "the upper half of the picture is black, so no factor gives it an illuminance";
                    return Err(SceneError::at(place, message));
                }
                wanted / given
            }
        };
        let factor = scale * self.factor;
        self.bright([scale * f64::from(picture.brightest()); 3], place)?;
        Ok(Painted {
            picture,
            rotation,
            factor,
        })
    }

    fn goniometric(&self, light: &GoniometricLight) -> Result<Source, SceneError> {
        let place = &light.place;
        let rotation = rotation(&light.light_to_world, place)?;
        let picture = self.picture(&light.filename, place)?;
        if !picture.layout().is_octahedral() {
            let message = "the picture of a goniometric light is square: an equal-area octahedron";
            return Err(SceneError::at(place, message));
        }
        let scale = match light.power {
            None => 1.0,
            Some(_) if picture.total() <= 0.0 => {
                let message = "the picture is black, so no factor gives it a power";
                return Err(SceneError::at(place, message));
            }
            Some(power) => power / picture.total(),
        };
        let intensity = self.bright(scaled(light.intensity, scale), place)?;
        self.bright(
            scaled(light.intensity, scale * f64::from(picture.brightest())),
            place,
        )?;
        Ok(Source::Goniometric {
            position: self.local(light.light_to_world.translation, place)?,
            painted: Painted {
                picture,
                rotation,
                factor: 1.0,
            },
            intensity,
        })
    }

    /// That no surface shines too brightly: its pieces do not know their place in the scene.
    pub(super) fn check_surfaces(&self, scene: &Scene) -> Result<(), SceneError> {
        for surface in &scene.surfaces {
            if let Some(emission) = &surface.emission {
                self.bright(emission.radiance, &surface.place)?;
            }
        }
        Ok(())
    }

    /// A piece of a surface that shines.
    pub(super) fn emitter(&self, surfaces: &Surfaces, index: u32) -> Source {
        let (radiance, two_sided) = surfaces.emission(index);
        Source::Emitter {
            index,
            radiance: scaled(radiance, self.factor),
            two_sided,
            area: surfaces.area(index),
            centre: {
                let ([low, high], ..) = surfaces.emitter_bounds(index);
                (low + high) * 0.5
            },
        }
    }
}

/// The rotation of a transform, mirrored if it mirrors; it may scale all axes alike.
fn rotation(transform: &DAffine3, place: &Place) -> Result<DMat3, SceneError> {
    let DMat3 {
        x_axis: x,
        y_axis: y,
        z_axis: z,
    } = transform.matrix3;
    let square = x.length_squared();
    let even = |a: f64, b: f64| (a - b).abs() <= SHEAR * square;
    let like_a_rotation = even(y.length_squared(), square)
        && even(z.length_squared(), square)
        && [x.dot(y), y.dot(z), z.dot(x)]
            .iter()
            .all(|dot| even(*dot, 0.0));
    let axes = x.try_normalize().and_then(|x| {
        let y = (y - x * x.dot(y)).try_normalize()?;
        let across = x.cross(y);
        let z = if across.dot(z) < 0.0 { -across } else { across };
        Some(DMat3::from_cols(x, y, z))
    });
    match axes {
        Some(axes) if like_a_rotation => Ok(axes),
        _ => Err(SceneError::at(
            place,
            "the transform of a light with a picture must be a rotation, perhaps mirrored or scaled evenly",
        )),
    }
}
