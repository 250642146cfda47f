//! Everything that goes wrong: a sentence with file and place, the right exit code, and nothing left behind.

use super::{FOG, Folder, cloud_scene, data};

/// Runs a render that must fail with `code` and say `words`, and leave only what was there.
#[track_caller]
fn assert_fails(folder: &Folder, args: &[&str], code: i32, words: &[&str]) {
    let before = folder.names();
    let run = folder.run(args);
    assert_eq!(run.code, Some(code), "{args:?}: {}", run.stderr);
    assert_eq!(run.stdout, "");
    assert!(run.stderr.contains("error:"), "{}", run.stderr);
    for word in words {
        assert!(run.stderr.contains(word), "no {word:?} in {}", run.stderr);
    }
    assert_eq!(folder.names(), before, "nothing is left behind");
}

#[test]
fn scenes_that_are_wrong_are_refused_at_their_place() {
    let grid = |density: &str| {
        FOG.replace(
            "\"string type\" \"homogeneous\"",
            &format!(
                "\"string type\" \"uniformgrid\" \"integer nx\" 2 \"float density\" [ {density} ]"
            ),
        )
    };
    for (text, words) in [
        (
            FOG.replace("LightSource", "LihgtSource"),
            &["s.pbrt:6:1", "LihgtSource"][..],
        ),
        (
            FOG.replace("homogeneous", "homogenous"),
            &["s.pbrt:7:", "did you mean", "homogeneous"],
        ),
        (FOG.replace("sigma_s", "sigma_t"), &["s.pbrt:7:", "sigma_t"]),
        (FOG.replace("[ 2 2 2 ]", "[ 2 2 -2 ]"), &["s.pbrt:7:"]),
        (FOG.replace("[ 2 2 2 ]", "[ 2 2 nan ]"), &["s.pbrt:7:"]),
        (
            FOG.replace("\"m\" \"\"", "\"n\" \"\""),
            &["s.pbrt:9:", "\"n\" is not defined"],
        ),
        (
            FOG.replace("Shape \"sphere\"", "Include \"none.pbrt\" Shape \"sphere\""),
            &["s.pbrt:10:", "none.pbrt"],
        ),
        (grid("1 -1"), &["s.pbrt:7:", "negative", "(1, 0, 0)"]),
        (grid("1 nan"), &["s.pbrt:7:"]),
        (grid("1 1 1"), &["s.pbrt:7:", "3 density values"]),
        (
            FOG.replace(
                "\"rgb L\" [ 0.4 0.5 0.8 ]",
                "\"string filename\" \"sky.exr\"",
            ),
            &["s.pbrt:6:"],
        ),
    ] {
        let folder = Folder::new();
        folder.write("s.pbrt", &text);
        assert_fails(&folder, &["render", "s.pbrt"], 1, words);
    }
}

#[test]
fn volumes_that_are_wrong_are_refused_at_their_place() {
    for (file, words) in [
        ("vdb/bad_values.vdb", &["(1, 1, 1)", "NaN"][..]),
        (
            "vdb/levelset.vdb",
            &["no grid \"density\"", "\"ls_sphere\""],
        ),
        ("vdb/tiles.vdb", &["-3", "negative"]),
        ("vdb/nowhere.vdb", &["there is no file"]),
        ("malformed/magic_flip.vdb", &[]),
        ("malformed/text.vdb", &[]),
        ("malformed/trunc_8989.vdb", &[]),
        ("malformed/zip_corrupt.vdb", &[]),
    ] {
        let folder = Folder::new();
        let path = data().join(file);
        folder.write("s.pbrt", &cloud_scene(&path));
        let name = path
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let words = [&["s.pbrt:8:", name.as_str()][..], words].concat();
        assert_fails(&folder, &["render", "s.pbrt"], 1, &words);
    }
}

