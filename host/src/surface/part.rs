//! One surface of a scene, made ready: what it is, and which pieces it has.

use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};

use super::spot::{Placement, Spot};
use super::{disk, exact, patch, sphere, triangle};
use crate::line::Shear;
use crate::scene::{
    self, AreaEmission, BilinearMesh, MaterialId, Place, SceneError, Shape, TriangleMesh,
};

/// How far from the origin a surface may reach: products of many coordinates must stay finite \[length\].
const FAR: f64 = 1e30;

/// Most pieces of all surfaces together: what a tree of them counts in 32 bits, and builds in some 60 GB.
pub(super) const MOST_PIECES: usize = 1 << 28;

/// Refuses what reaches too far, or is not a number.
pub(super) fn check_reach([low, high]: [DVec3; 2], place: &Place) -> Result<(), SceneError> {
    if low.abs().max(high.abs()).cmplt(DVec3::splat(FAR)).all() {
        return Ok(());
    }
    let message = format!("the surface reaches farther than {FAR:e} from the origin");
    Err(SceneError::at(place, message).help("change the unit of length"))
}

/// A shape; meshes stay where the scene has them.
#[derive(Clone, Debug)]
pub(super) enum Geometry {
    /// Minus the origin of rendering.
    Triangles(Arc<TriangleMesh>, DVec3),
    /// Minus the origin of rendering.
    Patches(Arc<BilinearMesh>, DVec3),
    /// The unit sphere.
    Sphere(Placement),
    /// The unit disk, with a hole of some radius.
    Disk(Placement, f64),
}

/// A surface.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) geometry: Geometry,
    pub(super) flipped: bool,
    pub(super) material: Option<MaterialId>,
    pub(super) emission: Option<AreaEmission>,
    /// Index of the emitter that its first piece is.
    pub(super) first_emitter: u32,
}

impl Part {
    /// `None` for what neither light nor path can notice.
    ///
    /// * `shines`: whether its emission counts.
    pub(super) fn new(
        surface: &scene::Surface,
        origin: DVec3,
        shines: bool,
    ) -> Result<Option<Self>, SceneError> {
        let emission = surface
            .emission
            .filter(|e| shines && e.radiance.iter().any(|&r| r > 0.0));
        if surface.material.is_none() && emission.is_none() {
            return Ok(None);
        }
        let singular = || SceneError::at(&surface.place, "the shape's transform is singular");
        let place = |own: DAffine3| {
            Placement::new(DAffine3::from_translation(-origin) * own).ok_or_else(singular)
        };
        let geometry = match &surface.shape {
            Shape::TriangleMesh(mesh) => Geometry::Triangles(Arc::clone(mesh), origin),
            Shape::BilinearMesh(mesh) => Geometry::Patches(Arc::clone(mesh), origin),
            Shape::Sphere(sphere) => {
                let scale = DAffine3::from_scale(DVec3::splat(sphere.radius));
                Geometry::Sphere(place(sphere.object_to_world * scale)?)
            }
            Shape::Disk(disk) => {
                let own = DAffine3::from_translation(DVec3::Z * disk.height)
                    * DAffine3::from_scale(DVec3::splat(disk.radius));
                let hole = disk.inner_radius / disk.radius;
                Geometry::Disk(place(disk.object_to_world * own)?, hole)
            }
        };
        let part = Self {
            geometry,
            flipped: surface.flipped,
            material: surface.material,
            emission,
            first_emitter: 0,
        };
        for point in part.corners() {
            check_reach([point; 2], &surface.place)?;
        }
        Ok(Some(part))
    }

    /// Points whose hull contains the surface.
    fn corners(&self) -> Box<dyn Iterator<Item = DVec3> + '_> {
        match &self.geometry {
            Geometry::Triangles(mesh, origin) => {
                Box::new(mesh.positions.iter().map(|p| *p - *origin))
            }
            Geometry::Patches(mesh, origin) => {
                Box::new(mesh.positions.iter().map(|p| *p - *origin))
            }
            Geometry::Sphere(_) | Geometry::Disk(..) => {
                Box::new(self.bounds(0).into_iter().flatten())
            }
        }
    }

    /// How many pieces it has, degenerate ones included.
    pub(super) fn pieces(&self) -> usize {
        match &self.geometry {
            Geometry::Triangles(mesh, _) => mesh.indices.len(),
            Geometry::Patches(mesh, _) => mesh.indices.len(),
            Geometry::Sphere(_) | Geometry::Disk(..) => 1,
        }
    }

    /// The corners of a box around a piece; `None` if the piece has no area.
    pub(super) fn bounds(&self, piece: u32) -> Option<[DVec3; 2]> {
        match &self.geometry {
            Geometry::Triangles(mesh, origin) => {
                let corners = triangle::corners(mesh, *origin, piece)?;
                let [a, b, c] = corners;
                (exact::normal(&corners) != DVec3::ZERO).then(|| [a.min(b).min(c), a.max(b).max(c)])
            }
            Geometry::Patches(mesh, origin) => {
                let patch = patch::patch(mesh, *origin, piece)?;
                let [a, b, c, d] = patch.corners;
                (!patch.is_degenerate()).then(|| [a.min(b).min(c).min(d), a.max(b).max(c).max(d)])
            }
            Geometry::Sphere(placement) => Some(placement.ball_bounds()),
            Geometry::Disk(placement, _) => Some(placement.disk_bounds()),
        }
    }

    /// Where a ray meets a piece at 0 < t ≤ `t_max`, and two numbers that say where on the piece.
    #[inline]
    pub(super) fn meet(
        &self,
        piece: u32,
        origin: DVec3,
        direction: DVec3,
        shear: &Shear,
        t_max: f64,
    ) -> Option<(f64, DVec2)> {
        match &self.geometry {
            Geometry::Triangles(mesh, shift) => {
                let corners = triangle::corners(mesh, *shift, piece)?;
                triangle::meet(&corners, shear, origin, t_max)
            }
            Geometry::Patches(mesh, shift) => {
                patch::patch(mesh, *shift, piece)?.meet(origin, direction, t_max)
            }
            Geometry::Sphere(placement) => {
                let (origin, direction) = placement.line(origin, direction);
                sphere::meet(origin, direction, t_max).map(|t| (t, DVec2::ZERO))
            }
            Geometry::Disk(placement, hole) => {
                let (origin, direction) = placement.line(origin, direction);
                disk::meet(origin, direction, *hole, t_max)
            }
        }
    }

    /// The place on a piece that [`meet`](Self::meet) found, its normal on the side that the scene says.
    ///
    /// * `near`: the place as the ray says it: the sphere has no other numbers.
    pub(super) fn spot(&self, piece: u32, at: DVec2, near: DVec3) -> Option<Spot> {
        let spot = match &self.geometry {
            Geometry::Triangles(mesh, shift) => {
                let corners = triangle::corners(mesh, *shift, piece)?;
                triangle::spot(mesh, &corners, piece, at)
            }
            Geometry::Patches(mesh, shift) => {
                let patch = patch::patch(mesh, *shift, piece)?;
                patch::spot(mesh, &patch, piece, at)
            }
            Geometry::Sphere(placement) => {
                let local = placement.to_local.transform_point3(near);
                placement.carry(&sphere::spot(local))
            }
            Geometry::Disk(placement, hole) => placement.carry(&disk::spot(at, *hole)),
        };
        Some(if self.flipped { spot.turned() } else { spot })
    }
}
