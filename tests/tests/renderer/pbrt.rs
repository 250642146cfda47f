//! The pbrt reader: what scenes mean, what is said about wrong ones, and that nothing breaks it.

use std::path::Path;

use glam::DVec3;
use woodcock_host::scene::{
    Enclosure, MaterialKind, MediumKind, MemoryFiles, Options, Phase, Projection, Scene,
    SceneError, Texture, read,
};

mod lights;
mod materials;
mod media;
mod objects;
mod shapes;

fn read_with(files: MemoryFiles, lenient: bool) -> Result<Scene, SceneError> {
    let options = Options {
        lenient,
        max_memory: 1 << 24,
    };
    read(Path::new("s.pbrt"), &files, &options)
}

fn try_read(text: &str) -> Result<Scene, SceneError> {
    read_with(MemoryFiles::new().with("s.pbrt", text), false)
}

fn good(text: &str) -> Scene {
    match try_read(text) {
        Ok(scene) => scene,
        Err(error) => panic!("{}", error.report()),
    }
}

fn world(text: &str) -> Scene {
    good(&format!("WorldBegin\n{text}"))
}

fn near(a: DVec3, b: [f64; 3]) -> bool {
    a.abs_diff_eq(b.into(), 1e-12)
}

/// The centre of the `i`th boundary, a sphere.
fn centre(scene: &Scene, i: usize) -> DVec3 {
    match &scene.boundaries[i].shape {
        Enclosure::Sphere(sphere) => sphere.object_to_world.transform_point3(DVec3::ZERO),
        Enclosure::TriangleMesh(_) => panic!("not a sphere"),
    }
}

/// A world with files beside it, all of them empty.
fn world_with(names: &[&str], text: &str) -> Scene {
    let scene = MemoryFiles::new().with("s.pbrt", format!("WorldBegin\n{text}"));
    let files = names
        .iter()
        .fold(scene, |files, name| files.with(*name, ""));
    match read_with(files, false) {
        Ok(scene) => scene,
        Err(error) => panic!("{}", error.report()),
    }
}

