//! Where rays meet surfaces, and how points on them are sampled.

mod closed_forms;
mod dd;
mod emitters;
mod leaving;
mod quadrature;
mod traversal;

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec2, DVec3};
use woodcock_host::ray::Ray;
use woodcock_host::scene::{
    self, AreaEmission, BilinearMesh, Disk, Instance, MaterialId, MemoryFiles, Object, Options,
    Place, Scene, Shape, Source, Sphere, Surface, TriangleMesh,
};
use woodcock_host::surface::Surfaces;
use woodcock_tests::stats::independent::SplitMix;

/// A scene without anything.
fn empty() -> Scene {
    let text = "Film \"rgb\" \"integer xresolution\" 1 \"integer yresolution\" 1\n\
                Camera \"perspective\"\nWorldBegin\n";
    let files = MemoryFiles::new().with("t.pbrt", text);
    scene::read(Path::new("t.pbrt"), &files, &Options::default()).expect("an empty scene")
}

fn place() -> Place {
    Place::new(&Source::new("t", Vec::new()), 0, 0)
}

/// A surface of some material.
fn matter(shape: Shape) -> Surface {
    Surface {
        shape,
        flipped: false,
        material: Some(MaterialId(0)),
        emission: None,
        place: place(),
    }
}

/// A surface that shines with radiance 1 and lets light pass.
fn lamp(shape: Shape) -> Surface {
    Surface {
        material: None,
        emission: Some(AreaEmission {
            radiance: [1.0; 3],
            two_sided: false,
        }),
        ..matter(shape)
    }
}

fn ready(surfaces: Vec<Surface>) -> Surfaces {
    let scene = Scene {
        surfaces,
        ..empty()
    };
    Surfaces::new(&scene, DVec3::ZERO).expect("surfaces")
}

/// Objects, which of them stand where, and what stands beside them.
fn instanced(
    objects: Vec<Vec<Surface>>,
    instances: &[(usize, DAffine3)],
    surfaces: Vec<Surface>,
) -> Surfaces {
    let scene = Scene {
        surfaces,
        objects: objects
            .into_iter()
            .map(|surfaces| Object {
                name: "o".into(),
                surfaces,
            })
            .collect(),
        instances: instances
            .iter()
            .map(|&(object, object_to_world)| Instance {
                object,
                object_to_world,
                place: place(),
            })
            .collect(),
        ..empty()
    };
    Surfaces::new(&scene, DVec3::ZERO).expect("surfaces")
}

fn triangles(positions: Vec<DVec3>, indices: Vec<[u32; 3]>) -> Shape {
    Shape::TriangleMesh(Arc::new(TriangleMesh {
        positions,
        indices,
        ..TriangleMesh::default()
    }))
}

fn triangle(corners: [DVec3; 3]) -> Shape {
    triangles(corners.to_vec(), vec![[0, 1, 2]])
}

fn bilinear(corners: [DVec3; 4]) -> Shape {
    Shape::BilinearMesh(Arc::new(BilinearMesh {
        positions: corners.to_vec(),
        indices: vec![[0, 1, 2, 3]],
        ..BilinearMesh::default()
    }))
}

fn sphere(radius: f64, object_to_world: DAffine3) -> Shape {
    Shape::Sphere(Sphere {
        radius,
        object_to_world,
    })
}

fn disk(radius: f64, inner_radius: f64, height: f64, object_to_world: DAffine3) -> Shape {
    Shape::Disk(Disk {
        height,
        radius,
        inner_radius,
        object_to_world,
    })
}

fn uniform(rng: &mut SplitMix, low: f64, high: f64) -> f64 {
    low + (high - low) * rng.uniform()
}

fn within(rng: &mut SplitMix, half: f64) -> DVec3 {
    DVec3::new(
        uniform(rng, -half, half),
        uniform(rng, -half, half),
        uniform(rng, -half, half),
    )
}

fn direction(rng: &mut SplitMix) -> DVec3 {
    DVec3::new(rng.normal(), rng.normal(), rng.normal()).normalize()
}

fn rotation(rng: &mut SplitMix) -> DAffine3 {
    let axis = direction(rng);
    DAffine3::from_quat(DQuat::from_axis_angle(axis, uniform(rng, 0.0, 6.0)))
}

/// A ray towards a place.
fn towards(origin: DVec3, target: DVec3) -> Ray {
    Ray {
        origin,
        direction: (target - origin).normalize(),
    }
}

/// The map of a shape's own space that is neither rigid nor uniform.
fn skewed(rng: &mut SplitMix) -> DAffine3 {
    let stretch = DAffine3::from_scale(DVec3::new(
        uniform(rng, 0.3, 2.0),
        uniform(rng, 0.3, 2.0),
        -uniform(rng, 0.3, 2.0),
    ));
    rotation(rng) * stretch * rotation(rng)
}
