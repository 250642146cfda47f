//! `--target-error`: samples where the error is, and honest words about what was reached.

use super::{FOG, Folder, bits};
use serde_json::Value;
use woodcock_host::image::{AttributeValue, Image};

fn fog() -> Folder {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    folder
}

fn text(image: &Image, name: &str) -> String {
    match image.attributes.get(name) {
        Some(AttributeValue::Text(text)) => text.clone(),
        other => panic!("{name}: {other:?}"),
    }
}

fn samples(image: &Image) -> Vec<f32> {
    image.channel("Samples").expect("counts").to_vec()
}

/// The error of each block as the image itself tells it, after the definition in the help.
fn errors(image: &Image) -> Vec<f64> {
    let [width, height] = image.window.size().map(|n| n as usize);
    let channel = |name: &str| image.channel(name).expect("a channel").to_vec();
    let means = ["R", "G", "B"].map(channel);
    let variances = ["Variance.R", "Variance.G", "Variance.B"].map(channel);
    let all: f64 = means.iter().flatten().map(|&v| f64::from(v)).sum();
    let mean = all / (3 * width * height) as f64;
    let mut errors = Vec::new();
    for top in (0..height).step_by(8) {
        for left in (0..width).step_by(8) {
            let (mut sum, mut count) = (0.0, 0.0);
            for y in top..(top + 8).min(height) {
                for at in (left..(left + 8).min(width)).map(|x| y * width + x) {
                    for (m, v) in means.iter().zip(&variances) {
                        let m = f64::from(m[at]);
                        sum += f64::from(v[at]) / (m * m + 0.01 * mean * mean);
                        count += 1.0;
                    }
                }
            }
            errors.push((sum / count).sqrt());
        }
    }
    errors
}

#[test]
fn the_error_asked_for_is_reached_everywhere() {
    let folder = fog();
    let run = folder.done(&[
        "fog.pbrt",
        "-o",
        "x.exr",
        "--target-error",
        "1%",
        "--stats",
        "s.json",
    ]);
    assert!(run.stderr.contains("pilot"), "{}", run.stderr);
    let image = folder.image("x.exr");
    assert_eq!(text(&image, "woodcock.stopping"), "target");
    assert_eq!(text(&image, "woodcock.targetError"), "0.01");
    let errors = errors(&image);
    assert_eq!(errors.len(), 12);
    // The promise is of 95 % per block; that of the true error, and here it is estimated: some room.
    let worst = errors.iter().copied().fold(0.0, f64::max);
    assert!(worst < 0.0115, "{errors:?}");
    let counts = samples(&image);
    let (least, most) = counts
        .iter()
        .fold((f32::MAX, 0.0_f32), |(a, b), &n| (a.min(n), b.max(n)));
    assert!(least >= 16.0 && most > 1.5 * least, "{least} to {most}");
    let mean = counts.iter().map(|&n| f64::from(n)).sum::<f64>() / counts.len() as f64;
    let per_pixel = image.attributes.get("samplesPerPixel");
    assert_eq!(per_pixel, Some(&AttributeValue::Int(mean.round() as i32)));
    let stats = std::fs::read_to_string(folder.path("s.json")).expect("statistics");
    let stats: Value = serde_json::from_str(&stats).expect("JSON");
    assert_eq!(stats["spp"], mean.round() as i64);
    assert_eq!(
        stats["paths"],
        counts.iter().map(|&n| n as u64).sum::<u64>()
    );
    assert_eq!(stats["target_error"], 0.01);
    assert!(
        stats["pilot_paths"]
            .as_u64()
            .is_some_and(|n| n >= 32 * 32 * 24)
    );
}

#[test]
fn neither_threads_nor_lanes_nor_the_pilot_change_a_bit() {
    let folder = fog();
    for (name, more) in [
        ("one.exr", &["-t", "1"][..]),
        ("two.exr", &["-t", "2"]),
        ("scalar.exr", &["--kernel", "scalar"]),
    ] {
        let line = ["fog.pbrt", "-q", "--target-error", "0.015", "-o", name];
        folder.done(&[&line, more].concat());
    }
    let one = folder.image("one.exr");
    for other in ["two.exr", "scalar.exr"] {
        assert!(bits(&one) == bits(&folder.image(other)), "{other}");
    }
    // The pilot is thrown away: a pixel's samples are the first of those that a plain render has.
    let counts = samples(&one);
    let n = counts[0] as u32;
    folder.done(&["fog.pbrt", "-q", "--spp", &n.to_string(), "-o", "plain.exr"]);
    let plain = folder.image("plain.exr");
    let mut same = 0;
    for name in ["R", "G", "B", "A", "Variance.R"] {
        let [a, b] = [&one, &plain].map(|image| image.channel(name).expect("a channel"));
        for ((a, b), count) in a.iter().zip(b).zip(&counts) {
            if *count as u32 == n {
                assert_eq!(a.to_bits(), b.to_bits(), "{name}");
                same += 1;
            }
        }
    }
    assert!(same >= 5 * 64);
}

#[test]
fn what_was_not_reached_is_said() {
    let folder = fog();
    let run = folder.run(&[
        "fog.pbrt",
        "-o",
        "x.exr",
        "--target-error",
        "1%",
        "--spp",
        "20",
    ]);
    assert_eq!(run.code, Some(3), "{}", run.stderr);
    assert!(run.stderr.contains("stopped early"), "{}", run.stderr);
    let image = folder.image("x.exr");
    assert_eq!(text(&image, "woodcock.stopping"), "samples");
    assert!(samples(&image).iter().all(|&n| n <= 20.0));
    let run = folder.run(&[
        "fog.pbrt",
        "-q",
        "-o",
        "y.exr",
        "--target-error",
        "0.01%",
        "--time",
        "0.3",
    ]);
    assert_eq!(run.code, Some(3), "{}", run.stderr);
    assert_eq!(text(&folder.image("y.exr"), "woodcock.stopping"), "time");
    // A limit that is not reached changes nothing.
    let run = folder.run(&[
        "fog.pbrt",
        "-q",
        "-o",
        "z.exr",
        "--target-error",
        "30%",
        "--time",
        "100",
        "--spp",
        "5000",
    ]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for bad in ["0", "-1", "200%", "x"] {
        assert_eq!(
            folder.run(&["fog.pbrt", "--target-error", bad]).code,
            Some(2)
        );
    }
}

#[test]
fn light_that_lands_anywhere_gets_the_same_samples_everywhere() {
    let folder = fog();
    for integrator in ["bdpt", "mlt"] {
        folder.done(&[
            "fog.pbrt",
            "-q",
            "-o",
            "x.exr",
            "--target-error",
            "40%",
            "--integrator",
            integrator,
            "--resolution",
            "12x10",
        ]);
        let counts = samples(&folder.image("x.exr"));
        assert!(
            counts.iter().all(|n| *n == counts[0] && *n >= 16.0),
            "{counts:?}"
        );
    }
}
