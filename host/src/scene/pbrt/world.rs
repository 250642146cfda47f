//! What has been gathered, and how it becomes a scene once every name is known.

use std::collections::HashMap;

use super::super::film::{Film, PixelBounds};
use super::super::surface::Instance;
use super::super::{
    Boundary, Camera, Integrator, Light, MediumId, NamedMedium, Object, Place, Projection, Scene,
    SceneError, ScreenWindow, surface,
};
use super::camera::CameraDraft;
use super::diagnostics::Diagnostics;
use super::objects::ObjectDraft;
use super::placing::{Parts, Placing, placed, size};
use super::shapes::ShapeDraft;
use super::state::Material;
use super::textures::Textures;

/// A shape of the world or an instance, in file order.
#[derive(Debug)]
pub(super) enum Placed {
    Shape(Box<ShapeDraft>),
    Instance(Instance),
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
    pub(super) materials: Vec<surface::Material>,
    pub(super) material_names: HashMap<String, (Material, Place)>,
    pub(super) textures: Textures,
    pub(super) objects: Vec<ObjectDraft>,
    pub(super) object_names: HashMap<String, (usize, Place)>,
    pub(super) placed: Vec<Placed>,
    pub(super) lights: Vec<Light>,
    /// Memory of what was copied \[bytes\].
    pub(super) copied: u64,
}

impl World {
    /// Looks up all names. Media and materials may be defined after they are mentioned, as in pbrt.
    ///
    /// `max_memory`: most that copies of boundaries may take \[bytes\].
    pub(super) fn finish(
        self,
        diagnostics: &mut Diagnostics,
        max_memory: u64,
    ) -> Result<Scene, SceneError> {
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
        let mut placing = Placing {
            media: &self.medium_names,
            names: &self.material_names,
            materials: self.materials,
            default: None,
            diagnostics,
        };
        let camera_medium = placing.medium(&camera_medium)?;
        let mut objects = Vec::with_capacity(self.objects.len());
        let mut enclosures: Vec<Vec<Boundary>> = Vec::with_capacity(self.objects.len());
        for draft in self.objects {
            let mut parts = Parts::default();
            for shape in draft.shapes {
                placing.shape(shape, &mut parts)?;
            }
            objects.push(Object {
                name: draft.name,
                surfaces: parts.surfaces,
            });
            enclosures.push(parts.boundaries);
        }
        let mut parts = Parts::default();
        let mut instances = Vec::new();
        let mut copied = self.copied;
        for item in self.placed {
            let instance = match item {
                Placed::Shape(draft) => {
                    placing.shape(*draft, &mut parts)?;
                    continue;
                }
                Placed::Instance(instance) => instance,
            };
            for boundary in enclosures.get(instance.object).into_iter().flatten() {
                copied = copied.saturating_add(size(boundary));
                within(copied, max_memory, &instance.place)?;
                parts.boundaries.push(placed(boundary, &instance)?);
            }
            instances.push(instance);
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
            boundaries: parts.boundaries,
            surfaces: parts.surfaces,
            materials: placing.materials,
            objects,
            instances,
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

/// Refuses copies that take too much.
pub(super) fn within(copied: u64, max_memory: u64, place: &Place) -> Result<(), SceneError> {
    if copied <= max_memory {
        return Ok(());
    }
    let message = format!("what is copied up to here takes {copied} bytes");
    Err(SceneError::at(place, message).help(format!("the limit is {max_memory} bytes")))
}
