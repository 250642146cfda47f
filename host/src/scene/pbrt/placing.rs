//! How shapes become surfaces and boundaries, once every name is known.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;

use glam::{DAffine3, DVec3};

use super::super::surface::{self, Instance, MaterialKind};
use super::super::{
    AreaEmission, Boundary, Disk, Enclosure, MaterialId, MediumId, Place, SceneError, Shape,
    Sphere, Surface, Texture, TriangleMesh,
};
use super::diagnostics::Diagnostics;
use super::meshes::Mesh;
use super::shapes::{Geometry, ShapeDraft};
use super::state::{Material, MediumName};
use super::suggest::undefined;

/// What shapes have become.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub(super) surfaces: Vec<Surface>,
    pub(super) boundaries: Vec<Boundary>,
}

/// Names, and what they stand for.
#[derive(Debug)]
pub(super) struct Placing<'a> {
    pub(super) media: &'a HashMap<String, (Option<MediumId>, Place)>,
    pub(super) names: &'a HashMap<String, (Material, Place)>,
    pub(super) materials: Vec<surface::Material>,
    /// pbrt's default material, once it is needed.
    pub(super) default: Option<MaterialId>,
    pub(super) diagnostics: &'a mut Diagnostics,
}

/// The media on either side of a normal.
#[derive(Clone, Copy, Debug)]
struct Sides {
    inside: Option<MediumId>,
    outside: Option<MediumId>,
}

