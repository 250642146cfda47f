//! Media: their densities, phase functions and light.

/// Scene text, the whole error line without the file's name, and a part of the help.
pub(super) const ERRORS: &[(&str, &str, &str)] = &[
    (
        "MakeNamedMedium \"m\"",
        "1:17: medium \"m\" has no \"string type\"",
        "homogeneous",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogenous\"",
        "1:35: unknown medium type \"homogenous\"",
        "\"homogeneous\"?",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"nanovdb\"",
        "1:1: this nanovdb medium has no \"string filename\"",
        "",
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
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"Skin3\"",
        "1:65: unknown preset \"Skin3\"",
        "did you mean",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"Skin1\" \"rgb sigma_s\" [1 1 1]",
        "1:73: give either \"preset\" or \"sigma_s\"",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"mie\"",
        "1:64: phase function \"mie\" is not yet supported",
        "droplets",
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
    (
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\"",
        "1:1: this rgbgrid has neither \"rgb sigma_a\" nor \"rgb sigma_s\"",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"rgb sigma_s\" [1 1 1] \"rgb Le\" [1 1 1]",
        "1:1: an rgbgrid with \"Le\" needs \"rgb sigma_a\", as in pbrt",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"integer nx\" 2 \"rgb sigma_s\" [1 1 1]",
        "1:74: 1 values of sigma_s, but nx * ny * nz = 2 * 1 * 1 = 2",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" \"integer nx\" 2 \"rgb sigma_s\" [1 1 1 1 -1 1]",
        "1:83: sigma_s 4 is negative: -1 at voxel (1, 0, 0)",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"cloud\" \"float density\" -1",
        "1:59: \"density\" of medium \"m\" (cloud) must be 0 or more, found -1",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"vol\" \"string filename\" \"s.pbrt\" \"string albedofilename\" \"no.vol\"",
        "1:92: there is no file no.vol",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 \"float temperature\" 300 \"rgb Le\" [1 1 1]",
        "1:91: a medium has either \"Le\" or a temperature",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"openvdb\" \"string filename\" \"s.pbrt\" \"rgb Le\" [1 1 1] \"float temperaturescale\" 2",
        "1:72: a medium has either \"Le\" or a temperature",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 \"float temperature\" [300 2]",
        "1:87: 2 temperature values, but nx * ny * nz = 1 * 1 * 1 = 1",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"float density\" 1 \"float temperaturecutoff\" 3",
        "1:67: parameter \"temperaturecutoff\" of medium \"m\" (uniformgrid) is not yet supported",
        "temperatureoffset",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb Le\" [1 1 1] \"float Lescale\" -1",
        "1:82: \"Lescale\" of medium \"m\" (homogeneous) must be 0 or more, found -1",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"draine\"",
        "1:64: phase \"draine\" needs \"float alpha\"",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"twolobe\" \"float g\" .5 \"float share\" 1",
        "1:64: phase \"twolobe\" needs \"float g2\"",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"twolobe\" \"float share\" 2",
        "1:88: \"share\" of medium \"m\" (homogeneous) must be from 0 to 1, found 2",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"droplets\" \"float diameter\" 51",
        "1:92: \"diameter\" of medium \"m\" (homogeneous) must be above 0 and at most 50 micrometres, found 51",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"droplets\" \"float diameter\" 5 \"float g\" .5",
        "1:64: phase \"droplets\" has no \"g\", but g is 0.5",
        "",
    ),
    (
        "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string phase\" \"hg\" \"float alpha\" 1 WorldBegin",
        "1:69: medium \"m\" (homogeneous) has no parameter \"alpha\"",
        "",
    ),
];
