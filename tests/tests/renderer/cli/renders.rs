//! Renders that end well.

use super::{FOG, Folder, bits, cloud_scene, data};
use serde_json::Value;

fn cloud() -> Folder {
    let folder = Folder::new();
    folder.write(
        "cloud.pbrt",
        &cloud_scene(&data().join("vdb/cloud_zip.vdb")),
    );
    folder
}

#[test]
fn without_a_word_it_renders_its_own_cloud_here() {
    let folder = Folder::new();
    let run = folder.done(&["--spp", "1", "--resolution", "64x36"]);
    assert_eq!(folder.names(), ["woodcock.exr", "woodcock.png"]);
    assert!(run.stderr.contains("built-in"), "{}", run.stderr);
    assert!(run.stderr.contains("woodcock.exr") && run.stderr.contains("woodcock.png"));
    let file = std::fs::File::open(folder.path("woodcock.png")).expect("a picture");
    let reader = png::Decoder::new(std::io::BufReader::new(file))
        .read_info()
        .expect("a PNG");
    assert_eq!((reader.info().width, reader.info().height), (64, 36));
    let image = folder.image("woodcock.exr");
    assert!(
        image
            .channels
            .iter()
            .any(|c| c.name == "A" && c.values.iter().any(|&a| a > 0.0))
    );
}

#[test]
fn threads_lanes_and_passes_give_the_same_pixel_bits() {
    let folder = cloud();
    for (name, more) in [
        ("one.exr", &["-t", "1"][..]),
        ("two.exr", &["-t", "2"]),
        ("scalar.exr", &["--kernel", "scalar"]),
        ("scalar1.exr", &["--kernel", "scalar", "--nthreads", "1"]),
    ] {
        folder.done(
            &[
                &["render", "cloud.pbrt", "-q", "--spp", "7", "-o", name],
                more,
            ]
            .concat(),
        );
    }
    let one = bits(&folder.image("one.exr"));
    for other in ["two.exr", "scalar.exr", "scalar1.exr"] {
        assert!(one == bits(&folder.image(other)), "{other}");
    }
    folder.done(&[
        "render",
        "cloud.pbrt",
        "-q",
        "--spp",
        "7",
        "--seed",
        "1",
        "-o",
        "seed.exr",
    ]);
    assert!(one != bits(&folder.image("seed.exr")));
}

#[test]
fn channels_and_attributes_are_those_of_the_contract() {
    let folder = cloud();
    folder.done(&["render", "cloud.pbrt", "-q", "--seed", "5", "-o", "x.exr"]);
    let image = folder.image("x.exr");
    let mut names: Vec<_> = image.channels.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(
        names,
        ["A", "B", "G", "R", "Variance.B", "Variance.G", "Variance.R"]
    );
    for name in [
        "samplesPerPixel",
        "renderTimeSeconds",
        "woodcock.version",
        "woodcock.seed",
        "woodcock.sceneHash",
        "woodcock.integrator",
        "woodcock.kernel",
        "woodcock.samples",
        "woodcock.replicate",
        "woodcock.majorantViolations",
        "woodcock.stopping",
    ] {
        assert!(image.attributes.iter().any(|(n, _)| n == name), "no {name}");
    }
    let finite =
        |c: &woodcock_host::image::Channel| c.values.iter().all(|v| v.is_finite() && *v >= 0.0);
    assert!(image.channels.iter().all(finite));
    // Not black anywhere, and the data types are one.
    let red = image.channels.iter().find(|c| c.name == "R").expect("red");
    assert!(red.values.iter().all(|&v| v > 0.0));
}

#[test]
fn statistics_have_the_keys_of_the_contract() {
    let folder = cloud();
    folder.done(&[
        "render",
        "cloud.pbrt",
        "-q",
        "-t",
        "1",
        "-o",
        "x.png",
        "--stats",
        "s.json",
    ]);
    assert_eq!(folder.names(), ["cloud.pbrt", "s.json", "x.png"]);
    let text = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
    let stats: Value = serde_json::from_str(&text).expect("JSON");
    let keys = "scene integrator transmittance kernel threads seed spp width height setup_seconds render_seconds \
        cpu_seconds paths tentative_collisions real_collisions null_collisions lookups exact_lookups majorant_cells \
        lane_utilisation majorant_violations nonfinite_paths relative_error target_error pilot_paths needs skipped";
    for key in keys.split_whitespace() {
        assert!(stats.get(key).is_some(), "no {key}");
    }
    assert_eq!(stats["spp"], 4);
    assert_eq!(stats["paths"], 40 * 30 * 4);
    assert_eq!(stats["threads"], 1);
    assert_eq!(stats["kernel"], "packet");
    assert_eq!(
        (&stats["majorant_violations"], &stats["nonfinite_paths"]),
        (&0.into(), &0.into())
    );
    assert_eq!(stats["transmittance"], "ratio");
    let utilisation = stats["lane_utilisation"].as_f64().expect("a number");
    assert!(utilisation > 0.5 && utilisation <= 1.0, "{utilisation}");
    assert!(
        stats["needs"]
            .as_array()
            .is_some_and(|n| n.contains(&"tracking".into()))
    );
}

