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

/// Scene text, the whole error line without the file's name, and a part of the help.
const ERRORS: &[(&str, &str, &str)] = &[
    // The words.
    (
        "WorldBegin\n  Shpae \"sphere\"",
        "2:3: unknown directive Shpae",
        "did you mean Shape?",
    ),
    (
        "WorldBegin WorldEnd",
        "1:12: unknown directive WorldEnd",
        "remove it",
    ),
    ("WorldBegin 3", "1:12: unknown directive 3", ""),
    (
        "\"WorldBegin\"",
        "1:1: expected a directive, found \"WorldBegin\"",
        "",
    ),
    ("WorldBegin ]", "1:12: expected a directive, found ]", ""),
    (
        "Camera \"perspective\n",
        "1:8: this string has no closing quote",
        "",
    ),
    ("Camera \"a\\q\"", "1:10: unknown escape in a string", ""),
    (
        "Camera perspective",
        "1:8: expected a type in quotes, found perspective",
        "",
    ),
    (
        "Camera",
        "1:7: the file ends where a type in quotes should be",
        "",
    ),
    (
        "Camera \"perspectiv\"",
        "1:8: unknown camera \"perspectiv\"",
        "\"perspective\"?",
    ),
    // Parameters.
    (
        "Camera \"perspective\" \"float fovv\" 3 WorldBegin",
        "1:22: Camera \"perspective\" has no parameter \"fovv\"",
        "did you mean \"fov\"?",
    ),
    (
        "Camera \"perspective\" \"integer fov\" 3 WorldBegin",
        "1:22: \"fov\" of Camera \"perspective\" has type integer, expected float",
        "",
    ),
    (
        "Camera \"perspective\" \"flaot fov\" 3",
        "1:22: unknown parameter type \"flaot\"",
        "\"float\"?",
    ),
    (
        "Camera \"perspective\" \"point fov\" 3",
        "1:22: unknown parameter type \"point\"",
        "\"point3\"",
    ),
    (
        "Camera \"perspective\" \"fov\" 3",
        "1:22: expected a parameter's type and name",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" [3",
        "1:34: this bracket is never closed",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" [3\nWorldBegin",
        "2:1: expected a number, found WorldBegin",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" [[3]]",
        "1:35: expected a value or ], found another [",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" ]",
        "1:34: expected a value, found ]",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\"",
        "1:33: the file ends where a value should be",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" \"3\"",
        "1:34: expected a number, found \"3\"",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" [1 2] WorldBegin",
        "1:34: \"fov\" of Camera \"perspective\" takes 1 value, found 2",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" [nan]",
        "1:35: nan is not a finite number",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" 1e999",
        "1:34: 1e999 is not a finite number",
        "",
    ),
    (
        "Camera \"perspective\" \"float fov\" 180 WorldBegin",
        "1:34: \"fov\" of Camera \"perspective\" must be between 0 and 180 degrees, found 180",
        "",
    ),
    (
        "Film \"rgb\" \"integer xresolution\" 1.5",
        "1:34: expected an integer, found 1.5",
        "",
    ),
    (
        "Film \"rgb\" \"integer xresolution\" 0",
        "1:34: \"xresolution\" of Film \"rgb\" must be at least 1, found 0",
        "",
    ),
    (
        "Film \"rgb\" \"integer xresolution\" 99999999999",
        "1:34: expected an integer of at most 31 bits, found 99999999999",
        "",
    ),
    (
        "Film \"rgb\" \"integer xresolution\" 2000000000",
        "1:1: a film of 2000000000 x 720 pixels takes 80640000000000 bytes",
        "the limit is",
    ),
    (
        "Film \"rgb\" \"bool savefp16\" yes",
        "1:28: expected true or false, found yes",
        "",
    ),
    (
        "Film \"gbuffer\"",
        "1:6: film \"gbuffer\" is not yet supported",
        "\"rgb\"",
    ),
    (
        "Film \"rgb\" \"float cropwindow\" [.5 .5 0 1]",
        "1:31: no pixel is left",
        "x0 x1 y0 y1",
    ),
    (
        "Integrator \"bdpt\"",
        "1:12: integrator \"bdpt\" is not yet supported",
        "volpath",
    ),
    (
        "Option \"sed\" 3",
        "1:8: unknown option \"sed\"",
        "\"seed\"?",
    ),
    (
        "ColorSpace \"rec2020\"",
        "1:12: colour space \"rec2020\" is not yet supported",
        "",
    ),
    // Order and nesting.
    (
        "Shape \"sphere\"",
        "1:1: Shape must come after WorldBegin",
        "",
    ),
    (
        "WorldBegin Film \"rgb\"",
        "1:12: Film must come before WorldBegin",
        "",
    ),
    (
        "WorldBegin WorldBegin",
        "1:12: WorldBegin must come before WorldBegin",
        "",
    ),
    (
        "WorldBegin\n AttributeEnd",
        "2:2: AttributeEnd without AttributeBegin",
        "",
    ),
    (
        "WorldBegin AttributeBegin\nAttributeBegin AttributeEnd",
        "1:12: this AttributeBegin has no AttributeEnd",
        "",
    ),
    // Transformations.
    (
        "Scale 1 0 1",
        "1:1: the transformation is singular or not finite from here on",
        "",
    ),
    (
        "Translate 1 2",
        "1:1: the file ends after 2 of 3 numbers",
        "",
    ),
    (
        "Translate 1 2 WorldBegin",
        "1:15: expected a number, found WorldBegin",
        "",
    ),
    (
        "Rotate 1 0 0 0",
        "1:1: the axis of a rotation must not be zero",
        "",
    ),
    (
        "LookAt 0 0 0 0 1 0 0 1 0",
        "1:1: LookAt defines no direction",
        "",
    ),
    ("Transform 1 0", "1:11: expected [, found 1", ""),
    (
        "CoordSysTransform \"camra\"",
        "1:19: no coordinate system \"camra\"",
        "",
    ),
    (
        "ActiveTransform Start",
        "1:17: expected All, StartTime or EndTime",
        "",
    ),
    (
        "ActiveTransform EndTime Translate 1 0 0 Camera \"perspective\"",
        "1:41: transformations that change with time are not yet supported",
        "",
    ),
    // Media.
    (
        "MakeNamedMedium \"m\"",
        "1:17: medium \"m\" has no \"string type\"",
        "homogeneous",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogenous\"",
        "1:35: medium type \"homogenous\" is unknown",
        "\"homogeneous\"?",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"nanovdb\"",
        "1:35: medium type \"nanovdb\" is not yet supported",
        "openvdb",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 -2 3]",
        "1:66: \"sigma_s\" must not be negative, found -2",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 2]",
        "1:63: \"rgb sigma_s\" takes numbers in groups of 3, found 2",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"float g\" 1",
        "1:59: \"g\" of medium \"m\" (homogeneous) must be between -1 and 1, found 1",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb Le\" [1 1 1]",
        "1:49: parameter \"Le\" of medium \"m\" (homogeneous) is not yet supported",
        "do not emit",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"Skin1\"",
        "1:49: parameter \"preset\" of medium \"m\" (homogeneous) is not yet supported",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"draine\"",
        "1:64: phase function \"draine\" is not yet supported",
        "rayleigh",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"spectrum sigma_s\" [500 1 400 1]",
        "1:75: the wavelengths of a spectrum must increase",
        "nanometres",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\"",
        "2:17: medium \"m\" is defined twice",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 3 \"float density\" [1\n2 -3]",
        "2:3: density value 2 is negative: -3 at voxel (2, 0, 0)",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer ny\" 2 \"float density\" [1\nnan]",
        "2:1: nan is not a finite number",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 3 \"float density\" [1 2]",
        "1:80: 2 density values, but nx * ny * nz = 3 * 1 * 1 = 3",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 0 \"float density\" 1",
        "1:62: \"nx\" of medium \"m\" (uniformgrid) must be at least 1, found 0",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2000000000 \"integer ny\" 2000000000 \"integer nz\" 2000000000 \"float density\" 1",
        "1:1: a grid of 2000000000 x 2000000000 x 2000000000 voxels takes 32000000000000000000000000000 bytes",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 \"point3 p1\" [0 1 1]",
        "1:1: the box from p0 to p1 has no volume",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"openvdb\" \"string filename\" \"no.vdb\"",
        "1:63: there is no file no.vdb",
        "relative to",
    ),
    (
        "WorldBegin Material \"interface\" MediumInterface \"fgo\" \"\"\nShape \"sphere\" MakeNamedMedium \"fog\" \"string type\" \"homogeneous\"",
        "1:49: medium \"fgo\" is not defined",
        "\"fog\"?",
    ),
    // Shapes, lights, materials.
    (
        "WorldBegin Shape \"sphere\"",
        "1:12: this shape has pbrt's default material \"diffuse\", which is not yet supported",
        "Material \"interface\"",
    ),
    (
        "WorldBegin Material \"dielectric\"",
        "1:21: material \"dielectric\" is not yet supported",
        "\"interface\"",
    ),
    (
        "WorldBegin Material \"interfce\"",
        "1:21: material \"interfce\" is unknown",
        "\"interface\"?",
    ),
    (
        "WorldBegin Material \"interface\" NamedMaterial \"x\" Shape \"sphere\"",
        "1:47: material \"x\" is not defined",
        "",
    ),
    (
        "WorldBegin Shape \"disk\"",
        "1:18: shape \"disk\" is not yet supported",
        "plymesh",
    ),
    (
        "WorldBegin Shape \"sphere\" \"float radius\" -1",
        "1:42: \"radius\" of Shape \"sphere\" must be positive, found -1",
        "",
    ),
    (
        "WorldBegin Shape \"sphere\" \"float zmin\" 0",
        "1:27: parameter \"zmin\" of Shape \"sphere\" is not yet supported",
        "full spheres",
    ),
    (
        "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1\n3]",
        "2:1: index 3 names none of the 3 vertices",
        "",
    ),
    (
        "WorldBegin Shape \"plymesh\" \"string filename\" \"no.ply\"",
        "1:46: cannot read no.ply: no such file",
        "relative to",
    ),
    (
        "WorldBegin LightSource \"point\"",
        "1:24: light source \"point\" is not yet supported",
        "distant",
    ),
    (
        "WorldBegin LightSource \"infinite\" \"string filename\" \"sky.exr\"",
        "1:35: image environment maps are not yet supported",
        "",
    ),
    (
        "WorldBegin LightSource \"distant\" \"point3 to\" [0 0 0]",
        "1:12: \"from\" and \"to\" of a distant light must differ",
        "",
    ),
    (
        "WorldBegin LightSource \"infinite\" \"blackbody L\" -5",
        "1:49: a temperature must be positive, found -5",
        "",
    ),
    (
        "WorldBegin AreaLightSource \"diffuse\"",
        "1:28: area light \"diffuse\" is not yet supported",
        "",
    ),
    (
        "WorldBegin Texture \"t\" \"float\" \"constant\"",
        "1:20: textures are not yet supported: \"t\"",
        "",
    ),
    (
        "WorldBegin ObjectBegin \"o\"",
        "1:12: object instances are not yet supported",
        "",
    ),
    (
        "WorldBegin Attribute \"shap\" \"float radius\" 1",
        "1:22: unknown target \"shap\"",
        "shape, light",
    ),
    // Files.
    (
        "Include \"no.pbrt\"",
        "1:9: cannot read no.pbrt: no such file",
        "relative to",
    ),
    ("Include \"s.pbrt\"", "1:9: s.pbrt includes itself", ""),
    (
        "Import \"s.pbrt\"",
        "1:1: Import must come after WorldBegin",
        "",
    ),
];

#[test]
fn errors_name_line_column_and_what_to_do() {
    let mut wrong = String::new();
    for (text, expected, help) in ERRORS {
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
    for (text, expected, _) in ERRORS {
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
