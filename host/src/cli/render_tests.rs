//! Tests of the frame around a render, with a gradient for a renderer.

use super::args::RenderArgs;
use super::failure::Failure;
use super::render::{Prepared, Rendered, run};
use crate::drive::{Goal, drive};
use crate::film::{Film, Tile, Window};
use crate::image::{AttributeValue, RenderMetadata, exr};
use crate::report::Statistics;
use std::fs::{self, File};
use std::io::BufReader;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

const RESOLUTION: [u32; 2] = [40, 30];

/// Adds samples of a gradient with noise; sample 0 of pixel (5, 6) is NaN.
fn gradient(tile: &mut Tile, samples: Range<u32>) {
    let w = tile.window();
    for (x, y) in (w.y0..w.y1).flat_map(|y| (w.x0..w.x1).map(move |x| (x, y))) {
        for s in samples.clone() {
            let noise = (s * 37 % 16) as f32 / 16.0;
            let red = if (x, y, s) == (5, 6, 0) {
                f32::NAN
            } else {
                x as f32 + noise
            };
            tile.add(x, y, s, [red, y as f32, 0.5], 1.0);
        }
    }
}

fn prepare(args: &RenderArgs) -> Result<Prepared, Failure> {
    let goal = Goal {
        samples: args.spp,
        time: args.time,
        ..Goal::default()
    };
    Ok(Prepared {
        image_name: None,
        render: Box::new(move |watch| {
            let mut film = Film::new(RESOLUTION, Window::full(RESOLUTION));
            let outcome = drive(&mut film, &goal, watch, |film, samples| {
                for tile in film.tiles_mut() {
                    gradient(tile, samples.clone());
                    watch
                        .progress
                        .advance(tile.window().pixels() * samples.len() as u64);
                }
                Ok::<_, Failure>(())
            })?;
            let metadata = RenderMetadata {
                seed: u64::MAX,
                scene_hash: 0xabc,
                integrator: "path".to_owned(),
                kernel: "packet".to_owned(),
                samples_per_pixel: outcome.samples.len() as f64,
                samples: outcome.samples,
                replicate: 1,
                target_error: None,
                majorant_violations: 0,
                stopping: outcome.stopping,
                render_time: outcome.render_time,
            };
            Ok(Rendered {
                film,
                channels: Vec::new(),
                metadata,
                statistics: Statistics::default(),
                complete: outcome.complete,
            })
        }),
    })
}

/// A fresh folder, removed by its owner.
fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("woodcock-frame-{name}-{}", std::process::id()));
    fs::create_dir_all(&path).expect("a temporary folder");
    path
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("listable");
    let mut names: Vec<_> = entries
        .map(|entry| {
            entry
                .expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    names.sort();
    names
}

#[test]
fn a_render_writes_what_was_asked() {
    let folder = folder("asked");
    let args = RenderArgs {
        outputs: vec![folder.join("a.exr"), folder.join("a.png")],
        stats: Some(folder.join("a.json")),
        spp: Some(32),
        quiet: true,
        ..RenderArgs::default()
    };
    assert_eq!(run(&args, prepare).expect("no failure"), ExitCode::SUCCESS);
    assert_eq!(names(&folder), ["a.exr", "a.json", "a.png"]);

    let file = BufReader::new(File::open(folder.join("a.exr")).expect("there"));
    let image = exr::read_image(file, 1 << 24).expect("readable");
    let red = image.channel("R").expect("red");
    assert_eq!(red[7], 7.0 + 15.0 / 32.0); // 32 samples: the noise is even over 0, 1/16 … 15/16
    assert_eq!(image.channel("G").expect("green")[40 * 12], 12.0);
    let text = |text: &str| Some(AttributeValue::Text(text.to_owned()));
    let attribute = |name: &str| image.attributes.get(name).cloned();
    assert_eq!(attribute("samplesPerPixel"), Some(AttributeValue::Int(32)));
    assert_eq!(attribute("woodcock.seed"), text("18446744073709551615"));
    assert_eq!(attribute("woodcock.sceneHash"), text("0000000000000abc"));
    assert_eq!(attribute("woodcock.samples"), text("0..32"));
    assert_eq!(attribute("woodcock.stopping"), text("samples"));

    let json = fs::read_to_string(folder.join("a.json")).expect("there");
    let statistics: Statistics = serde_json::from_str(&json).expect("statistics");
    assert_eq!((statistics.width, statistics.height), (40, 30));
    assert_eq!(statistics.nonfinite_paths, 1);
    assert!(
        statistics
            .relative_error
            .is_some_and(|e| e > 0.0 && e < 0.1)
    );
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn time_up_is_done_unless_samples_were_asked_for() {
    let folder = folder("time");
    let args = |spp| RenderArgs {
        outputs: vec![folder.join("a.exr")],
        time: Some(std::time::Duration::from_millis(20)),
        spp,
        quiet: true,
        ..RenderArgs::default()
    };
    assert_eq!(
        run(&args(None), prepare).expect("no failure"),
        ExitCode::SUCCESS
    );
    let unreachable = Some(i32::MAX as u32);
    assert_eq!(
        run(&args(unreachable), prepare).expect("no failure"),
        ExitCode::from(3)
    );
    fs::remove_dir_all(folder).expect("removed");
}

#[test]
fn a_failure_leaves_no_file() {
    let folder = folder("failure");
    let args = RenderArgs {
        outputs: vec![folder.join("a.exr")],
        stats: Some(folder.join("a.json")),
        quiet: true,
        ..RenderArgs::default()
    };
    let broken_scene = run(&args, |_| Err(Failure::message("a typo")));
    assert!(matches!(broken_scene, Err(Failure::Error(_))));
    let broken_render = run(&args, |_| {
        Ok(Prepared {
            image_name: None,
            render: Box::new(|_| Err(Failure::message("a NaN voxel"))),
        })
    });
    assert!(matches!(broken_render, Err(Failure::Error(_))));
    assert!(names(&folder).is_empty());

    // A folder that is not there is found before the scene is even loaded.
    let nowhere = RenderArgs {
        outputs: vec![folder.join("none/a.exr")],
        ..RenderArgs::default()
    };
    let result = run(&nowhere, |_| panic!("must not load"));
    assert!(matches!(result, Err(Failure::Error(_))));
    fs::remove_dir_all(folder).expect("removed");
}
