//! Materials and textures.

use std::path::Path;

use woodcock_host::scene::{Encoding, Filter, ImageMap, MaterialKind, Scene, Texture, Wrap};

use super::{world, world_with};

fn kind(scene: &Scene, surface: usize) -> &MaterialKind {
    let id = scene.surfaces[surface].material.expect("a material");
    &scene.materials[id.0].kind
}

fn reflectance(scene: &Scene, surface: usize) -> &Texture {
    match kind(scene, surface) {
        MaterialKind::Diffuse { reflectance } => reflectance,
        other => panic!("not diffuse: {other:?}"),
    }
}

fn constant(texture: &Texture) -> [f64; 3] {
    match texture {
        Texture::Constant(rgb) => *rgb,
        other => panic!("not constant: {other:?}"),
    }
}

fn image(texture: &Texture) -> &ImageMap {
    match texture {
        Texture::Image(image) => image,
        other => panic!("no picture: {other:?}"),
    }
}

#[test]
fn diffuse_is_the_default() {
    let scene = world(
        r#"Shape "sphere" Shape "sphere" Material "diffuse" Shape "sphere"
        Material "diffuse" "rgb reflectance" [1 0 .25] Shape "sphere"
        Material "diffuse" "spectrum reflectance" [300 .4 800 .4] Shape "sphere"
        NamedMaterial "later" Shape "sphere"
        MakeNamedMaterial "later" "string type" "diffuse" "rgb reflectance" [.1 .2 .3]"#,
    );
    let expected = [
        [0.5; 3],
        [0.5; 3],
        [0.5; 3],
        [1.0, 0.0, 0.25],
        [0.4; 3],
        [0.1, 0.2, 0.3],
    ];
    for (i, expected) in expected.into_iter().enumerate() {
        assert_eq!(constant(reflectance(&scene, i)), expected, "{i}");
    }
    assert_eq!(scene.surfaces[0].material, scene.surfaces[1].material);
}

#[test]
fn dielectrics_have_one_index_and_remapped_roughness() {
    let scene = world(
        r#"Material "dielectric" Shape "sphere"
        Material "dielectric" "float eta" 1.33 "float roughness" 0.25 Shape "sphere"
        Material "dielectric" "spectrum eta" "glass-BK7" "float roughness" 0.5 "float vroughness" 0.04
            "bool remaproughness" false Shape "sphere"
        Material "dielectric" "spectrum eta" [360 2 830 2] Shape "sphere"
        Material "thindielectric" "float eta" 1.2 Shape "sphere"
        Texture "r" "float" "constant" "float value" 0.16
        Material "dielectric" "texture roughness" "r" Shape "sphere""#,
    );
    let expected = [
        (1.5, [0.0, 0.0]),
        (1.33, [0.5, 0.5]),
        (1.5168, [0.5, 0.04]),
        (2.0, [0.0, 0.0]),
    ];
    for (i, expected) in expected.into_iter().enumerate() {
        let MaterialKind::Dielectric { eta, alpha } = kind(&scene, i) else {
            panic!("dielectric {i}")
        };
        assert_eq!((*eta, *alpha), expected, "{i}");
    }
    assert!(matches!(kind(&scene, 4), MaterialKind::ThinDielectric { eta } if *eta == 1.2));
    assert!(
        matches!(kind(&scene, 5), MaterialKind::Dielectric { alpha, .. } if *alpha == [0.4; 2])
    );
    assert_eq!(scene.warnings.len(), 1, "no dispersion");
}

