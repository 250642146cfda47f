//! `woodcock info` on every file of the tests' data.

use super::{FOG, Folder, data};
use serde_json::Value;

fn volumes(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(data().join(folder)).expect("a folder");
    let mut paths: Vec<_> = entries
        .map(|e| e.expect("an entry").path())
        .filter(|p| {
            p.extension()
                .is_some_and(|e| e == "vdb" || e == "nvdb" || e == "vol")
        })
        .map(|p| p.to_string_lossy().into_owned())
        .collect();
    paths.sort();
    paths
}

#[test]
fn every_volume_is_described_as_json_and_as_text() {
    let folder = Folder::new();
    let files = volumes("vdb");
    assert!(files.len() > 20, "{}", files.len());
    let nano = volumes("nvdb");
    assert!(nano.len() > 5, "{}", nano.len());
    for file in files.into_iter().chain(nano) {
        let text = folder.done(&["info", &file, "--json"]).stdout;
        let info: Value = serde_json::from_str(&text).expect("JSON");
        let grids = info["grids"].as_array().expect("a list of grids");
        let names: Vec<_> = grids
            .iter()
            .map(|g| g["name"].as_str().expect("a name"))
            .collect();
        assert!(names.is_sorted(), "{file}: {names:?}");
        let text = folder.done(&["info", &file]).stdout;
        for name in names {
            assert!(text.contains(name), "{file}: no {name} in {text}");
        }
    }
}

#[test]
fn malformed_volumes_are_described_or_refused() {
    let folder = Folder::new();
    let damaged = ["malformed", "malformed_nvdb", "vol"];
    for file in damaged.into_iter().flat_map(volumes) {
        let run = folder.run(&["info", &file, "--json", "--max-memory", "1G"]);
        match run.code {
            Some(0) => drop(serde_json::from_str::<Value>(&run.stdout).expect("JSON")),
            Some(1) => assert!(
                run.stderr.contains(&file) && run.stdout.is_empty(),
                "{file}: {}",
                run.stderr
            ),
            other => panic!("{file}: {other:?}"),
        }
    }
}

#[test]
fn values_and_integrals_are_answered() {
    let folder = Folder::new();
    let file = data()
        .join("vdb/cloud_zip.vdb")
        .to_string_lossy()
        .into_owned();
    let args = [
        "info",
        &file,
        "--json",
        "--grid",
        "density",
        "--at",
        "0,0.65,0",
        "--ray=-9,0.6,0,9,0.7,0",
    ];
    let info: Value = serde_json::from_str(&folder.done(&args).stdout).expect("JSON");
    let grid = &info["grids"][0];
    assert_eq!(
        (
            grid["at"].as_array().map(Vec::len),
            grid["ray"].as_array().map(Vec::len)
        ),
        (Some(1), Some(1))
    );
    assert!(grid["ray"][0].to_string().contains('.'), "{grid}");
    assert_eq!(
        folder.run(&["info", &file, "--grid", "smoke"]).code,
        Some(1)
    );
}

#[test]
fn an_image_of_ours_is_described() {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    folder.done(&["render", "fog.pbrt", "-q", "--spp", "3"]);
    let text = folder.done(&["info", "fog.exr"]).stdout;
    for word in ["32", "24", "Variance.R", "samplesPerPixel"] {
        assert!(text.contains(word), "no {word} in {text}");
    }
    let json = folder.done(&["info", "fog.exr", "--json"]).stdout;
    serde_json::from_str::<Value>(&json).expect("JSON");
}
