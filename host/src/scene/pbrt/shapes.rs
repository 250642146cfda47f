//! `Shape`, and what shapes could be made of: materials, textures, instances.

use std::sync::Arc;

use glam::DVec3;

use super::super::boundary::{Enclosure, Sphere, TriangleMesh};
use super::super::{Place, SceneError, ply};
use super::directive::At;
use super::param::{Param, Type, Values};
use super::params::Params;
use super::reader::Reader;
use super::state::{Material, affine};
use super::suggest::nearest;
use super::world::ShapeDraft;

const SUPPORTED: &str = "supported are sphere, trianglemesh and plymesh";
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
const MATERIALS: [&str; 15] = [
    "coatedconductor",
    "coateddiffuse",
    "conductor",
    "dielectric",
    "diffuse",
    "diffusetransmission",
    "hair",
    "interface",
    "measured",
    "mix",
    "subsurface",
    "thindielectric",
    "debug",
    "uber",
    "none",
];

impl Reader<'_> {
    pub(super) fn shape(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "Shape")?;
        let inherited = self.state.inherited.shape.clone();
        let (ty, place, params) = self.typed(at, "Shape", inherited)?;
        let shape = match ty.as_str() {
            "sphere" => self.sphere(at, &params)?,
            "trianglemesh" => self.triangle_mesh(at, &params)?,
            "plymesh" => self.ply_mesh(at, &params)?,
            other => {
                let known = SHAPES.contains(&other);
                let what = if known {
                    "is not yet supported"
                } else {
                    "is unknown"
                };
                let error = SceneError::at(&place, format!("shape \"{other}\" {what}"));
                let near = nearest(other, SHAPES).filter(|_| !known);
                self.diagnostics.refuse(match near {
                    Some(near) => error.help(format!("did you mean \"{near}\"?")),
                    None => error.help(SUPPORTED),
                })?;
                return Ok(());
            }
        };
        let Some(shape) = shape else {
            return Ok(());
        };
        self.not_moving(&at.place)?;
        // Leniently skipped instances must not leave their definition behind.
        if self.objects > 0 {
            return Ok(());
        }
        let state = &self.state;
        self.world.shapes.push(ShapeDraft {
            shape,
            reverse_orientation: state.reverse_orientation,
            inside: state.inside.clone(),
            outside: state.outside.clone(),
            material: state.material.clone(),
            place: at.place.clone(),
        });
        Ok(())
    }

    fn sphere(&mut self, at: &At, params: &Params) -> Result<Option<Enclosure>, SceneError> {
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
        Ok(Some(Enclosure::Sphere(Sphere {
            radius,
            object_to_world,
        })))
    }

    fn triangle_mesh(&mut self, at: &At, params: &Params) -> Result<Option<Enclosure>, SceneError> {
        let Some((coordinates, points)) = params.list("P", Type::Point3)? else {
            let message = "this trianglemesh has no \"point3 P\"";
            return Err(SceneError::at(params.place(), message));
        };
        let positions: Vec<DVec3> = vectors(coordinates);
        let indices = match params.list("indices", Type::Integer)? {
            Some((values, param)) => triangles(values, positions.len(), param)?,
            None if positions.len() == 3 => vec![[0, 1, 2]],
            None => {
                let message = "this trianglemesh has no \"integer indices\"";
                return Err(SceneError::at(&points.valued, message)
                    .help("they may only be left out for a single triangle"));
            }
        };
        let normals = match params.list("N", Type::Normal)? {
            None => None,
            Some((values, _)) if values.len() == coordinates.len() => Some(vectors(values)),
            Some((values, param)) => {
                let (n, p) = (values.len() / 3, positions.len());
                let message = format!("{n} normals for {p} vertices");
                return Err(SceneError::at(&param.valued, message));
            }
        };
        params.ignore("uv", &[Type::Point2])?;
        params.ignore("S", &[Type::Vector3])?;
        params.ignore("faceIndices", &[Type::Integer])?;
        self.opaque(params)?;
        params.finish(&mut self.diagnostics)?;
        self.mesh(at, positions, indices, normals).map(Some)
    }

    fn ply_mesh(&mut self, at: &At, params: &Params) -> Result<Option<Enclosure>, SceneError> {
        let Some(filename) = params.string("filename")?.cloned() else {
            let message = "this plymesh has no \"string filename\"";
            return Err(SceneError::at(params.place(), message));
        };
        for name in ["displacement", "edgelength"] {
            let instead = "displacement is not supported";
            params.unsupported(name, instead, &mut self.diagnostics)?;
        }
        self.opaque(params)?;
        params.finish(&mut self.diagnostics)?;
        let path = self.resolve(&filename.text);
        let bytes = self.load_at(&path, &filename.place)?;
        let mesh = ply::read(&bytes, self.limits.max_memory).map_err(|reason| {
            let message = format!("{}: {reason}", path.display());
            SceneError::at(&filename.place, message)
        })?;
        self.mesh(at, mesh.positions, mesh.triangles, mesh.normals)
            .map(Some)
    }

    /// Refuses holes cut by `alpha`.
    fn opaque(&mut self, params: &Params) -> Result<(), SceneError> {
        let Some(param) = params.find("alpha", &[Type::Float, Type::Texture])? else {
            return Ok(());
        };
        match &param.values {
            Values::Numbers(numbers) if numbers.as_slice() == [1.0] => Ok(()),
            _ => self
                .diagnostics
                .refuse(params.not_yet(param, "boundaries have no holes")),
        }
    }

    /// Brings a mesh to the world, each triangle wound so that its normal points to `outside`.
    ///
    /// pbrt takes the normal from the winding in the mesh's own space, unless there are normals at the
    /// vertices, which then decide on the side.
    fn mesh(
        &self,
        at: &At,
        mut positions: Vec<DVec3>,
        mut indices: Vec<[u32; 3]>,
        normals: Option<Vec<DVec3>>,
    ) -> Result<Enclosure, SceneError> {
        let [to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        if let Some(normals) = normals {
            for triangle in &mut indices {
                let [a, b, c] = triangle.map(|i| positions[i as usize]);
                let shading: DVec3 = triangle.iter().map(|&i| normals[i as usize]).sum();
                if (b - a).cross(c - a).dot(shading) < 0.0 {
                    triangle.swap(1, 2);
                }
            }
        }
        for position in &mut positions {
            *position = to_world.transform_point3(*position);
            if !position.as_vec3().is_finite() {
                let message = "a vertex of this mesh is not finite in the world";
                return Err(SceneError::at(&at.place, message));
            }
        }
        // A mirror turns the cross product of a triangle's edges around, but not what is outside.
        if to_world.matrix3.determinant() < 0.0 {
            indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        Ok(Enclosure::TriangleMesh(Arc::new(TriangleMesh {
            positions,
            indices,
            ..TriangleMesh::default()
        })))
    }

    pub(super) fn material(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "Material")?;
        let inherited = self.state.inherited.material.clone();
        let (ty, place, params) = self.typed(at, "Material", inherited)?;
        self.state_mut().material = self.material_named(&ty, &place, &params)?;
        Ok(())
    }

    fn material_named(
        &mut self,
        ty: &str,
        place: &Place,
        params: &Params,
    ) -> Result<Material, SceneError> {
        // The other two are what pbrt-v3 called it.
        if ["interface", "", "none"].contains(&ty) {
            params.finish(&mut self.diagnostics)?;
            return Ok(Material::Interface);
        }
        let known = MATERIALS.contains(&ty);
        let what = if known {
            "is not yet supported"
        } else {
            "is unknown"
        };
        let error = SceneError::at(place, format!("material \"{ty}\" {what}"));
        let near = nearest(ty, MATERIALS).filter(|_| !known);
        self.diagnostics.refuse(match near {
            Some(near) => error.help(format!("did you mean \"{near}\"?")),
            None => error.help("supported is \"interface\", a boundary between media"),
        })?;
        Ok(Material::Unsupported)
    }

    pub(super) fn make_named_material(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "MakeNamedMaterial")?;
        let (name, place) = self.string(at, "a material's name")?;
        let inherited = self.state.inherited.material.clone();
        let params = self.params(at, format!("material \"{name}\""), inherited)?;
        if let Some((_, older)) = self.world.materials.get(&name) {
            let message = format!("material \"{name}\" is defined twice");
            return Err(SceneError::at(&place, message).note(older, "first here"));
        }
        let Some(ty) = params.string("type")?.cloned() else {
            let message = format!("material \"{name}\" has no \"string type\"");
            return Err(SceneError::at(&place, message));
        };
        let material = self.material_named(&ty.text, &ty.place, &params)?;
        self.world.materials.insert(name, (material, place));
        Ok(())
    }

    pub(super) fn named_material(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "NamedMaterial")?;
        let named = self.string(at, "a material's name")?;
        self.state_mut().material = Material::Named(Arc::new(named));
        Ok(())
    }

    pub(super) fn texture(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "Texture")?;
        let (name, place) = self.string(at, "a texture's name")?;
        let (ty, ty_place) = self.string(at, "float or spectrum")?;
        if ty != "float" && ty != "spectrum" {
            let message = format!("texture type \"{ty}\" is unknown");
            let error = SceneError::at(&ty_place, message);
            self.diagnostics
                .refuse(error.help("it is \"float\" or \"spectrum\""))?;
        }
        let inherited = self.state.inherited.texture.clone();
        self.typed(at, "Texture", inherited)?;
        let message = format!("textures are not yet supported: \"{name}\"");
        self.diagnostics.refuse(SceneError::at(&place, message))
    }

    pub(super) fn object_begin(&mut self, at: &At) -> Result<(), SceneError> {
        self.string(at, "an object's name")?;
        self.diagnostics.refuse(no_instances(&at.place))?;
        if self.objects > 0 {
            let message = "objects cannot be defined within objects";
            return Err(SceneError::at(&at.place, message));
        }
        self.attribute_begin(at, true)
    }

    pub(super) fn object_end(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "ObjectEnd")?;
        self.restore(at, true)
    }

    pub(super) fn object_instance(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "ObjectInstance")?;
        self.string(at, "an object's name")?;
        self.diagnostics.refuse(no_instances(&at.place))
    }
}

fn no_instances(place: &Place) -> SceneError {
    SceneError::at(place, "object instances are not yet supported")
        .help("put the shapes themselves into the world")
}

fn vectors(numbers: &[f64]) -> Vec<DVec3> {
    let (triples, _) = numbers.as_chunks::<3>();
    triples.iter().map(|&xyz| DVec3::from_array(xyz)).collect()
}

fn triangles(values: &[f64], vertices: usize, param: &Param) -> Result<Vec<[u32; 3]>, SceneError> {
    let (triples, rest) = values.as_chunks::<3>();
    if !rest.is_empty() {
        let message = format!("{} indices cannot be grouped into triangles", values.len());
        return Err(SceneError::at(&param.valued, message));
    }
    let within = |v: &f64| *v >= 0.0 && *v < vertices as f64;
    if let Some(i) = values.iter().position(|v| !within(v)) {
        let message = format!("index {} names none of the {vertices} vertices", values[i]);
        return Err(SceneError::at(&param.nth(i), message));
    }
    let index = |v: f64| v as u32;
    Ok(triples.iter().map(|t| t.map(index)).collect())
}