#[test]
fn conductors_are_copper_unless_they_say_otherwise() {
    let scene = world(
        r#"Material "conductor" Shape "sphere"
        Material "conductor" "spectrum eta" "metal-Cu-eta" "spectrum k" "metal-Cu-k" Shape "sphere"
        Material "conductor" "rgb eta" [.2 .9 1.1] "spectrum k" [300 3 900 3] "float roughness" .09 Shape "sphere"
        Material "conductor" "rgb reflectance" [.5 .25 1] Shape "sphere""#,
    );
    let optics = |i: usize| match kind(&scene, i) {
        MaterialKind::Conductor { eta, k, alpha } => (*eta, *k, *alpha),
        other => panic!("{other:?}"),
    };
    assert_eq!(optics(0), optics(1));
    assert_eq!(optics(2), ([0.2, 0.9, 1.1], [3.0; 3], [0.09_f64.sqrt(); 2]));
    // The reflectance head-on is what was asked for: k² / (4 + k²) where the index is one.
    let (eta, k, _) = optics(3);
    assert_eq!(eta, [1.0; 3]);
    for (k, expected) in k.iter().zip([0.5, 0.25, 0.9999]) {
        assert!((k * k / (4.0 + k * k) - expected).abs() < 1e-12, "{k}");
    }
}

#[test]
fn pictures_lie_as_told() {
    let scene = world_with(
        &["a.png", "b.exr"],
        r#"Texture "plain" "spectrum" "imagemap" "string filename" "a.png"
        Texture "all" "spectrum" "imagemap" "string filename" "b.exr" "string filter" "point" "string wrap" "clamp"
            "string encoding" "gamma 2.2" "float scale" .5 "bool invert" true
            "float uscale" 2 "float vscale" 3 "float udelta" .25 "float vdelta" -1 "string mapping" "uv"
        Texture "fine" "spectrum" "imagemap" "string filename" "a.png" "string filter" "trilinear"
            "string encoding" "linear" "string wrap" "black"
        Material "diffuse" "texture reflectance" "plain" Shape "sphere"
        Material "diffuse" "texture reflectance" "all" Shape "sphere"
        Material "diffuse" "texture reflectance" "fine" Shape "sphere""#,
    );
    let plain = image(reflectance(&scene, 0));
    assert_eq!(plain.filename, Path::new("a.png"));
    assert_eq!(
        (plain.filter, plain.wrap, plain.encoding),
        (Filter::Bilinear, Wrap::Repeat, None)
    );
    assert_eq!(
        (plain.scale, plain.invert, plain.mapping),
        (1.0, false, [1.0, 1.0, 0.0, 0.0])
    );
    let all = image(reflectance(&scene, 1));
    assert_eq!((all.filter, all.wrap), (Filter::Point, Wrap::Clamp));
    assert_eq!(all.encoding, Some(Encoding::Gamma(2.2)));
    assert_eq!(
        (all.scale, all.invert, all.mapping),
        (0.5, true, [2.0, 3.0, 0.25, -1.0])
    );
    let fine = image(reflectance(&scene, 2));
    assert_eq!((fine.filter, fine.wrap), (Filter::Bilinear, Wrap::Black));
    assert_eq!(fine.encoding, Some(Encoding::Linear));
    assert_eq!(scene.warnings.len(), 1, "trilinear");
}

#[test]
fn textures_scale_each_other() {
    let scene = world_with(
        &["a.png"],
        r#"Texture "half" "float" "constant" "float value" .5
        Texture "quarter" "float" "scale" "texture tex" "half" "texture scale" "half"
        Texture "c" "spectrum" "constant" "rgb value" [.4 .8 1]
        Texture "d" "spectrum" "scale" "texture tex" "c" "texture scale" "quarter"
        Texture "i" "spectrum" "imagemap" "string filename" "a.png"
        Texture "j" "spectrum" "scale" "texture tex" "i" "float scale" .5
        Texture "white" "spectrum" "constant"
        Material "diffuse" "texture reflectance" "d" Shape "sphere"
        Material "diffuse" "texture reflectance" "j" Shape "sphere"
        Material "diffuse" "texture reflectance" "white" Shape "sphere""#,
    );
    assert_eq!(constant(reflectance(&scene, 0)), [0.1, 0.2, 0.25]);
    let Texture::Scale(a, b) = reflectance(&scene, 1) else {
        panic!("a product")
    };
    assert_eq!(image(a).filename, Path::new("a.png"));
    assert_eq!(constant(b), [0.5; 3]);
    assert_eq!(constant(reflectance(&scene, 2)), [1.0; 3]);
}