impl Placing<'_> {
    /// The medium of a name.
    pub(super) fn medium(&mut self, name: &MediumName) -> Result<Option<MediumId>, SceneError> {
        let Some(name) = name else {
            return Ok(None);
        };
        let (text, place) = &**name;
        if let Some((id, _)) = self.media.get(text) {
            return Ok(*id);
        }
        let known = self.media.keys().map(String::as_str);
        self.diagnostics
            .refuse(undefined("medium", text, place, known))?;
        Ok(None)
    }

    fn material(&mut self, draft: &ShapeDraft) -> Result<Material, SceneError> {
        let material = match &draft.material {
            Material::Named(name) => match self.names.get(&name.0) {
                Some((material, _)) => material.clone(),
                None => {
                    let known = self.names.keys().map(String::as_str);
                    let error = undefined("material", &name.0, &name.1, known);
                    self.diagnostics.refuse(error)?;
                    Material::Unsupported
                }
            },
            other => other.clone(),
        };
        if !matches!(material, Material::Default) {
            return Ok(material);
        }
        let id = *self.default.get_or_insert_with(|| {
            self.materials.push(surface::Material {
                kind: MaterialKind::Diffuse {
                    reflectance: Texture::Constant([0.5; 3]),
                },
                place: draft.place.clone(),
            });
            MaterialId(self.materials.len() - 1)
        });
        Ok(Material::Made(id))
    }

    /// Adds what a shape is: a surface if it has matter or light, a boundary if the medium changes there.
    pub(super) fn shape(&mut self, draft: ShapeDraft, parts: &mut Parts) -> Result<(), SceneError> {
        let sides = Sides {
            inside: self.medium(&draft.inside)?,
            outside: self.medium(&draft.outside)?,
        };
        let material = self.material(&draft)?;
        let emission = self.emission(&draft, &material)?;
        let id = match material {
            Material::Made(id) => Some(id),
            _ => None,
        };
        let visible = id.is_some() || emission.is_some();
        // Leniently, a surface that is not understood still separates its media, or vanishes.
        let separates =
            sides.inside != sides.outside || (!visible && matches!(material, Material::Interface));
        let place = draft.place;
        let surface = |shape, flipped| Surface {
            shape,
            flipped,
            material: id,
            emission,
            place: place.clone(),
        };
        match draft.geometry {
            Geometry::Sphere(sphere, flipped) => {
                if visible {
                    let shape = Shape::Sphere(sphere);
                    parts.surfaces.push(surface(shape, flipped));
                }
                if separates {
                    let shape = Enclosure::Sphere(sphere);
                    parts
                        .boundaries
                        .push(boundary(shape, sides, flipped, place));
                }
            }
            Geometry::Disk(disk, flipped) => {
                if visible {
                    parts.surfaces.push(surface(Shape::Disk(disk), flipped));
                }
                if sides.inside != sides.outside {
                    let message = "a disk cannot separate media: it encloses nothing";
                    self.diagnostics
                        .refuse(SceneError::at(&place, message).help(
                        "write MediumInterface \"\" \"\" before it, or close the shape as one mesh",
                    ))?;
                }
            }
            Geometry::Mesh(mesh) => {
                let plain = mesh.quads.is_empty();
                let parameters = id.is_some_and(|id| self.uses_parameters(id));
                let mut whole = None;
                if visible && plain && (!parameters || mesh.turned.is_empty()) {
                    // Both kinds share the vertices.
                    whole = Some(Arc::new(mesh.triangle_mesh()));
                }
                if separates {
                    let mesh = match &whole {
                        Some(whole) => Arc::clone(whole),
                        None => Arc::new(self.enclosing(&mesh, &place)?),
                    };
                    let shape = Enclosure::TriangleMesh(mesh);
                    parts
                        .boundaries
                        .push(boundary(shape, sides, false, place.clone()));
                }
                if !visible {
                    return Ok(());
                }
                let mesh = if parameters {
                    mesh.with_parameters()
                } else {
                    mesh
                };
                if !mesh.triangles.is_empty() {
                    let triangles = whole.unwrap_or_else(|| Arc::new(mesh.triangle_mesh()));
                    let shape = Shape::TriangleMesh(triangles);
                    parts.surfaces.push(surface(shape, false));
                }
                if !mesh.quads.is_empty() {
                    let shape = Shape::BilinearMesh(Arc::new(mesh.bilinear_mesh()));
                    parts.surfaces.push(surface(shape, false));
                }
            }
        }
        Ok(())
    }

    /// The triangles that a mesh encloses a medium with.
    fn enclosing(&mut self, mesh: &Mesh, place: &Place) -> Result<TriangleMesh, SceneError> {
        let indices = match mesh.flattened() {
            Ok(indices) => indices,
            Err(patch) => {
                let message = format!(
                    "the medium changes at a bent surface: patch {patch} of this mesh is not planar"
                );
                self.diagnostics.refuse(
                    SceneError::at(place, message).help("cut its patches into triangles"),
                )?;
                mesh.halved()
            }
        };
        Ok(TriangleMesh {
            positions: mesh.positions.clone(),
            indices,
            ..TriangleMesh::default()
        })
    }

    /// Whether what a material does depends on (u, v).
    fn uses_parameters(&self, id: MaterialId) -> bool {
        match self.materials.get(id.0).map(|m| &m.kind) {
            Some(MaterialKind::Diffuse { reflectance }) => varies(reflectance),
            Some(
                MaterialKind::Dielectric { alpha, .. } | MaterialKind::Conductor { alpha, .. },
            ) => alpha[0] != alpha[1],
            _ => false,
        }
    }

    /// The radiance of a shape's light.
    fn emission(
        &mut self,
        draft: &ShapeDraft,
        material: &Material,
    ) -> Result<Option<AreaEmission>, SceneError> {
        let Some(light) = &draft.light else {
            return Ok(None);
        };
        if matches!(material, Material::Interface) {
            let message = "this shape shines although it has no matter; pbrt would leave it dark";
            self.diagnostics.warn(
                SceneError::at(&draft.place, message).note(&light.place, "this makes it shine"),
            );
        }
        let mut radiance = light.radiance;
        if let Some(power) = light.power {
            let Some(area) = area(&draft.geometry) else {
                let message = "the \"power\" of a stretched sphere's light is not yet supported";
                self.diagnostics.refuse(
                    SceneError::at(&draft.place, message)
                        .note(&light.place, "its power is given here")
                        .help("give \"L\", or scale the sphere alike in all directions"),
                )?;
                return Ok(None);
            };
            if let Geometry::Mesh(mesh) = &draft.geometry
                && mesh.triangles.len() + mesh.quads.len() > 1
            {
                let message = "\"power\" is that of the whole mesh; pbrt gives it to each face";
                self.diagnostics
                    .warn(SceneError::at(&light.place, message).note(&draft.place, "the mesh"));
            }
            // Lambert's law: radiance L through area A sends out π L A.
            let sides = if light.two_sided { 2.0 } else { 1.0 };
            radiance = radiance.map(|c| c * power / (PI * area * sides));
        }
        if !radiance.iter().all(|c| (*c as f32).is_finite()) {
            let message = format!("the light of this shape is too bright: {radiance:?}");
            return Err(SceneError::at(&draft.place, message)
                .note(&light.place, "its light is described here"));
        }
        Ok(Some(AreaEmission {
            radiance,
            two_sided: light.two_sided,
        }))
    }
}

