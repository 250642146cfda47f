//! What no medium can be made of.

use super::files::mitsuba;
use super::*;

#[test]
fn what_is_wrong_is_refused_where_it_is() {
    let none = MemoryFiles::new;
    let wrong = |change: &dyn Fn(&mut RgbGrid)| {
        let mut grid = rgb(true);
        change(&mut grid);
        MediumKind::RgbGrid(grid)
    };
    let negative = wrong(&|g| {
        if let Some(list) = &mut g.sigma_a {
            list[17][1] = -1.0;
        }
    });
    assert_refused(&["sigma_a", "voxel 17", "not negative"], none(), |m| {
        m.kind = negative
    });
    let short = wrong(&|g| {
        if let Some(list) = &mut g.sigma_s {
            list.pop();
        }
    });
    assert_refused(&["too few values of sigma_s"], none(), |m| m.kind = short);
    let dark = wrong(&|g| {
        if let Some(list) = &mut g.le {
            list[3][2] = f32::NAN;
        }
    });
    assert_refused(&["Le is NaN"], none(), |m| m.kind = dark);
    let heat = |values: Vec<f32>| Emission {
        scale: 1.0,
        temperature: Some(Temperature {
            values: TemperatureValues::Listed(values),
            offset: 0.0,
            scale: 1.0,
        }),
        ..Emission::default()
    };
    assert_refused(&["119 values", "5 x 4 x 6"], none(), |m| {
        m.kind = uniform(scramble);
        m.emission = Some(heat(vec![900.0; 119]));
    });
    assert_refused(&["temperature is inf"], none(), |m| {
        m.kind = uniform(scramble);
        m.emission = Some(heat(vec![f32::INFINITY; 120]));
    });
    assert_refused(&["by voxel need a grid"], none(), |m| {
        m.emission = Some(heat(vec![900.0]))
    });
    assert_refused(&["scale of emission is -2"], none(), |m| {
        m.emission = Some(Emission {
            scale: -1.0,
            le: [1.0; 3],
            ..Emission::default()
        });
    });
    let c = Cloud {
        density: 1.0,
        wispiness: 1.0,
        frequency: 5.0,
        p0: DVec3::ZERO,
        p1: DVec3::ONE,
    };
    let clouds: [(&[&str], Cloud); 2] = [
        (
            &["wispiness is NaN"],
            Cloud {
                wispiness: f64::NAN,
                ..c
            },
        ),
        (
            &["no inside"],
            Cloud {
                p1: DVec3::ZERO,
                ..c
            },
        ),
    ];
    for (words, cloud) in clouds {
        assert_refused(words, none(), |m| m.kind = MediumKind::Cloud(cloud));
    }
    for (density, albedo, words) in [
        ("albedo_rgb_f32.vol", None, &["3 channel(s) where 1"][..]),
        (
            "density_f32.vol",
            Some("density_f32.vol"),
            &["1 channel(s) where 3"],
        ),
        (
            "bad_value.vol",
            None,
            &["bad_value.vol", "(3, 0, 0)", "NaN"],
        ),
        ("bad_truncated.vol", None, &["bad_truncated.vol", "908"]),
    ] {
        let (files, kind) = mitsuba(density, albedo);
        assert_refused(words, files, |m| m.kind = kind);
    }
    let nano = |grid: &str| {
        MediumKind::NanoVdb(NanoVdb {
            filename: "m.nvdb".into(),
            gridname: grid.to_owned(),
        })
    };
    let multi = || MemoryFiles::new().with("m.nvdb", file("nvdb/multi.nvdb"));
    assert_refused(&["no grid \"smoke\"", "\"temperature\""], multi(), |m| {
        m.kind = nano("smoke")
    });
    assert_refused(&["no grid \"heat\""], multi(), |m| {
        m.kind = nano("density");
        let mut emission = heat(Vec::new());
        if let Some(temperature) = &mut emission.temperature {
            temperature.values = TemperatureValues::Grid("heat".to_owned());
        }
        m.emission = Some(emission);
    });
    let cut = MemoryFiles::new().with("m.nvdb", &file("nvdb/multi.nvdb")[..30_000]);
    assert_refused(&["m.nvdb", "truncated"], cut, |m| {
        m.kind = nano("temperature")
    });
}

#[test]
fn memory_is_counted_for_every_number_of_a_voxel() {
    // 336 voxels with the rim: 1344 bytes as densities, seven times as many by colour.
    let limits = Limits { max_memory: 9000 };
    assert!(try_world(MemoryFiles::new(), limits, |m| m.kind = uniform(scramble)).is_ok());
    let error = try_world(MemoryFiles::new(), limits, |m| {
        m.kind = MediumKind::RgbGrid(rgb(false))
    });
    assert!(error.expect_err("a limit").report().contains("limit"));
}
