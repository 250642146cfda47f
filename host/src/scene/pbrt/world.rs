//! What has been gathered, and how it becomes a scene once every name is known.

use std::collections::HashMap;

use super::super::film::{Film, PixelBounds};
use super::super::{
    Boundary, Camera, Enclosure, Integrator, Light, MediumId, NamedMedium, Place, Projection,
    Scene, SceneError, ScreenWindow,
};
use super::camera::CameraDraft;
use super::diagnostics::Diagnostics;
use super::state::{Material, MediumName};
use super::suggest::nearest;

/// A shape whose medium and material names are not yet looked up.
#[derive(Debug)]
pub(super) struct ShapeDraft {
    pub(super) shape: Enclosure,
    pub(super) reverse_orientation: bool,
    pub(super) inside: MediumName,
    pub(super) outside: MediumName,
    pub(super) material: Material,
    pub(super) place: Place,
}

/// Everything that directives have added so far.
#[derive(Debug, Default)]
pub(super) struct World {
    pub(super) film: Option<Film>,
    pub(super) camera: Option<CameraDraft>,
    pub(super) samples_per_pixel: Option<u32>,
    pub(super) seed: Option<u64>,
    pub(super) integrator: Option<Integrator>,
    pub(super) media: Vec<NamedMedium>,
    /// `None` for a medium that was refused, leniently.
    pub(super) medium_names: HashMap<String, (Option<MediumId>, Place)>,
    pub(super) materials: HashMap<String, (Material, Place)>,
    pub(super) shapes: Vec<ShapeDraft>,
    pub(super) lights: Vec<Light>,
}

impl World {
    /// Looks up all names. Media and materials may be defined after they are mentioned, as in pbrt.
    pub(super) fn finish(self, diagnostics: &mut Diagnostics) -> Result<Scene, SceneError> {
        let mut film = self.film.unwrap_or(Film {
            width: 1280,
            height: 720,
            crop: PixelBounds {
                x0: 0,
                x1: 1280,
                y0: 0,
                y1: 720,
            },
            filename: "pbrt.exr".to_owned(),
            imaging_ratio: 1.0,
            place: None,
        });
        let (camera, camera_medium) = match &self.camera {
            Some(draft) => (draft.finish(&mut film, diagnostics)?, draft.medium.clone()),
            None => (default_camera(&film), None),
        };
        let names = &self.medium_names;
        let camera_medium = medium(names, &camera_medium, diagnostics)?;
        let mut boundaries = Vec::with_capacity(self.shapes.len());
        for draft in self.shapes {
            let inside = medium(names, &draft.inside, diagnostics)?;
            let outside = medium(names, &draft.outside, diagnostics)?;
            let material = match &draft.material {
                Material::Named(name) => match self.materials.get(&name.0) {
                    Some((material, _)) => material.clone(),
                    None => {
                        let known = self.materials.keys().map(String::as_str);
                        diagnostics.refuse(undefined("material", name, known))?;
                        Material::Unsupported
                    }
                },
                other => other.clone(),
            };
            if matches!(material, Material::Default) {
                let message = "this shape has pbrt's default material \"diffuse\", which is not yet supported";
                diagnostics.refuse(
                    SceneError::at(&draft.place, message)
                        .help("write Material \"interface\" before it"),
                )?;
            }
            // Leniently, a surface that is not understood still separates its media, or vanishes.
            if !matches!(material, Material::Interface) && inside == outside {
                continue;
            }
            let (inside, outside) = if draft.reverse_orientation {
                (outside, inside)
            } else {
                (inside, outside)
            };
            boundaries.push(Boundary {
                shape: draft.shape,
                inside,
                outside,
                place: draft.place,
            });
        }
        Ok(Scene {
            film,
            camera,
            samples_per_pixel: self.samples_per_pixel,
            seed: self.seed,
            integrator: self.integrator.unwrap_or(Integrator {
                name: "path".to_owned(),
                max_depth: None,
            }),
            media: self.media,
            camera_medium,
            boundaries,
            surfaces: Vec::new(),
            materials: Vec::new(),
            objects: Vec::new(),
            instances: Vec::new(),
            lights: self.lights,
            warnings: Vec::new(),
            source_hash: 0,
        })
    }
}

/// pbrt's camera when none is given: at the origin, 90 degrees.
fn default_camera(film: &Film) -> Camera {
    Camera {
        projection: Projection::Perspective { fov: 90.0 },
        screen_window: ScreenWindow::from_aspect(f64::from(film.width) / f64::from(film.height)),
        lens_radius: 0.0,
        focal_distance: 1e6,
        camera_to_world: glam::DAffine3::IDENTITY,
        place: None,
    }
}

fn medium(
    names: &HashMap<String, (Option<MediumId>, Place)>,
    name: &MediumName,
    diagnostics: &mut Diagnostics,
) -> Result<Option<MediumId>, SceneError> {
    let Some(name) = name else {
        return Ok(None);
    };
    match names.get(&name.0) {
        Some((id, _)) => Ok(*id),
        None => {
            let known = names.keys().map(String::as_str);
            diagnostics.refuse(undefined("medium", name, known))?;
            Ok(None)
        }
    }
}

fn undefined<'a>(
    what: &str,
    (name, place): &(String, Place),
    known: impl Iterator<Item = &'a str>,
) -> SceneError {
    let mut known: Vec<&str> = known.collect();
    // Hash maps have no order of their own, messages should.
    known.sort_unstable();
    let error = SceneError::at(place, format!("{what} \"{name}\" is not defined"));
    match nearest(name, known.iter().copied()) {
        Some(near) => error.help(format!("did you mean \"{near}\"?")),
        None if known.is_empty() => error.help(format!("the scene defines no {what}")),
        None => error.help(format!("there are {}", known.join(", "))),
    }
}
