//! `woodcock compare`: the same picture or not.

use super::{FOG, Folder};

fn rendered() -> Folder {
    let folder = Folder::new();
    folder.write("fog.pbrt", FOG);
    let brighter = FOG.replace("0.4 0.5 0.8", "0.404 0.505 0.808");
    assert_ne!(brighter, FOG);
    folder.write("brighter.pbrt", &brighter);
    for (name, scene, more) in [
        ("a.exr", "fog.pbrt", &["--seed", "1", "--spp", "64"][..]),
        (
            "b.exr",
            "fog.pbrt",
            &["--seed", "2", "--spp", "256", "--kernel", "scalar"],
        ),
        (
            "adaptive.exr",
            "fog.pbrt",
            &["--seed", "3", "--target-error", "4%"],
        ),
        (
            "brighter.exr",
            "brighter.pbrt",
            &["--seed", "4", "--spp", "512"],
        ),
        (
            "light.exr",
            "fog.pbrt",
            &["--seed", "5", "--spp", "16", "--integrator", "bdpt"],
        ),
        ("one.exr", "fog.pbrt", &["--seed", "6", "--spp", "1"]),
        (
            "small.exr",
            "fog.pbrt",
            &["--seed", "7", "--spp", "64", "--resolution", "8x6"],
        ),
    ] {
        folder.done(&[&["render", scene, "-q", "-o", name], more].concat());
    }
    folder
}

#[test]
fn pictures_of_one_scene_agree_and_others_differ() {
    let folder = rendered();
    for other in ["b.exr", "adaptive.exr", "light.exr", "a.exr"] {
        let run = folder.done(&["compare", "a.exr", other]);
        assert!(run.stdout.contains("the images agree"), "{}", run.stdout);
        assert!(run.stdout.contains("relMSE"), "{}", run.stdout);
    }
    let run = folder.done(&["compare", "a.exr", "a.exr"]);
    assert!(run.stdout.contains("one seed"), "{}", run.stdout);
    // One per cent more light.
    let run = folder.run(&["compare", "b.exr", "brighter.exr"]);
    assert_eq!(run.code, Some(1), "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("the images differ"), "{}", run.stdout);
    assert!(run.stdout.contains("different scenes"), "{}", run.stdout);
    assert_eq!(run.stderr, "");
}

#[test]
fn what_cannot_be_compared_is_an_error() {
    let folder = rendered();
    for (line, words) in [
        (["a.exr", "small.exr"], "differ in size"),
        (["a.exr", "one.exr"], "one.exr: a variance needs two"),
        (["a.exr", "none.exr"], "none.exr: "),
        (["fog.pbrt", "a.exr"], "fog.pbrt: "),
    ] {
        let run = folder.run(&["compare", line[0], line[1]]);
        assert_eq!(run.code, Some(1), "{line:?}");
        assert!(run.stderr.starts_with("error: "), "{}", run.stderr);
        assert!(run.stderr.contains(words), "{}", run.stderr);
        assert_eq!(run.stdout, "");
    }
    assert_eq!(folder.run(&["compare", "a.exr"]).code, Some(2));
    let line = ["compare", "a.exr", "b.exr", "--false-alarms", "0"];
    assert_eq!(folder.run(&line).code, Some(2));
}
