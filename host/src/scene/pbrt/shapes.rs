//! `Shape`: which shapes there are, and what the state makes of them.

use super::super::boundary::{Disk, Sphere};
use super::super::{Place, SceneError};
use super::directive::At;
use super::meshes::Mesh;
use super::param::{Type, Values};
use super::params::Params;
use super::reader::Reader;
use super::state::{AreaLight, Material, MediumName, affine};
use super::suggest::nearest;
use super::world::Placed;
use std::sync::Arc;

const SUPPORTED: &str = "supported are sphere, disk, trianglemesh, bilinearmesh and plymesh";
const SHAPES: [&str; 8] = [
    "bilinearmesh",
    "curve",
    "cylinder",
    "disk",
    "loopsubdiv",
    "plymesh",
    "sphere",
    "trianglemesh",
];

/// A shape whose medium and material names are not yet looked up.
#[derive(Debug)]
pub(super) struct ShapeDraft {
    pub(super) geometry: Geometry,
    pub(super) inside: MediumName,
    pub(super) outside: MediumName,
    pub(super) material: Material,
    pub(super) light: Option<Arc<AreaLight>>,
    pub(super) place: Place,
}

/// The geometry of a shape, in the world or in its object's space.
#[derive(Debug)]
pub(super) enum Geometry {
    /// With whether its normal is turned around.
    Sphere(Sphere, bool),
    /// With whether its normal is turned around.
    Disk(Disk, bool),
    /// Every face in the order that its normal asks for.
    Mesh(Mesh),
}

impl Reader<'_> {
    pub(super) fn shape(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "Shape")?;
        let inherited = self.state.inherited.shape.clone();
        let (ty, place, params) = self.typed(at, "Shape", inherited)?;
        let geometry = match ty.as_str() {
            "sphere" => self.sphere(at, &params)?,
            "disk" => self.disk(at, &params)?,
            "trianglemesh" => Geometry::Mesh(self.triangle_mesh(at, &params)?),
            "bilinearmesh" => Geometry::Mesh(self.bilinear_mesh(at, &params)?),
            "plymesh" => Geometry::Mesh(self.ply_mesh(at, &params)?),
            other => {
                let known = SHAPES.contains(&other);
                let what = if known {
                    "is not yet supported"
                } else {
                    "is unknown"
                };
                let error = SceneError::at(&place, format!("shape \"{other}\" {what}"));
                let near = nearest(other, SHAPES).filter(|_| !known);
                return self.diagnostics.refuse(match near {
                    Some(near) => error.help(format!("did you mean \"{near}\"?")),
                    None => error.help(SUPPORTED),
                });
            }
        };
        self.charge(params.copied(), &at.place)?;
        self.not_moving(&at.place)?;
        let mut light = self.state.light.clone();
        if let Some(source) = light.as_ref().filter(|_| self.objects > 0) {
            let message = "shapes within objects cannot be lights";
            self.diagnostics.refuse(
                SceneError::at(&at.place, message)
                    .note(&source.place, "this makes it one")
                    .help("pbrt ignores such lights; put the shape into the world"),
            )?;
            light = None;
        }
        let state = &self.state;
        let draft = ShapeDraft {
            geometry,
            inside: state.inside.clone(),
            outside: state.outside.clone(),
            material: state.material.clone(),
            light,
            place: at.place.clone(),
        };
        match self.world.objects.last_mut() {
            Some(object) if self.objects > 0 => object.shapes.push(draft),
            _ => self.world.placed.push(Placed::Shape(Box::new(draft))),
        }
        Ok(())
    }

    fn sphere(&mut self, at: &At, params: &Params) -> Result<Geometry, SceneError> {
        let radius = params
            .float("radius", "positive", |v| v > 0.0)?
            .unwrap_or(1.0);
        let instead = "only full spheres are supported";
        let partial = [("zmin", -radius), ("zmax", radius), ("phimax", 360.0)];
        for (name, full) in partial {
            let value = params.float(name, "a number", |_| true)?.unwrap_or(full);
            let cuts = if name == "zmin" {
                value > full
            } else {
                value < full
            };
            if cuts {
                params.unsupported(name, instead, &mut self.diagnostics)?;
            }
        }
        self.opaque(params)?;
        params.finish(&mut self.diagnostics)?;
        let [object_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        let sphere = Sphere {
            radius,
            object_to_world,
        };
        Ok(Geometry::Sphere(sphere, self.state.reverse_orientation))
    }

    fn disk(&mut self, at: &At, params: &Params) -> Result<Geometry, SceneError> {
        let height = params.float("height", "a number", |_| true)?.unwrap_or(0.0);
        let radius = params
            .float("radius", "positive", |v| v > 0.0)?
            .unwrap_or(1.0);
        let inner_radius = params
            .float("innerradius", "from 0 to below the radius", |v| {
                (0.0..radius).contains(&v)
            })?
            .unwrap_or(0.0);
        let round = params.float("phimax", "a number", |_| true)?;
        if round.is_some_and(|degrees| degrees < 360.0) {
            let instead = "only full disks are supported";
            params.unsupported("phimax", instead, &mut self.diagnostics)?;
        }
        self.opaque(params)?;
        params.finish(&mut self.diagnostics)?;
        let [object_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        let disk = Disk {
            height,
            radius,
            inner_radius,
            object_to_world,
        };
        Ok(Geometry::Disk(disk, self.state.reverse_orientation))
    }

    /// Refuses holes cut by `alpha`.
    pub(super) fn opaque(&mut self, params: &Params) -> Result<(), SceneError> {
        let Some(param) = params.find("alpha", &[Type::Float, Type::Texture])? else {
            return Ok(());
        };
        match &param.values {
            Values::Numbers(numbers) if numbers.as_slice() == [1.0] => Ok(()),
            _ => self
                .diagnostics
                .refuse(params.not_yet(param, "surfaces have no holes")),
        }
    }
}