#[test]
fn names_of_images_come_from_the_command_line_the_film_or_the_scene() {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    folder.write(
        "plain.pbrt",
        &FOG.replace("\"string filename\" \"fog.exr\"", ""),
    );
    folder.done(&["fog.pbrt", "-q"]);
    folder.done(&["render", "plain.pbrt", "-q"]);
    folder.done(&[
        "render",
        "fog.pbrt",
        "-q",
        "-o",
        "a.exr",
        "--outfile",
        "b.png",
    ]);
    let names = folder.names();
    for name in ["fog.exr", "a.exr", "b.png"] {
        assert!(names.iter().any(|n| n == name), "no {name} in {names:?}");
    }
    assert_eq!(
        names.iter().filter(|n| n.starts_with('.')).count(),
        0,
        "{names:?}"
    );
}

#[test]
fn quiet_is_silent_and_otherwise_the_end_is_told() {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    let run = folder.done(&["render", "fog.pbrt", "--quiet"]);
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    let run = folder.done(&["render", "fog.pbrt"]);
    assert_eq!(run.stdout, "");
    assert!(
        run.stderr.contains("fog.exr: 4 samples per pixel"),
        "{}",
        run.stderr
    );
}

#[test]
fn a_time_limit_is_a_wish_fulfilled_or_not() {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    let run = folder.done(&["render", "fog.pbrt", "-q", "--time", "0.2"]);
    assert_eq!(run.stderr, "");
    let image = folder.image("fog.exr");
    let stopping = image
        .attributes
        .iter()
        .find(|(n, _)| *n == "woodcock.stopping");
    assert!(format!("{stopping:?}").contains("time"), "{stopping:?}");
    // Time up before the samples asked for: partial, and valid.
    let run = folder.run(&[
        "render",
        "fog.pbrt",
        "-q",
        "--time",
        "0.05",
        "--spp",
        "2000000000",
        "-o",
        "p.exr",
    ]);
    assert_eq!(run.code, Some(3));
    assert!(!folder.image("p.exr").channels.is_empty());
}

#[test]
fn crops_are_windows_of_the_whole() {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    folder.done(&["render", "fog.pbrt", "-q", "-o", "whole.exr"]);
    folder.done(&[
        "render",
        "fog.pbrt",
        "-q",
        "-o",
        "part.exr",
        "--crop",
        "0.25,0.75,0.5,1",
    ]);
    let (whole, part) = (folder.image("whole.exr"), folder.image("part.exr"));
    assert_eq!(part.resolution, [32, 24]);
    let w = part.window;
    assert_eq!([w.x0, w.x1, w.y0, w.y1], [8, 24, 12, 24]);
    for channel in &part.channels {
        let same = whole
            .channels
            .iter()
            .find(|c| c.name == channel.name)
            .expect("the channel");
        for y in w.y0..w.y1 {
            for x in w.x0..w.x1 {
                let (a, b) = (
                    channel.values[w.index(x, y)],
                    same.values[whole.window.index(x, y)],
                );
                assert_eq!(a.to_bits(), b.to_bits(), "{} ({x}, {y})", channel.name);
            }
        }
    }
}

#[test]
fn explain_tells_what_runs_and_why() {
    let folder = cloud();
    let text = folder.done(&["explain", "cloud.pbrt"]).stdout;
    for word in [
        "tracking",
        "needed",
        "skipped",
        "chromatic",
        "grey extinction",
        "kernel packet: grid",
        "majorants",
        "boundaries",
    ] {
        assert!(text.contains(word), "no {word:?} in {text}");
    }
    folder.write("fog.pbrt", FOG);
    let text = folder.done(&["explain", "fog.pbrt"]).stdout;
    assert!(text.contains("homogeneous, chromatic"), "{text}");
    assert_eq!(folder.names(), ["cloud.pbrt", "fog.pbrt"]);
}

#[test]
fn a_path_can_be_traced_again() {
    let folder = cloud();
    let text = folder
        .done(&["render", "cloud.pbrt", "--replay", "20,15,3"])
        .stdout;
    assert!(
        text.contains("path 3 of pixel (20, 15)") && text.contains("real collisions"),
        "{text}"
    );
    assert_eq!(
        folder
            .done(&[
                "render",
                "cloud.pbrt",
                "--replay",
                "20,15,3",
                "--kernel",
                "scalar"
            ])
            .stdout,
        text
    );
    assert_eq!(
        folder
            .run(&["render", "cloud.pbrt", "--replay", "40,0,0"])
            .code,
        Some(2)
    );
    assert_eq!(folder.names(), ["cloud.pbrt"]);
}

#[test]
fn features_can_be_kept_by_name() {
    let folder = cloud();
    for feature in [
        "tracking",
        "chromatic",
        "several-media",
        "boundaries",
        "environment-next-event",
        "rayleigh",
    ] {
        folder.done(&[
            "render",
            "cloud.pbrt",
            "-q",
            "--spp",
            "2",
            "--keep",
            feature,
            "--stats",
            "s.json",
        ]);
        let text = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
        let stats: Value = serde_json::from_str(&text).expect("JSON");
        let needs = stats["needs"].as_array().expect("a list");
        assert!(needs.contains(&feature.into()), "{feature}: {needs:?}");
    }
}

#[test]
fn lenient_reading_warns_and_goes_on() {
    let folder = Folder::new();
    folder.write(
        "odd.pbrt",
        &FOG.replace(
            "WorldBegin",
            "WorldBegin\nLightSource \"projection\" \"float fov\" 30",
        ),
    );
    let run = folder.run(&["render", "odd.pbrt"]);
    assert_eq!(run.code, Some(1), "{}", run.stderr);
    let run = folder.done(&["render", "odd.pbrt", "--lenient"]);
    assert!(
        run.stderr.contains("warning:") && run.stderr.contains("odd.pbrt:6:"),
        "{}",
        run.stderr
    );
}
