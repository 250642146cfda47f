//! Words, parameters, order, transformations, files.

/// Scene text, the whole error line without the file's name, and a part of the help.
pub(super) const ERRORS: &[(&str, &str, &str)] = &[
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
        "Integrator \"sppm\"",
        "1:12: integrator \"sppm\" is not yet supported",
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
