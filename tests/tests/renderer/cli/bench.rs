//! `woodcock bench`: tables, files that stand alone, and bounded time.

use super::{FOG, Folder};
use std::time::Instant;

const NAMES: [&str; 3] = ["b.csv", "b.html", "b.svg"];

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    folder
}

/// The columns of a line of the CSV, after the quoted name of scene and method.
fn numbers(line: &str) -> Vec<f64> {
    let rest = line.rsplit('"').next().expect("numbers");
    let values = rest.split(',').skip(1);
    values.map(|v| v.parse().expect("a number")).collect()
}

#[test]
fn a_quick_bench_writes_what_stands_alone() {
    let folder = folder();
    let start = Instant::now();
    let run = folder.done(&["bench", "fog.pbrt", "--quick", "--time", "4", "-o", "b"]);
    // Loading and the last run aside.
    assert!(start.elapsed().as_secs() < 20);
    assert_eq!(folder.names(), [NAMES[0], NAMES[1], NAMES[2], "fog.pbrt"]);
    for word in [
        "fog.pbrt, 32 x 24",
        "path,kernel=scalar",
        "bdpt",
        "slope",
        "relMSE",
    ] {
        assert!(run.stdout.contains(word), "no {word} in {}", run.stdout);
    }
    let read = |name: &str| std::fs::read_to_string(folder.path(name)).expect("a file");
    let page = read("b.html");
    assert!(page.contains("<svg") && page.contains("path,kernel=scalar"));
    let named = page.replace("http://www.w3.org/2000/svg", "");
    for outside in ["http:", "https:", "src=", "href=", "<script"] {
        assert!(!named.contains(outside), "{outside}");
    }
    assert!(read("b.svg").starts_with("<svg"));
}

#[test]
fn budgets_double_and_methods_take_turns() {
    let folder = folder();
    folder.done(&[
        "bench",
        "fog.pbrt",
        "-q",
        "-o",
        "b",
        "--time",
        "3",
        "--method",
        "path",
        "--method",
        "path,kernel=scalar",
        "--budgets",
        "4",
        "--seeds",
        "2",
        "--resolution",
        "16x12",
        "-t",
        "1",
    ]);
    let csv = std::fs::read_to_string(folder.path("b.csv")).expect("a file");
    let lines: Vec<_> = csv.lines().collect();
    assert!(
        lines[0].starts_with("scene,method,width,height,budget,seed,samples_per_pixel,cpu_seconds")
    );
    for method in ["\"path\"", "\"path,kernel=scalar\""] {
        let rows: Vec<_> = lines
            .iter()
            .filter(|l| l.contains(method))
            .map(|l| numbers(l))
            .collect();
        // A busy machine may leave the last budget out, with all its seeds; the others never.
        assert!(rows.len() == 8 || rows.len() == 6, "{method}: {rows:?}");
        for row in &rows {
            let [width, height, budget, _, samples, seconds, mse, relative] = row[..8] else {
                panic!("{row:?}");
            };
            assert_eq!((width, height), (16.0, 12.0));
            let first = rows.iter().find(|r| r[2] == 0.0).expect("a first");
            assert_eq!(samples, first[4] * f64::powf(2.0, budget));
            assert!(seconds > 0.0 && mse.is_finite() && relative.is_finite());
        }
    }
}

#[test]
fn a_bias_shows_against_a_reference_of_another_scene() {
    let folder = folder();
    let brighter = FOG.replace("0.4 0.5 0.8", "0.44 0.55 0.88");
    folder.write("brighter.pbrt", &brighter);
    for (scene, name) in [("fog.pbrt", "right.exr"), ("brighter.pbrt", "wrong.exr")] {
        folder.done(&[scene, "-q", "-o", name, "--spp", "4096", "--seed", "99"]);
    }
    let bench = |reference: &str| {
        folder.done(&[
            "bench",
            "fog.pbrt",
            "-q",
            "-o",
            "b",
            "--time",
            "6",
            "--method",
            "path",
            "--reference",
            reference,
        ])
    };
    let run = bench("wrong.exr");
    assert!(run.stdout.contains("FLOOR"), "{}", run.stdout);
    let run = bench("right.exr");
    assert!(!run.stdout.contains("FLOOR"), "{}", run.stdout);
    assert!(
        run.stdout.contains("reference: right.exr"),
        "{}",
        run.stdout
    );
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = folder();
    for (line, code, words) in [
        (
            &["bench", "fog.pbrt", "--method", "light"][..],
            2,
            "there is path",
        ),
        (&["bench", "fog.pbrt", "--budgets", "2"], 2, "budgets"),
        (&["bench", "none.pbrt", "--quick"], 1, "none.pbrt"),
        (
            &["bench", "fog.pbrt", "-o", "none/b", "--quick"],
            1,
            "cannot write",
        ),
        (
            &["bench", "fog.pbrt", "--quick", "--reference", "fog.pbrt"],
            1,
            "fog.pbrt",
        ),
        (
            &[
                "bench",
                "fog.pbrt",
                "--quick",
                "--method",
                "path,keep=colour",
            ],
            2,
            "--keep colour",
        ),
        (
            &["bench", "a.pbrt", "b.pbrt", "--reference", "x.exr"],
            2,
            "one scene",
        ),
    ] {
        let run = folder.run(line);
        assert_eq!(run.code, Some(code), "{line:?}: {}", run.stderr);
        assert!(run.stderr.contains(words), "{line:?}: {}", run.stderr);
        assert_eq!(folder.names(), ["fog.pbrt"]);
    }
}
