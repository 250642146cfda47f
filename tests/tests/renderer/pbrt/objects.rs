//! Objects and their instances.

use glam::DVec3;
use woodcock_host::scene::{Enclosure, MemoryFiles, Options, Scene, Shape, read};

use super::world;

const FOG: &str = "MakeNamedMedium \"m\" \"string type\" \"homogeneous\"";

fn sphere_centres(scene: &Scene) -> Vec<DVec3> {
    let centre = |i: usize| super::centre(scene, i);
    (0..scene.boundaries.len()).map(centre).collect()
}

#[test]
fn instances_are_on_top_of_the_object() {
    let scene = world(&format!(
        "{FOG} Translate 1 0 0 ObjectBegin \"o\" Translate 0 1 0 MediumInterface \"m\" \"\" Shape \"sphere\" ObjectEnd
        Material \"interface\" MediumInterface \"m\" \"\" Shape \"sphere\" MediumInterface \"\" \"\"
        Identity Rotate 90 0 0 1 ObjectInstance \"o\" Translate 0 0 5 ObjectInstance \"o\""
    ));
    let [object] = scene.objects.as_slice() else {
        panic!("one object")
    };
    assert_eq!((object.name.as_str(), object.surfaces.len()), ("o", 1));
    let Shape::Sphere(sphere) = &object.surfaces[0].shape else {
        panic!("a sphere")
    };
    assert_eq!(
        sphere.object_to_world.translation,
        DVec3::new(1.0, 1.0, 0.0)
    );
    assert!(
        object.surfaces[0].material.is_some(),
        "the material at its definition"
    );
    assert!(
        scene.surfaces.is_empty(),
        "objects are only where they are placed"
    );
    assert_eq!(scene.instances.len(), 2);
    let second = &scene.instances[1];
    assert_eq!(second.object, 0);
    let moved = second
        .object_to_world
        .transform_point3(DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(moved, DVec3::new(-1.0, 1.0, 5.0));
    // Boundaries: the plain one first, as in the file, then a copy per instance.
    let expected = [
        DVec3::new(1.0, 0.0, 0.0),
        DVec3::new(-1.0, 1.0, 0.0),
        DVec3::new(-1.0, 1.0, 5.0),
    ];
    assert_eq!(sphere_centres(&scene), expected);
    assert!(
        scene
            .boundaries
            .iter()
            .all(|b| b.inside.is_some() && b.outside.is_none())
    );
}

#[test]
fn mirrored_instances_keep_their_inside() {
    let tetrahedron = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1] \
        \"integer indices\" [0 2 1 0 1 3 0 3 2 1 2 3]";
    let scene = world(&format!(
        "{FOG} MediumInterface \"m\" \"\" Material \"interface\" ObjectBegin \"o\" {tetrahedron} ObjectEnd
        ObjectInstance \"o\" Scale -2 1 1 ObjectInstance \"o\""
    ));
    let volume = |i: usize| -> f64 {
        let Enclosure::TriangleMesh(mesh) = &scene.boundaries[i].shape else {
            panic!("a mesh")
        };
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            a.dot(b.cross(c))
        };
        mesh.indices.iter().map(of).sum()
    };
    assert_eq!((volume(0), volume(1)), (1.0, 2.0));
    assert!(scene.objects[0].surfaces.is_empty(), "nothing to see");
}

#[test]
fn copies_are_bounded() {
    let points = "0 0 0 ".repeat(1000);
    let instances = "ObjectInstance \"o\" ".repeat(1000);
    let scene = format!(
        "WorldBegin {FOG} MediumInterface \"m\" \"\" ObjectBegin \"o\" Translate 1 0 0 Shape \"trianglemesh\"
        \"point3 P\" [{points}] \"integer indices\" [0 1 2] ObjectEnd Scale 2 1 1\n{instances}"
    );
    let options = Options {
        lenient: false,
        max_memory: 1 << 20,
    };
    let files = MemoryFiles::new().with("s.pbrt", scene);
    let error = read("s.pbrt".as_ref(), &files, &options)
        .map(|_| ())
        .expect_err("a thousand times 24 kB");
    assert!(error.to_string().starts_with("s.pbrt:3:"), "{error}");
    assert!(error.message().contains("copied"), "{error}");
    // Vertices that are inherited by many shapes.
    let shapes = "Shape \"trianglemesh\" ".repeat(1000);
    let scene = format!(
        "WorldBegin Attribute \"shape\" \"point3 P\" [{points}]
        Attribute \"shape\" \"integer indices\" [0 1 2]\n{shapes}"
    );
    let files = MemoryFiles::new().with("s.pbrt", scene);
    let error = read("s.pbrt".as_ref(), &files, &options)
        .map(|_| ())
        .expect_err("a thousand times 24 kB");
    assert!(error.to_string().starts_with("s.pbrt:3:"), "{error}");
    assert!(error.message().contains("copied"), "{error}");
    // Textures that double each other.
    let mut doubling =
        "WorldBegin Texture \"0\" \"spectrum\" \"imagemap\" \"string filename\" \"s.pbrt\"\n"
            .to_owned();
    for i in 0..40 {
        doubling += &format!(
            "Texture \"{}\" \"spectrum\" \"scale\" \"texture tex\" \"{i}\" \"texture scale\" \"{i}\"\n",
            i + 1
        );
    }
    let files = MemoryFiles::new().with("s.pbrt", doubling);
    let error = read("s.pbrt".as_ref(), &files, &options)
        .map(|_| ())
        .expect_err("2^40 pictures");
    assert!(
        error
            .to_string()
            .starts_with("s.pbrt:7:1: more than 64 textures in one"),
        "{error}"
    );
}
