//! Media: where their density comes from, how they scatter, and what they send out.

use std::path::Path;

use glam::DVec3;
use woodcock_host::scene::{
    Emission, MediumKind, NamedMedium, Phase, Scene, Temperature, TemperatureValues,
    blackbody_peak_one,
};

use super::{world, world_with};

fn only(scene: &Scene) -> &NamedMedium {
    let [medium] = scene.media.as_slice() else {
        panic!("one medium")
    };
    medium
}

fn medium(parameters: &str) -> Scene {
    world_with(
        &["a.vdb", "a.nvdb", "a.vol", "b.vol"],
        &format!("MakeNamedMedium \"m\" \"string type\" {parameters}"),
    )
}

#[test]
fn grids_are_x_fastest_in_their_own_box() {
    let scene = world(
        r#"Translate 1 0 0 MakeNamedMedium "g" "string type" "uniformgrid"
        "integer nx" 3 "integer ny" 2 "integer nz" 1 "float density" [0 1 2 3 4 5]
        "point3 p0" [1 1 1] "point3 p1" [-1 0 0] "spectrum sigma_s" [200 10 900 10]"#,
    );
    let medium = &scene.media[0];
    let MediumKind::UniformGrid(grid) = &medium.kind else {
        panic!("a grid");
    };
    assert_eq!(grid.resolution, [3, 2, 1]);
    assert_eq!(grid.density, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!((grid.p0, grid.p1), (DVec3::new(-1.0, 0.0, 0.0), DVec3::ONE));
    assert_eq!(
        medium.sigma_s, [10.0; 3],
        "a constant spectrum is exactly grey"
    );
    assert_eq!(medium.medium_to_world.translation, DVec3::X);
    assert!(scene.warnings.is_empty());
}

#[test]
fn colours_by_voxel() {
    let scene = medium(
        r#""rgbgrid" "integer nz" 2 "rgb sigma_a" [1 2 3 4 5 6] "rgb Le" [0 0 1 7 8 9] "float Lescale" 3
        "float scale" 10 "point3 p1" [2 2 2] "float g" .5"#,
    );
    let medium = only(&scene);
    let MediumKind::RgbGrid(grid) = &medium.kind else {
        panic!("a grid")
    };
    assert_eq!(grid.resolution, [1, 1, 2]);
    assert_eq!(
        grid.sigma_a.as_deref(),
        Some(&[[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]][..])
    );
    assert_eq!(grid.sigma_s, None, "one everywhere");
    assert_eq!(
        grid.le.as_deref(),
        Some(&[[0.0, 0.0, 1.0], [7.0, 8.0, 9.0]][..])
    );
    assert_eq!((grid.p0, grid.p1), (DVec3::ZERO, DVec3::splat(2.0)));
    assert_eq!((medium.sigma_a, medium.sigma_s), ([10.0; 3], [10.0; 3]));
    assert_eq!(medium.emission.as_ref().map(|e| e.scale), Some(3.0));
    let dark = world(
        r#"MakeNamedMedium "m" "string type" "rgbgrid" "rgb sigma_a" [1 1 1] "rgb Le" [1 1 1] "float Lescale" 0"#,
    );
    assert_eq!(only(&dark).emission, None);
}

#[test]
fn clouds_and_files() {
    let scene = medium(r#""cloud" "float density" 4 "float wispiness" 2"#);
    let MediumKind::Cloud(cloud) = only(&scene).kind else {
        panic!("a cloud")
    };
    assert_eq!(
        (cloud.density, cloud.wispiness, cloud.frequency),
        (4.0, 2.0, 5.0)
    );
    assert_eq!((cloud.p0, cloud.p1), (DVec3::ZERO, DVec3::ONE));
    let scene = medium(r#""nanovdb" "string filename" "a.nvdb""#);
    let MediumKind::NanoVdb(file) = &only(&scene).kind else {
        panic!("a file")
    };
    assert_eq!(
        (file.filename.as_path(), file.gridname.as_str()),
        (Path::new("a.nvdb"), "density")
    );
    assert_eq!(
        only(&scene).emission,
        None,
        "nobody asked for its temperature"
    );
    let scene = medium(r#""vol" "string filename" "a.vol" "string albedofilename" "b.vol""#);
    let MediumKind::Vol(file) = &only(&scene).kind else {
        panic!("a file")
    };
    assert_eq!(file.albedo.as_deref(), Some(Path::new("b.vol")));
}

#[test]
fn measured_materials_by_name() {
    // Jensen and others 2001, table 2; per millimetre.
    let scene = medium(r#""homogeneous" "string preset" "Marble" "float scale" 10"#);
    let marble = only(&scene);
    let near = |found: [f64; 3], table: [f64; 3]| {
        found
            .iter()
            .zip(table)
            .all(|(f, t)| (f - 10.0 * t).abs() < 1e-12)
    };
    assert!(near(marble.sigma_s, [2.19, 2.62, 3.00]));
    assert!(near(marble.sigma_a, [0.0021, 0.0041, 0.0071]));
}

#[test]
fn phase_functions_by_name() {
    let of = |parameters: &str| only(&medium(&format!("\"homogeneous\" {parameters}"))).phase;
    assert_eq!(of(""), Phase::Isotropic);
    assert_eq!(of("\"float g\" -.5"), Phase::HenyeyGreenstein { g: -0.5 });
    assert_eq!(
        of("\"float g\" .5 \"string phase\" \"hg\""),
        Phase::HenyeyGreenstein { g: 0.5 }
    );
    assert_eq!(of("\"string phase\" \"rayleigh\""), Phase::Rayleigh);
    assert_eq!(
        of("\"string phase\" \"draine\" \"float g\" .7 \"float alpha\" 2"),
        Phase::Draine { g: 0.7, alpha: 2.0 }
    );
    assert_eq!(
        of("\"string phase\" \"twolobe\" \"float g\" .7 \"float g2\" -.2 \"float share\" .9"),
        Phase::TwoLobe {
            forward: 0.7,
            backward: -0.2,
            share: 0.9
        }
    );
    assert_eq!(
        of("\"string phase\" \"droplets\" \"float diameter\" 12.5"),
        Phase::Droplets { diameter: 12.5 }
    );
}

#[test]
fn media_shine_by_colour() {
    let of = |parameters: &str| only(&medium(parameters)).emission.clone();
    let plain = Emission {
        scale: 2.0,
        le: [1.0, 2.0, 3.0],
        ..Emission::default()
    };
    let le = "\"rgb Le\" [1 2 3] \"float Lescale\" 2";
    assert_eq!(of(&format!("\"homogeneous\" {le}")), Some(plain.clone()));
    assert_eq!(
        of(&format!("\"vol\" \"string filename\" \"a.vol\" {le}")),
        Some(plain.clone())
    );
    let grid = "\"uniformgrid\" \"integer nx\" 2 \"float density\" [1 1]";
    assert_eq!(of(&format!("{grid} {le}")), Some(plain.clone()));
    let scaled = of(&format!(
        "{grid} \"rgb Le\" [1 2 3] \"float Lescale\" [0 4]"
    ));
    let expected = Emission {
        scale: 1.0,
        scale_grid: Some(vec![0.0, 4.0]),
        ..plain.clone()
    };
    assert_eq!(scaled, Some(expected));
    let file =
        of("\"openvdb\" \"string filename\" \"a.vdb\" \"rgb Le\" [1 2 3] \"float Lescale\" 2");
    assert_eq!(file, Some(plain));
    for dark in [
        "\"rgb Le\" [0 0 0]",
        "\"spectrum Le\" [400 0 700 0]",
        "\"rgb Le\" [1 1 1] \"float Lescale\" 0",
        "\"float Lescale\" 5",
    ] {
        assert_eq!(of(&format!("\"homogeneous\" {dark}")), None, "{dark}");
    }
    assert_eq!(
        of(&format!(
            "{grid} \"rgb Le\" [1 1 1] \"float Lescale\" [0 0]"
        )),
        None
    );
    let scene = medium("\"homogeneous\" \"rgb Le\" [1 1 1] \"rgb sigma_a\" [0 0 0]");
    assert_eq!(scene.warnings.len(), 1, "it shines where it absorbs");
}

#[test]
fn media_shine_by_temperature() {
    let of = |parameters: &str| {
        let scene = medium(parameters);
        let emission = only(&scene).emission.clone().expect("emission");
        (emission.scale, emission.temperature.expect("temperature"))
    };
    let listed = of(
        "\"uniformgrid\" \"integer ny\" 2 \"float density\" [1 1] \"float temperature\" [100 2000] \
         \"float temperatureoffset\" 50 \"float temperaturescale\" 2",
    );
    let expected = Temperature {
        values: TemperatureValues::Listed(vec![100.0, 2000.0]),
        offset: 50.0,
        scale: 2.0,
    };
    assert_eq!(listed, (1.0, expected));
    let named = |name: &str| Temperature {
        values: TemperatureValues::Grid(name.to_owned()),
        offset: 0.0,
        scale: 1.0,
    };
    for kind in [
        "\"openvdb\" \"string filename\" \"a.vdb\"",
        "\"nanovdb\" \"string filename\" \"a.nvdb\"",
    ] {
        assert_eq!(
            of(&format!("{kind} \"float Lescale\" 3")),
            (3.0, named("temperature"))
        );
        assert_eq!(
            of(&format!("{kind} \"float LeScale\" 3")),
            (3.0, named("temperature"))
        );
        assert_eq!(
            of(&format!("{kind} \"string temperaturename\" \"heat\"")),
            (1.0, named("heat"))
        );
        let scale = of(&format!("{kind} \"float temperaturescale\" 5")).1.scale;
        assert_eq!(scale, 5.0);
    }
}

#[test]
fn black_bodies_redden_as_they_cool() {
    let [r, g, b] = blackbody_peak_one(6500.0);
    assert!(
        r.max(g).max(b) < 1.25 && r.min(g).min(b) > 0.75,
        "{r} {g} {b}"
    );
    let [r, g, b] = blackbody_peak_one(1500.0);
    assert!(r > 5.0 * g && g > 5.0 * b);
    // The luminance, which is dominated by the distance of the peak from green, rises up to where it is there.
    let luminance = |kelvin| {
        let [r, g, b] = blackbody_peak_one(kelvin);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    assert!(luminance(1000.0) < luminance(2000.0) && luminance(2000.0) < luminance(5000.0));
    assert!(luminance(5200.0) > luminance(12_000.0));
}