#[test]
fn no_malformed_volume_panics_or_leaves_a_file() {
    let mut seen = 0;
    for entry in std::fs::read_dir(data().join("malformed")).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|e| e != "vdb") {
            continue;
        }
        let folder = Folder::new();
        folder.write("s.pbrt", &cloud_scene(&path));
        let run = folder.run(&[
            "render",
            "s.pbrt",
            "-q",
            "--spp",
            "1",
            "--resolution",
            "8x6",
            "--max-memory",
            "1G",
        ]);
        match run.code {
            Some(0) => assert_eq!(folder.names(), ["cloud.exr", "s.pbrt"]),
            Some(1) => {
                assert!(
                    run.stderr.contains("s.pbrt:8:"),
                    "{}: {}",
                    path.display(),
                    run.stderr
                );
                assert_eq!(folder.names(), ["s.pbrt"]);
            }
            other => panic!("{}: {other:?} {}", path.display(), run.stderr),
        }
        seen += 1;
    }
    assert!(seen > 60, "{seen}");
}

#[test]
fn usage_errors_exit_with_two() {
    let folder = Folder::new();
    folder.write("s.pbrt", FOG);
    for (args, words) in [
        (
            &["render", "s.pbrt", "--keep", "everything"][..],
            &["everything", "tracking"][..],
        ),
        (&["render", "s.pbrt", "--keep", "lens"], &["lens"]),
        (&["render", "s.pbrt", "-o", "x.jpg"], &["x.jpg", ".exr"]),
        (
            &["render", "s.pbrt", "-o", "a.exr", "-o", "b.exr"],
            &["b.exr"],
        ),
        (&["render", "s.pbrt", "--spp", "0"], &["spp"]),
        (&["render", "s.pbrt", "--spp", "many"], &["spp"]),
        (
            &["render", "s.pbrt", "--resolution", "0x7"],
            &["resolution"],
        ),
        (&["render", "s.pbrt", "--crop", "0.5,0.5,0,1"], &["crop"]),
        (
            &["render", "s.pbrt", "--kernel", "gpu"],
            &["kernel", "packet"],
        ),
        (
            &["render", "s.pbrt", "--integrator", "march"],
            &["path, bdpt, mlt, single, transmittance"],
        ),
        (
            &["render", "s.pbrt", "--integrator", "mlt", "--aov", "depth"],
            &["--aov", "mlt"],
        ),
        (
            &[
                "render",
                "s.pbrt",
                "--integrator",
                "bdpt",
                "--aov",
                "matter",
            ],
            &["--aov", "path, single and transmittance"],
        ),
        (
            &["render", "s.pbrt", "--integrator", "mlt", "--split", "4"],
            &["--split", "path and single"],
        ),
        (
            &["render", "s.pbrt", "--connection-bound", "4"],
            &["--connection-bound", "bdpt and mlt"],
        ),
        (
            &[
                "render",
                "s.pbrt",
                "--transmittance",
                "delta",
                "--split",
                "2",
            ],
            &["--transmittance delta"],
        ),
        (
            &[
                "render",
                "s.pbrt",
                "--transmittance",
                "closed",
                "--keep",
                "tracking",
            ],
            &["closed"],
        ),
        (
            &["render", "s.pbrt", "--shard", "0/2"],
            &["not yet supported"],
        ),
        (&["merge", "a.exr"], &["not yet supported"]),
        (&["render", "s.pbrt", "--frobnicate"], &["frobnicate"]),
        (&["info"], &["FILE"]),
    ] {
        assert_fails(&folder, args, 2, words);
    }
}

#[test]
fn files_that_are_not_there_are_named() {
    let folder = Folder::new();
    assert_fails(&folder, &["render", "none.pbrt"], 1, &["none.pbrt"]);
    assert_fails(&folder, &["explain", "none.pbrt"], 1, &["none.pbrt"]);
    assert_fails(&folder, &["info", "none.vdb"], 1, &["none.vdb"]);
    assert_fails(&folder, &["render", "."], 1, &[]);
}