#[test]
fn defaults_are_pbrts() {
    let scene = good("WorldBegin");
    assert_eq!((scene.film.width, scene.film.height), (1280, 720));
    assert_eq!(scene.film.filename, "pbrt.exr");
    assert_eq!(scene.film.imaging_ratio, 1.0);
    assert_eq!(
        scene.camera.projection,
        Projection::Perspective { fov: 90.0 }
    );
    assert_eq!(scene.integrator.max_depth, None);
    assert_eq!(scene.samples_per_pixel, None);
    assert!(scene.warnings.is_empty());

    let scene = world(r#"MakeNamedMedium "m" "string type" "homogeneous""#);
    let medium = &scene.media[0];
    assert_eq!((medium.sigma_a, medium.sigma_s), ([1.0; 3], [1.0; 3]));
    assert_eq!(medium.phase, Phase::Isotropic);
}

#[test]
fn the_shorter_axis_spans_the_field_of_view() {
    for (w, h) in [(300, 200), (200, 300), (128, 128)] {
        let scene = good(&format!(
            "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 60
             Film \"rgb\" \"integer xresolution\" {w} \"integer yresolution\" {h} WorldBegin"
        ));
        let (width, height) = (f64::from(w), f64::from(h));
        let ray = |x, y| scene.camera.central_ray(&scene.film, x, y);
        let (origin, middle) = ray(width / 2.0, height / 2.0);
        assert!(near(origin, [0.0, 0.0, -5.0]) && near(middle, [0.0, 0.0, 1.0]));
        let edge = if w < h {
            ray(width, height / 2.0)
        } else {
            ray(width / 2.0, 0.0)
        }
        .1;
        assert!((edge.dot(middle) - 30.0_f64.to_radians().cos()).abs() < 1e-12);
        // Left-handed: x to the right, y up, and rows count downwards.
        assert!(ray(width, height / 2.0).1.x > 0.1 && ray(width / 2.0, 0.0).1.y > 0.1);
    }
}

#[test]
fn cameras_windows_crops_and_exposure() {
    let scene = good(
        r#"Translate 0 0 7
        Camera "orthographic" "float screenwindow" [-1 2 -3 4] "float lensradius" .5
            "float focaldistance" 3 "float shutterclose" 0.25
        Film "rgb" "integer xresolution" 100 "integer yresolution" 50
            "float cropwindow" [0.25 .5 0 1] "float iso" 200 "float diagonal" 35
        Sampler "stratified" "integer xsamples" 3 "integer ysamples" 5 "bool jitter" true
        Integrator "simplevolpath" "integer maxdepth" 7
        WorldBegin"#,
    );
    assert_eq!(scene.film.imaging_ratio, 0.5);
    let crop = scene.film.crop;
    assert_eq!((crop.x0, crop.x1, crop.y0, crop.y1), (25, 50, 0, 50));
    assert_eq!(scene.samples_per_pixel, Some(15));
    assert_eq!(scene.integrator.max_depth, Some(7));
    assert_eq!(
        (scene.camera.lens_radius, scene.camera.focal_distance),
        (0.5, 3.0)
    );
    let (origin, direction) = scene.camera.central_ray(&scene.film, 0.0, 0.0);
    assert!(near(origin, [-1.0, 4.0, -7.0]) && near(direction, [0.0, 0.0, 1.0]));
}

#[test]
fn transformations_compose_as_in_pbrt() {
    let scene = world(
        r#"Material "interface" MakeNamedMedium "m" "string type" "homogeneous"
        MediumInterface "m" ""
        AttributeBegin
            Translate 1 2 3  Scale 2 2 2  Translate 1 0 0  Shape "sphere"
        AttributeEnd
        Shape "sphere"
        Rotate 90 0 0 1  Translate 1 0 0  Shape "sphere"
        CoordinateSystem "here"  Identity  Shape "sphere"
        CoordSysTransform "here"  Shape "sphere"
        Transform [1 0 0 0  0 1 0 0  0 0 1 0  4 5 6 1]  Shape "sphere"
        ConcatTransform [2 0 0 0  0 2 0 0  0 0 2 0  1 0 0 1]  Shape "sphere""#,
    );
    let expected = [
        [3.0, 2.0, 3.0],
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [4.0, 5.0, 6.0],
        [5.0, 5.0, 6.0],
    ];
    for (i, expected) in expected.into_iter().enumerate() {
        assert_eq!(centre(&scene, i), expected.into(), "sphere {i}");
    }
}

#[test]
fn the_camera_is_a_coordinate_system() {
    let scene = good(
        r#"LookAt 1 2 3  4 5 6  0 1 0 Camera "perspective" WorldBegin
        Material "interface" MakeNamedMedium "m" "string type" "homogeneous"
        CoordSysTransform "camera" MediumInterface "m" "" Shape "sphere"
        CoordSysTransform "world" Shape "sphere""#,
    );
    assert!(near(centre(&scene, 0), [1.0, 2.0, 3.0]));
    assert!(near(centre(&scene, 1), [0.0, 0.0, 0.0]));
}

#[test]
fn attributes_save_everything_and_apply_behind_what_is_given() {
    let scene = world(
        r#"MakeNamedMedium "a" "string type" "homogeneous" Material "interface"
        MakeNamedMaterial "clear" "string type" "interface"
        AttributeBegin
            MediumInterface "a" "b"  ReverseOrientation  Attribute "shape" "float radius" 3
            Shape "sphere"
            Shape "sphere" "float radius" 2
        AttributeEnd
        MediumInterface "b" "" NamedMaterial "clear" Shape "sphere"
        Attribute "medium" "float g" 0.5
        MakeNamedMedium "b" "string type" "homogeneous""#,
    );
    let radius = |i: usize| match &scene.boundaries[i].shape {
        Enclosure::Sphere(sphere) => sphere.radius,
        Enclosure::TriangleMesh(_) => panic!("not a sphere"),
    };
    assert_eq!([radius(0), radius(1), radius(2)], [3.0, 2.0, 1.0]);
    let name = |id| scene.medium(id).map_or("", |m| m.name.as_str());
    let [first, _, last] = scene.boundaries.as_slice() else {
        panic!("three boundaries");
    };
    assert_eq!(first.inside.map(name), Some("b"), "reversed");
    assert_eq!(first.outside.map(name), Some("a"));
    assert_eq!(last.inside.map(name), Some("b"), "defined after use");
    assert_eq!(last.outside, None);
    assert_eq!(scene.media[1].phase, Phase::HenyeyGreenstein { g: 0.5 });
}

#[test]
fn the_camera_takes_the_outside_medium() {
    let scene = good(
        r#"MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [1 2 3] "float scale" 2
        MediumInterface "" "fog" Camera "perspective" WorldBegin"#,
    );
    assert_eq!(scene.camera_medium, Some(woodcock_host::scene::MediumId(0)));
    assert_eq!(scene.media[0].sigma_s, [2.0, 4.0, 6.0]);
    assert_eq!(scene.media[0].sigma_a, [2.0; 3]);
}

#[test]
fn integrators_by_their_names() {
    for (given, ours, warnings) in [
        ("volpath", "path", 0),
        ("simplevolpath", "path", 0),
        ("path", "path", 1),
        ("simplepath", "path", 1),
        ("bdpt", "bdpt", 0),
        ("mlt", "mlt", 0),
        ("single", "single", 0),
        ("transmittance", "transmittance", 0),
    ] {
        let options =
            "\"integer maxdepth\" 7 \"string lightsampler\" \"power\" \"bool regularize\" false";
        let scene = good(&format!("Integrator \"{given}\" {options} WorldBegin"));
        assert_eq!(
            (scene.integrator.name.as_str(), scene.integrator.max_depth),
            (ours, Some(7))
        );
        assert_eq!(scene.warnings.len(), warnings, "{given}");
    }
    let scene = good(
        r#"Integrator "mlt" "integer bootstrapsamples" 10 "integer chains" 5 "integer mutationsperpixel" 100
        "float largestepprobability" .3 "float sigma" .01 WorldBegin"#,
    );
    assert_eq!(scene.integrator.max_depth, None);
    assert_eq!(scene.warnings.len(), 5);
}

#[test]
fn places_outlive_large_files() {
    // Beyond a mebibyte the text goes, but every place still says where it was.
    let padding = format!("#{}\n", " ".repeat(1 << 21));
    let text = format!(
        "WorldBegin\n{padding}Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"s.pbrt\"
        Material \"diffuse\" \"texture reflectance\" \"t\"\n Shape \"sphere\" ObjectBegin \"o\" Shape \"sphere\" ObjectEnd
        ObjectInstance \"o\" LightSource \"point\" MakeNamedMedium \"m\" \"string type\" \"homogeneous\""
    );
    let scene = good(&text);
    let Some(material) = scene.materials.first() else {
        panic!("a material")
    };
    let mut places = vec![
        &material.place,
        &scene.surfaces[0].place,
        &scene.objects[0].surfaces[0].place,
        &scene.instances[0].place,
        scene.lights[0].place(),
        &scene.media[0].place,
    ];
    match &material.kind {
        MaterialKind::Diffuse {
            reflectance: Texture::Image(image),
        } => places.push(&image.place),
        other => panic!("{other:?}"),
    }
    let lines = [4, 5, 5, 6, 6, 6, 3];
    for (place, line) in places.into_iter().zip(lines) {
        assert!(place.source().bytes().len() < 1 << 10, "{place}");
        assert!(
            place.to_string().starts_with(&format!("s.pbrt:{line}:")),
            "{place}"
        );
    }
}

#[test]
fn included_files_share_the_state_and_imported_ones_do_not() {
    let files = MemoryFiles::new()
        .with("d/s.pbrt", "Include \"sub/head.pbrt\" WorldBegin Material \"interface\"
            MediumInterface \"m\" \"\" Import \"body.pbrt\" Shape \"sphere\" Include \"z.pbrt.gz\"")
        .with("d/sub/head.pbrt", "MakeNamedMedium \"m\" \"string type\" \"openvdb\" \"string filename\" \"c.vdb\"")
        .with("d/body.pbrt", "Translate 1 0 0 Shape \"plymesh\" \"string filename\" \"t.ply\" Shape \"sphere\"")
        .with("d/c.vdb", "")
        .with("d/t.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
            element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n")
        .with("d/z.pbrt.gz", gzip(b"Shape \"sphere\" \"float radius\" 9\n"));
    let scene = match read(Path::new("d/s.pbrt"), &files, &Options::default()) {
        Ok(scene) => scene,
        Err(error) => panic!("{}", error.report()),
    };
    assert_eq!(scene.boundaries.len(), 4);
    assert_eq!(centre(&scene, 1), DVec3::X);
    assert_eq!(centre(&scene, 2), DVec3::ZERO);
    let MediumKind::OpenVdb(vdb) = &scene.media[0].kind else {
        panic!("a VDB");
    };
    assert_eq!(
        vdb.filename,
        Path::new("d/c.vdb"),
        "relative to the main file"
    );
    assert_eq!(vdb.gridname, "density");
}

/// A gzip file of one stored block.
fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut crc = !0_u32;
    for &byte in bytes {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
        }
    }
    let length = bytes.len() as u16;
    let mut file = vec![0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255, 1];
    file.extend(length.to_le_bytes());
    file.extend((!length).to_le_bytes());
    file.extend(bytes);
    file.extend((!crc).to_le_bytes());
    file.extend(u32::from(length).to_le_bytes());
    file
}

#[test]
fn the_example_scenes_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/scenes");
    let vdb = folder.join("../../tests/data/vdb/cumulus_240.vdb");
    for name in ["fog-sphere", "cumulus", "uniformgrid"] {
        let path = folder.join(name).with_extension("pbrt");
        let text = std::fs::read(&path).expect("the scene is there");
        let files = MemoryFiles::new().with(&path, text).with(&vdb, "");
        match read(&path, &files, &Options::default()) {
            Ok(scene) => {
                assert!(scene.warnings.is_empty());
                assert_eq!((scene.media.len(), scene.lights.len()), (1, 2));
                assert_eq!(scene.boundaries.len(), 1);
            }
            Err(error) => panic!("{}", error.report()),
        }
    }
}
