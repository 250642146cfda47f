//! Surfaces made ready to be met by rays: nearest hits, occlusion, and the sampling of those that shine.

//!
//! A ray is met with shapes in double precision; every place found carries a bound on how far it lies from the true
//! surface, so that what leaves it never meets it again and nothing farther away than that is missed. A tree over
//! all pieces of the world leads to them, and objects have trees of their own, to which instances bring the ray.
//!
//! Beside the scene's meshes, which are shared, a triangle takes at most 72 bytes: two nodes of the tree and a leaf;
//! some 50 are usual. While a tree is built, some 200 more are taken.

mod disk;
mod emitter;
mod exact;
mod group;
mod part;
mod patch;
mod sphere;
mod spot;
mod tree;
mod triangle;

use glam::{DAffine3, DVec2, DVec3};

use crate::ray::{Anchor, Ray};
use crate::scene::{MaterialId, Scene, SceneError};
use group::{Group, Instance};
use part::Part;
use spot::{Placement, Spot};

fn anchor(spot: &Spot) -> Anchor {
    Anchor {
        point: spot.point,
        normal: spot.normal,
        error: spot.error,
    }
}

/// Where a ray meets a surface.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f64,
    /// The place, its unit geometric normal (oriented as the scene says: outside of dielectrics, the
    /// shining side of lights) and its error bound.
    pub anchor: Anchor,
    /// Unit shading normal, on the side of the geometric one.
    pub shading_normal: DVec3,
    /// ∂p/∂u made orthogonal to the shading normal, unit: the axis of anisotropic roughness.
    pub tangent: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
    /// What it is made of; `None` lets light pass.
    pub material: Option<MaterialId>,
    /// Which emitter shines here, if one does.
    pub emitter: Option<u32>,
}

/// A point on an emitter, chosen as light for some place.
#[derive(Clone, Copy, Debug)]
pub struct EmitterPoint {
    /// The place and its normal (oriented as in [`Hit`]).
    pub anchor: Anchor,
    /// Density of the choice per solid angle at the reference [1/sr], or per area [1/length²]; see the method.
    pub pdf: f64,
}

/// All surfaces of a scene that have matter or light.
#[derive(Debug, Default)]
pub struct Surfaces {
    world: Group,
    objects: Vec<Group>,
    /// For each part that shines, the index of its first emitter and the part's; sorted.
    shining: Vec<(u32, u32)>,
    emitters: u32,
}

impl Surfaces {
    /// Sorts a scene's surfaces and instances for traversal.
    ///
    /// * `origin`: the place of the world that becomes the origin of rendering.
    ///
    /// # Errors
    /// What is too large for memory or for double precision; transforms that cannot be inverted.
    pub fn new(scene: &Scene, origin: DVec3) -> Result<Self, SceneError> {
        let ready = |surfaces: &[crate::scene::Surface], origin, shines| {
            let parts: Result<Vec<_>, _> = surfaces
                .iter()
                .filter_map(|s| Part::new(s, origin, shines).transpose())
                .collect();
            parts
        };
        let mut objects: Vec<Group> = Vec::with_capacity(scene.objects.len());
        for object in &scene.objects {
            let parts = ready(&object.surfaces, DVec3::ZERO, false)?;
            let place = object.surfaces.last().map(|s| &s.place);
            objects.push(Group::new(parts, Vec::new(), &[], place)?);
        }
        let mut instances = Vec::with_capacity(scene.instances.len());
        for instance in &scene.instances {
            let to_world = DAffine3::from_translation(-origin) * instance.object_to_world;
            let placement = Placement::new(to_world).ok_or_else(|| {
                SceneError::at(&instance.place, "the instance's transform is singular")
            })?;
            let own = objects.get(instance.object).and_then(|o| o.bounds);
            if let Some(own) = own {
                part::check_reach(placement.box_bounds(own), &instance.place)?;
            }
            instances.push(Instance {
                object: instance.object,
                placement,
            });
        }
        let mut parts = ready(&scene.surfaces, origin, true)?;
        let place = scene.surfaces.last().map(|s| &s.place);
        let place = place.or(scene.instances.last().map(|i| &i.place));
        let mut shining = Vec::new();
        let mut emitters = 0_u32;
        for (index, part) in (0..).zip(&mut parts) {
            if part.emission.is_some() {
                part.first_emitter = emitters;
                shining.push((emitters, index));
                // More than fit are refused below, as pieces.
                emitters =
                    emitters.saturating_add(u32::try_from(part.pieces()).unwrap_or(u32::MAX));
            }
        }
        Ok(Self {
            world: Group::new(parts, instances, &objects, place)?,
            objects,
            shining,
            emitters,
        })
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.world.bounds.is_none()
    }

    /// The corners of a box around all; `None` if there is none.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        self.world.bounds
    }

    /// The corners of at most `most` ≥ 1 boxes that together hold all surfaces: those of shapes and instances, the smallest joined.
    pub fn enclosures(&self, most: usize) -> Vec<[DVec3; 2]> {
        group::join(self.world.outlines(&self.objects), most)
    }

    /// The nearest surface at 0 < t < `t_max`.
    pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Hit> {
        let met = self
            .world
            .nearest(&self.objects, ray.origin, ray.direction, t_max)
            .filter(|met| met.t < t_max)?;
        let part = self.world.part(&self.objects, &met)?;
        let spot = self
            .world
            .spot(&self.objects, &met, ray.origin, ray.direction)?;
        let (shading_normal, tangent) = spot.frame();
        Some(Hit {
            t: met.t,
            anchor: anchor(&spot),
            shading_normal,
            tangent,
            uv: spot.uv,
            material: part.material,
            emitter: part.emission.map(|_| part.first_emitter + met.piece),
        })
    }

    /// Whether any surface that has a material lies at 0 < t < `t_max`.
    pub fn occluded(&self, ray: &Ray, t_max: f64) -> bool {
        self.world
            .occluded(&self.objects, ray.origin, ray.direction, t_max)
    }
}
