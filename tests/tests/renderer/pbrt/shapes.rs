//! Shapes: their geometry in the world, which way they face, and what becomes of them.

use glam::{DVec2, DVec3};
use woodcock_host::scene::{Boundary, Enclosure, MemoryFiles, Scene, Shape, TriangleMesh};

use super::{near, read_with, world};

const CUBE: &str = r#""point3 P" [ 0 0 0  1 0 0  1 1 0  0 1 0   0 0 1  1 0 1  1 1 1  0 1 1 ]
    "integer indices" [ 0 2 1  0 3 2  4 5 6  4 6 7  0 1 5  0 5 4  3 7 6  3 6 2  0 4 7  0 7 3  1 2 6  1 6 5 ]"#;
const FOG: &str =
    "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" MediumInterface \"m\" \"\"";

fn mesh(boundary: &Boundary) -> &TriangleMesh {
    match &boundary.shape {
        Enclosure::TriangleMesh(mesh) => mesh,
        Enclosure::Sphere(_) => panic!("not a mesh"),
    }
}

fn surface_mesh(scene: &Scene, i: usize) -> &TriangleMesh {
    match &scene.surfaces[i].shape {
        Shape::TriangleMesh(mesh) => mesh,
        other => panic!("not a mesh: {other:?}"),
    }
}

/// By the divergence theorem: positive where the faces point outwards.
fn volume(mesh: &TriangleMesh) -> f64 {
    let tetrahedron = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    mesh.indices.iter().map(tetrahedron).sum()
}

#[test]
fn triangles_face_outside_under_mirrors_and_normals() {
    let volumes = |text: &str| -> [f64; 2] {
        let scene = world(&format!("{FOG} {text}"));
        let boundary = mesh(&scene.boundaries[0]);
        // Outside stays vacuum: the order of the vertices says it all.
        assert_eq!(scene.boundaries[0].outside, None);
        assert!(!scene.surfaces[0].flipped);
        [volume(boundary), volume(surface_mesh(&scene, 0))]
    };
    let is = |found: [f64; 2], expected: f64| {
        assert!(
            found.iter().all(|v| (v - expected).abs() < 1e-12),
            "{found:?}"
        );
    };
    let cube = format!("Shape \"trianglemesh\" {CUBE}");
    is(volumes(&cube), 1.0);
    is(volumes(&format!("Scale -1 2 1 {cube}")), 2.0);
    is(volumes(&format!("ReverseOrientation {cube}")), -1.0);
    is(
        volumes(&format!("ReverseOrientation Scale -1 2 1 {cube}")),
        -2.0,
    );
    let normals = "-1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1   -1 -1 1  1 -1 1  1 1 1  -1 1 1";
    let swapped = cube.replace("0 2 1  0 3 2", "0 1 2  0 2 3");
    let decided = format!("{swapped} \"normal N\" [ {normals} ]");
    is(volumes(&decided), 1.0);
    is(volumes(&format!("Scale -1 2 1 {decided}")), 2.0);
    is(volumes(&format!("ReverseOrientation {decided}")), -1.0);
}

#[test]
fn shading_normals_go_with_the_surface() {
    let triangle =
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [1 0 1 0 0 1 0 0 1]";
    let scene = world(&format!(
        "Scale 2 1 1 {triangle} Identity ReverseOrientation {triangle}"
    ));
    // A plane x + z = const becomes x / 2 + z = const.
    assert_eq!(
        surface_mesh(&scene, 0).normals[0],
        DVec3::new(0.5, 0.0, 1.0)
    );
    assert_eq!(
        surface_mesh(&scene, 1).normals[0],
        DVec3::new(-1.0, 0.0, -1.0)
    );
    assert_eq!(surface_mesh(&scene, 1).indices, [[0, 2, 1]]);
}

#[test]
fn what_becomes_of_a_shape() {
    let scene = world(&format!(
        "{FOG} Shape \"sphere\" Material \"interface\" Shape \"sphere\" \"float radius\" 2
        MediumInterface \"\" \"\" Shape \"sphere\" \"float radius\" 3
        AreaLightSource \"diffuse\" Shape \"sphere\" \"float radius\" 4
        Material \"diffuse\" Shape \"sphere\" \"float radius\" 5 Shape \"disk\" \"float radius\" 6"
    ));
    let surfaces: Vec<_> = scene
        .surfaces
        .iter()
        .map(|s| {
            let radius = match &s.shape {
                Shape::Sphere(sphere) => sphere.radius,
                Shape::Disk(disk) => disk.radius,
                other => panic!("{other:?}"),
            };
            (radius, s.material.is_some(), s.emission.is_some())
        })
        .collect();
    assert_eq!(
        surfaces,
        [
            (1.0, true, false),
            (4.0, false, true),
            (5.0, true, true),
            (6.0, true, true)
        ]
    );
    let boundaries: Vec<_> = scene
        .boundaries
        .iter()
        .map(|b| {
            let Enclosure::Sphere(sphere) = &b.shape else {
                panic!("not a sphere")
            };
            (sphere.radius, b.is_transition())
        })
        .collect();
    assert_eq!(boundaries, [(1.0, true), (2.0, true), (3.0, false)]);
    assert_eq!(scene.warnings.len(), 1, "pbrt would leave the fourth dark");
}