fn boundary(shape: Enclosure, sides: Sides, flipped: bool, place: Place) -> Boundary {
    let Sides { inside, outside } = sides;
    let (inside, outside) = if flipped {
        (outside, inside)
    } else {
        (inside, outside)
    };
    Boundary {
        shape,
        inside,
        outside,
        place,
    }
}

fn varies(texture: &Texture) -> bool {
    match texture {
        Texture::Constant(_) => false,
        Texture::Scale(a, b) => varies(a) || varies(b),
        Texture::Image(_) => true,
    }
}

/// The area of a shape in the world \[length²\]; `None` for ellipsoids, which have no closed form.
fn area(geometry: &Geometry) -> Option<f64> {
    match geometry {
        Geometry::Sphere(sphere, _) => {
            let m = sphere.object_to_world.matrix3;
            let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
            let square = x.length_squared();
            let off = x.dot(y).abs().max(y.dot(z).abs()).max(z.dot(x).abs());
            let uneven = (y.length_squared() - square)
                .abs()
                .max((z.length_squared() - square).abs());
            let similar = off.max(uneven) <= 1e-9 * square;
            similar.then_some(4.0 * PI * sphere.radius * sphere.radius * square)
        }
        Geometry::Disk(disk, _) => {
            let m = disk.object_to_world.matrix3;
            let stretched = m.x_axis.cross(m.y_axis).length();
            let Disk {
                radius,
                inner_radius,
                ..
            } = disk;
            Some(PI * (radius - inner_radius) * (radius + inner_radius) * stretched)
        }
        Geometry::Mesh(mesh) => Some(mesh.area()),
    }
}

/// What a boundary of an object takes once more for an instance, about \[bytes\].
pub(super) fn size(boundary: &Boundary) -> u64 {
    let mesh = match &boundary.shape {
        Enclosure::Sphere(_) => 0,
        Enclosure::TriangleMesh(mesh) => 24 * mesh.positions.len() + 12 * mesh.indices.len(),
    };
    (size_of::<Boundary>() + mesh) as u64
}

/// A boundary of an object, where an instance places it.
///
/// # Errors
/// Vertices that are no longer finite.
pub(super) fn placed(boundary: &Boundary, instance: &Instance) -> Result<Boundary, SceneError> {
    let to_world = &instance.object_to_world;
    let shape = match &boundary.shape {
        Enclosure::Sphere(sphere) => Enclosure::Sphere(Sphere {
            object_to_world: *to_world * sphere.object_to_world,
            ..*sphere
        }),
        Enclosure::TriangleMesh(mesh) if *to_world == DAffine3::IDENTITY => {
            Enclosure::TriangleMesh(Arc::clone(mesh))
        }
        Enclosure::TriangleMesh(mesh) => {
            let moved = |p: &DVec3| to_world.transform_point3(*p);
            let positions: Vec<DVec3> = mesh.positions.iter().map(moved).collect();
            if !positions.iter().all(|p| p.as_vec3().is_finite()) {
                let message = "a vertex of this instance is not finite in the world";
                return Err(
                    SceneError::at(&instance.place, message).note(&boundary.place, "of this shape")
                );
            }
            let mut indices = mesh.indices.clone();
            // A mirror turns the order of corners around, but not what is outside.
            if to_world.matrix3.determinant() < 0.0 {
                indices.iter_mut().for_each(|triangle| triangle.swap(1, 2));
            }
            Enclosure::TriangleMesh(Arc::new(TriangleMesh {
                positions,
                indices,
                ..TriangleMesh::default()
            }))
        }
    };
    Ok(Boundary {
        shape,
        place: boundary.place.clone(),
        ..*boundary
    })
}
