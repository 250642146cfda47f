//! What the pbrt reader says about wrong scenes, to the column.

use std::path::Path;

use woodcock_host::scene::{MemoryFiles, Options, Scene, SceneError, read};

fn read_with(files: MemoryFiles, lenient: bool) -> Result<Scene, SceneError> {
    let options = Options {
        lenient,
        max_memory: 1 << 26,
    };
    read(Path::new("s.pbrt"), &files, &options)
}

fn files(text: impl Into<Vec<u8>>) -> MemoryFiles {
    MemoryFiles::new().with("s.pbrt", text)
}

fn fails(text: &str) -> SceneError {
    match read_with(files(text), false) {
        Ok(_) => panic!("accepted: {text}"),
        Err(error) => error,
    }
}

mod language;
mod media;
mod surfaces;

/// Scene text, the whole error line without the file's name, and a part of the help.
const ERRORS: [&[(&str, &str, &str)]; 3] = [language::ERRORS, media::ERRORS, surfaces::ERRORS];

#[test]
fn errors_name_line_column_and_what_to_do() {
    let mut wrong = String::new();
    for (text, expected, help) in ERRORS.concat() {
        let error = fails(text);
        let said = error.to_string();
        let help_said = error.help_text().unwrap_or("");
        if said != format!("s.pbrt:{expected}") || !help_said.contains(help) {
            wrong += &format!("{text}\n  {said}\n  {help_said}\n  expected {expected}; {help}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
    assert_eq!(fails("").to_string(), "s.pbrt: the scene has no WorldBegin");
}

#[test]
fn reports_carry_carets() {
    let error = fails("# a fog\nMediumInterface \"fog\" \"\"\nCamera \"perspectve\" # here\n");
    assert_eq!(
        error.report(),
        "error: unknown camera \"perspectve\"\n --> s.pbrt:3:8\n  |\n3 | Camera \"perspectve\" # here\n  \
         |        ^^^^^^^^^^^^\nhelp: did you mean \"perspective\"?\n"
    );
}

#[test]
fn errors_in_included_files_point_into_them() {
    let scene = files("WorldBegin\nInclude \"a.pbrt\"");
    let error = read_with(scene.clone().with("a.pbrt", "\n\n Shape"), false);
    let error = error.map(|_| ()).expect_err("no type").to_string();
    assert_eq!(
        error,
        "a.pbrt:3:7: the file ends where a type in quotes should be"
    );
    let error = read_with(scene.clone().with("a.pbrt", "Include \"s.pbrt\""), false);
    let error = error.map(|_| ()).expect_err("a cycle").to_string();
    assert_eq!(error, "a.pbrt:1:9: s.pbrt includes itself");
    // An import may neither leave a block open nor close one of its importer.
    let scene = files("WorldBegin AttributeBegin Import \"a.pbrt\" AttributeEnd");
    for (body, place) in [
        ("AttributeBegin", "a.pbrt:1:1"),
        (" AttributeEnd", "a.pbrt:1:2"),
    ] {
        let error = read_with(scene.clone().with("a.pbrt", body), false);
        let error = error.map(|_| ()).expect_err("unbalanced").to_string();
        assert!(error.starts_with(place), "{error}");
    }
    // Files that include each other twice would double without end.
    let mut doubling = files("Include \"0\" WorldBegin").with("40", "");
    for i in 0..40 {
        let twice = format!("Include \"{0}\" Include \"{0}\"", i + 1);
        doubling = doubling.with(i.to_string(), twice);
    }
    let error = read_with(doubling, false).map(|_| ()).expect_err("endless");
    assert!(error.message().contains("files are included"), "{error}");
}

#[test]
fn bytes_that_are_not_text_are_places_too() {
    let scene = files(b"# caf\xe9\n\"\xff\xfe\" ".to_vec());
    let error = read_with(scene, false).map(|_| ()).expect_err("bytes");
    assert!(error.to_string().starts_with("s.pbrt:2:1: "), "{error}");
    assert!(!error.report().is_empty());
    let scene = files(b"Camera \"perspective\" \"float \xff\" 1".to_vec());
    let error = read_with(scene, false).map(|_| ()).expect_err("bytes");
    assert_eq!(error.to_string(), "s.pbrt:1:22: this string is not UTF-8");
    let utf16 = files(b"\xff\xfeW\0o\0".to_vec());
    assert!(read_with(utf16, false).is_err());
}

#[test]
fn lenient_reading_warns_instead() {
    let mut refused = 0;
    for (text, expected, _) in ERRORS.concat() {
        if !expected.contains("not yet supported") && !expected.contains("unknown") {
            continue;
        }
        let world = if text.contains("WorldBegin") {
            ""
        } else {
            " WorldBegin"
        };
        let end = if text.contains("ObjectBegin") {
            " ObjectEnd"
        } else {
            ""
        };
        let text = format!("{text}{world}{end}");
        match read_with(files(text.as_str()), true) {
            Ok(scene) => assert!(!scene.warnings.is_empty(), "silent: {text}"),
            // Escapes are damage, not something unknown.
            Err(error) => assert!(error.message().contains("escape"), "{error}"),
        }
        refused += 1;
    }
    assert!(refused >= 25, "{refused}");
    let scene = read_with(
        files(
            "WorldBegin Blorb 1 [2 3] \"x\" ObjectBegin \"o\" Shape \"sphere\" ObjectEnd
            Material \"glass\" Shape \"sphere\" MediumInterface \"m\" \"\" Shape \"sphere\"
            MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float gg\" 1",
        ),
        true,
    );
    let scene = scene.expect("lenient");
    assert_eq!(
        scene.boundaries.len(),
        1,
        "a transition stays, a plain surface goes"
    );
    let first = scene.warnings[0].report();
    assert!(
        first.starts_with("warning: unknown directive Blorb\n --> s.pbrt:1:12\n"),
        "{first}"
    );
}