#[test]
fn spheres_and_disks_remember_that_they_are_turned() {
    let scene = world(
        "Translate 0 0 1 ReverseOrientation Shape \"disk\" \"float height\" 2 \"float innerradius\" .5
        Shape \"sphere\" ReverseOrientation Scale -1 1 1 Shape \"sphere\"",
    );
    let flipped: Vec<bool> = scene.surfaces.iter().map(|s| s.flipped).collect();
    assert_eq!(flipped, [true, true, false], "a mirror keeps the side");
    let Shape::Disk(disk) = &scene.surfaces[0].shape else {
        panic!("a disk")
    };
    assert_eq!(
        (disk.height, disk.radius, disk.inner_radius),
        (2.0, 1.0, 0.5)
    );
    assert_eq!(disk.object_to_world.translation, DVec3::Z);
}

#[test]
fn patches_are_bilinear_and_enclose_as_triangles() {
    let patch = "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 0]";
    let scene = world(&format!(
        "{FOG} {patch} Translate 0 0 1 {patch} \"integer indices\" [0 1 2 3]
        \"point2 uv\" [0 0 4 0 0 4 4 4] Scale 1 1 -1 {patch}"
    ));
    let Shape::BilinearMesh(first) = &scene.surfaces[0].shape else {
        panic!("patches")
    };
    assert_eq!(first.indices, [[0, 1, 2, 3]]);
    let Shape::BilinearMesh(second) = &scene.surfaces[1].shape else {
        panic!("patches")
    };
    assert_eq!(second.uv[3], DVec2::new(4.0, 4.0));
    assert!(near(second.positions[3], [2.0, 1.0, 1.0]));
    let normal = |i: usize| -> DVec3 {
        let mesh = mesh(&scene.boundaries[i]);
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            (b - a).cross(c - a) / 2.0
        };
        mesh.indices.iter().map(area).sum()
    };
    assert_eq!(normal(0), DVec3::new(0.0, 0.0, 2.0));
    assert_eq!(normal(2), DVec3::new(0.0, 0.0, -2.0), "mirrored");
}

#[test]
fn parameters_survive_a_turn() {
    // A mirrored triangle keeps (u, v) at its corners although their order changes, where a picture needs them.
    let text = |material: &str| {
        format!(
            "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\" {material}
            Scale 1 1 -1 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0]
            Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 0]"
        )
    };
    let read = |material: &str| {
        let files = MemoryFiles::new()
            .with("s.pbrt", text(material))
            .with("t.png", "");
        read_with(files, false).expect("a scene")
    };
    assert!(surface_mesh(&read(""), 0).uv.is_empty());
    for material in [
        "Material \"diffuse\" \"texture reflectance\" \"t\"",
        "Material \"conductor\" \"float uroughness\" 0.5",
    ] {
        let scene = read(material);
        let expected = |p: DVec3| match (p.x, p.y) {
            (0.0, 0.0) => DVec2::ZERO,
            (1.0, 0.0) => DVec2::X,
            _ => DVec2::ONE,
        };
        let triangle = surface_mesh(&scene, 0);
        for (p, uv) in triangle.positions.iter().zip(&triangle.uv) {
            assert_eq!(*uv, expected(*p));
        }
        assert_eq!(triangle.uv.len(), 3);
        let Shape::BilinearMesh(patch) = &scene.surfaces[1].shape else {
            panic!("patches")
        };
        assert_eq!(patch.uv.len(), 4);
        for (p, uv) in patch.positions.iter().zip(&patch.uv) {
            assert_eq!(*uv, DVec2::new(p.x / 2.0, p.y));
        }
    }
}

#[test]
fn quadrilaterals_of_files_are_patches() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
        property float s\nproperty float t\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n2 2 0 5 5\n4 0 1 2 3\n3 1 4 2\n";
    let scene = format!("WorldBegin {FOG} Shape \"plymesh\" \"string filename\" \"q.ply\"");
    let files = |ply: &str| {
        MemoryFiles::new()
            .with("s.pbrt", scene.as_str())
            .with("q.ply", ply)
    };
    let scene = read_with(files(ply), false).expect("a scene");
    let [triangles, patches] = scene.surfaces.as_slice() else {
        panic!("two surfaces")
    };
    let Shape::TriangleMesh(triangles) = &triangles.shape else {
        panic!("triangles")
    };
    let Shape::BilinearMesh(patches) = &patches.shape else {
        panic!("patches")
    };
    assert_eq!(triangles.indices, [[1, 4, 2]]);
    assert_eq!(patches.indices, [[0, 1, 3, 2]], "in the order of (u, v)");
    assert_eq!(patches.uv[2], DVec2::ONE);
    assert_eq!(mesh(&scene.boundaries[0]).indices.len(), 3);
    let bent = ply.replace("\n1 1 0 1 1", "\n1 1 .01 1 1");
    let error = read_with(files(&bent), false)
        .map(|_| ())
        .expect_err("bent");
    assert!(
        error
            .to_string()
            .contains("patch 0 of this mesh is not planar"),
        "{error}"
    );
    // Rounding in single precision is not a bend.
    let rounded = ply.replace("\n1 1 0 1 1", "\n1 1 1e-7 1 1");
    assert!(read_with(files(&rounded), false).is_ok());
}