#[test]
fn outputs_are_checked_before_anything_is_rendered() {
    let folder = Folder::new();
    folder.write("s.pbrt", FOG);
    std::fs::create_dir(folder.path("folder.exr")).expect("a folder");
    for (args, word) in [
        (&["render", "s.pbrt", "-o", "none/x.exr"][..], "none"),
        (&["render", "s.pbrt", "-o", "folder.exr"], "folder.exr"),
        (&["render", "s.pbrt", "--stats", "none/s.json"], "none"),
        (&["render", "no.pbrt", "-o", "none/x.exr"], "none"),
    ] {
        assert_fails(&folder, args, 1, &[word, "cannot write"]);
    }
}

#[test]
fn memory_limits_are_kept() {
    let folder = Folder::new();
    folder.write("fire.pbrt", &cloud_scene(&data().join("vdb/fire_160.vdb")));
    folder.write("far.pbrt", &cloud_scene(&data().join("vdb/far_coords.vdb")));
    folder.write("fog.pbrt", FOG);
    assert_fails(
        &folder,
        &["render", "fire.pbrt", "--max-memory", "2M"],
        1,
        &["fire_160.vdb", "limit"],
    );
    assert_fails(
        &folder,
        &["render", "far.pbrt", "--max-memory", "1G"],
        1,
        &["far_coords.vdb", "--max-memory"],
    );
    assert_fails(
        &folder,
        &["render", "fog.pbrt", "--max-memory", "1K"],
        1,
        &["limit"],
    );
    let large = [
        "render",
        "fog.pbrt",
        "--resolution",
        "60000x60000",
        "--max-memory",
        "1G",
    ];
    assert_fails(&folder, &large, 1, &["--max-memory"]);
}

#[test]
fn a_fog_that_never_ends_is_refused_unless_it_is_cut_off() {
    let folder = Folder::new();
    let text = FOG
        .replace("LookAt", "MakeNamedMedium \"w\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0 0 0 ]\nMediumInterface \"\" \"w\"\nLookAt")
        .replace("MediumInterface \"m\" \"\"\nShape \"sphere\" \"float radius\" 1\n", "");
    folder.write("s.pbrt", &text);
    assert_fails(
        &folder,
        &["render", "s.pbrt"],
        1,
        &["never end", "--max-depth"],
    );
    folder.done(&["render", "s.pbrt", "-q", "--max-depth", "3"]);
}

/// White fog of 10³⁰ mean free paths would collide for ever: refused beforehand, with what to do.
#[test]
fn work_without_an_end_is_refused_unless_it_is_cut_off() {
    let folder = Folder::new();
    for (sigma_s, refused) in [("1e30", true), ("1e9", true), ("1e3", false)] {
        let medium = format!(
            "MakeNamedMedium \"w\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0 0 0 ] \"rgb sigma_s\" [ {sigma_s} {sigma_s} {sigma_s} ]\nLookAt"
        );
        let text = FOG
            .replacen("LookAt", &medium, 1)
            .replace("MediumInterface \"m\" \"\"", "MediumInterface \"w\" \"\"");
        folder.write("s.pbrt", &text);
        let tiny = [
            "render",
            "s.pbrt",
            "-q",
            "--resolution",
            "2x2",
            "--spp",
            "1",
        ];
        if refused {
            assert_fails(&folder, &tiny, 1, &["collide", "--max-depth"]);
            folder.done(&[&tiny[..], &["--max-depth", "3"]].concat());
        } else {
            folder.done(&tiny);
        }
    }
}

#[test]
fn a_failed_render_leaves_the_old_image_alone() {
    let folder = Folder::new();
    folder.write("s.pbrt", &FOG.replace("sphere", "sphre"));
    folder.write("fog.exr", "old");
    assert_fails(&folder, &["render", "s.pbrt"], 1, &["sphre"]);
    assert_eq!(
        std::fs::read(folder.path("fog.exr")).expect("there"),
        b"old"
    );
}
