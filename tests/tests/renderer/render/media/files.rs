//! Media from files, and files that are refused.

use super::*;

#[test]
fn fire_of_a_file_lies_where_its_grids_lie() {
    let bytes = file("vdb/fire_160.vdb");
    let fire = vdb::read(&bytes, &Limits::default()).expect("a file");
    let grid = |name: &str| fire.grid(name).expect("a grid");
    let map = DAffine3::from_scale_rotation_translation(
        DVec3::splat(0.5),
        glam::DQuat::from_rotation_y(0.4),
        ORIGIN,
    );
    let world = world_with(MemoryFiles::new().with("fire.vdb", bytes.clone()), |m| {
        m.kind = MediumKind::OpenVdb(OpenVdb {
            filename: "fire.vdb".into(),
            gridname: "density".to_owned(),
        });
        m.emission = Some(Emission {
            scale: 1.0,
            temperature: Some(Temperature {
                values: TemperatureValues::Grid("temperature".to_owned()),
                offset: 0.0,
                scale: 1.0,
            }),
            ..Emission::default()
        });
        m.medium_to_world = map;
    });
    let medium = &world.media[0];
    let density = grid("density");
    let (low, high) = density
        .statistics()
        .expect("statistics")
        .active_bbox
        .expect("a box");
    let corner = |i: [i64; 3]| {
        density
            .transform
            .to_world(DVec3::from_array(i.map(|v| v as f64)))
    };
    let mut lit = 0;
    for p in places(corner(low), corner(high), 20_000) {
        let [d, kelvin] =
            ["density", "temperature"].map(|name| grid(name).trilinear(0, p).expect("a value"));
        let le = blackbody_peak_one(if kelvin > 100.0 { kelvin } else { 0.0 });
        let source: [f64; 3] = std::array::from_fn(|c| [0.5, 1.5, 0.75][c] * d * le[c] * EXPOSURE);
        let local = medium.local(&world.tables, None, map.transform_point3(p) - ORIGIN);
        let scale = source.into_iter().fold(0.0, f64::max);
        // Places in single precision move densities by as much as they change in a thousandth of a voxel.
        if d > 0.05 && scale > 1e-9 {
            near("extinction", local.sigma_t, [d, 2.0 * d, 3.0 * d], 1e-3);
            near("source", local.emission, source, 1e-2);
            lit += 1;
        }
    }
    assert!(lit > 200, "{lit}");
    assert!(!medium.emissive_voxels(&world.tables).is_empty());
}

pub(super) fn mitsuba(density: &str, albedo: Option<&str>) -> (MemoryFiles, MediumKind) {
    let mut files = MemoryFiles::new();
    for name in [Some(density), albedo].into_iter().flatten() {
        files = files.with(name, file(&format!("vol/{name}")));
    }
    let kind = MediumKind::Vol(Vol {
        filename: density.into(),
        albedo: albedo.map(PathBuf::from),
    });
    (files, kind)
}

#[test]
fn mitsubas_grids_fill_the_unit_cube() {
    let (files, kind) = mitsuba("density_f32.vol", Some("albedo_rgb_f32.vol"));
    let grid =
        |name: &str| vol::read(&file(&format!("vol/{name}")), &Limits::default()).expect("a grid");
    let (density, albedo) = (grid("density_f32.vol"), grid("albedo_rgb_f32.vol"));
    let world = world_with(files, |m| {
        m.kind = kind;
        m.medium_to_world = turned();
        m.emission = Some(Emission {
            scale: 1.0,
            le: [1.0, 2.0, 3.0],
            ..Emission::default()
        });
    });
    let medium = &world.media[0];
    assert!(!medium.is_plain());
    for p in places(DVec3::ZERO, DVec3::ONE, 500) {
        let p = p.clamp(DVec3::splat(1e-4), DVec3::splat(1.0 - 1e-4));
        let local = medium.local(&world.tables, None, rendered(p));
        let d = density.trilinear(0, p.to_array());
        near("extinction", local.sigma_t, [d, 2.0 * d, 3.0 * d], 2e-5);
        let colour: [f64; 3] = std::array::from_fn(|c| albedo.trilinear(c, p.to_array()));
        near("albedo", local.albedo, colour, 1e-9);
        let source = std::array::from_fn(|c| {
            let weight = (c + 1) as f64;
            weight * d * (1.0 - colour[c]) * weight * EXPOSURE
        });
        near("source", local.emission, source, 1e-4);
    }
    // Without an albedo of its own it is a plain grid.
    let (files, kind) = mitsuba("density_u8.vol", None);
    let world = world_with(files, |m| m.kind = kind);
    assert!(world.media[0].is_plain());
}

#[test]
fn nanovdb_is_openvdb_to_the_bit() {
    let open = world_with(
        MemoryFiles::new().with("c.vdb", file("vdb/quantised_blosc.vdb")),
        |m| {
            m.kind = MediumKind::OpenVdb(OpenVdb {
                filename: "c.vdb".into(),
                gridname: "density".to_owned(),
            });
        },
    );
    let nano = world_with(
        MemoryFiles::new().with("c.nvdb", file("nvdb/multi.nvdb")),
        |m| {
            m.kind = MediumKind::NanoVdb(NanoVdb {
                filename: "c.nvdb".into(),
                gridname: "density".to_owned(),
            });
            m.emission = Some(Emission {
                scale: 1.0,
                temperature: Some(Temperature {
                    values: TemperatureValues::Grid("temperature".to_owned()),
                    offset: 0.0,
                    scale: 5.0,
                }),
                ..Emission::default()
            });
        },
    );
    assert_eq!(open.tables.samples, nano.tables.samples);
    assert_eq!(open.tables.majorants, nano.tables.majorants);
    assert!(open.media[0].is_plain() && !nano.media[0].is_plain());
    // Its temperature is 300 plus its density where there is any: about 1503 K.
    let lit = nano.media[0].emissive_voxels(&nano.tables);
    assert!(lit.len() > 5000, "{}", lit.len());
}
