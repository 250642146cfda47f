//! Shapes, materials, textures, lights, objects; integrators.

/// Scene text, the whole error line without the file's name, and a part of the help.
pub(super) const ERRORS: &[(&str, &str, &str)] = &[
    (
        "WorldBegin Material \"hair\"",
        "1:21: material \"hair\" is not yet supported",
        "conductor and interface",
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
        "WorldBegin Shape \"cylinder\"",
        "1:18: shape \"cylinder\" is not yet supported",
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
        "WorldBegin LightSource \"projection\"",
        "1:24: light source \"projection\" is not yet supported",
        "distant",
    ),
    (
        "WorldBegin LightSource \"infinite\" \"string filename\" \"sky.exr\"",
        "1:53: there is no file sky.exr",
        "relative to",
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
        "WorldBegin Attribute \"shap\" \"float radius\" 1",
        "1:22: unknown target \"shap\"",
        "shape, light",
    ),
    (
        "Integrator \"path\" \"bool regularize\" true",
        "1:19: parameter \"regularize\" of Integrator \"path\" is not yet supported",
        "bias",
    ),
    (
        "Integrator \"mlt\" \"integer chain\" 3 WorldBegin",
        "1:18: Integrator \"mlt\" has no parameter \"chain\"",
        "\"chains\"?",
    ),
    (
        "WorldBegin Shape \"disk\" \"float innerradius\" 1",
        "1:45: \"innerradius\" of Shape \"disk\" must be from 0 to below the radius, found 1",
        "",
    ),
    (
        "WorldBegin Shape \"disk\" \"float phimax\" 90",
        "1:25: parameter \"phimax\" of Shape \"disk\" is not yet supported",
        "full disks",
    ),
    (
        "WorldBegin Shape \"sphere\" \"float alpha\" .5",
        "1:27: parameter \"alpha\" of Shape \"sphere\" is not yet supported",
        "holes",
    ),
    (
        "WorldBegin MediumInterface \"m\" \"\" MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\n Shape \"disk\"",
        "2:2: a disk cannot separate media: it encloses nothing",
        "close the shape",
    ),
    (
        "WorldBegin MediumInterface \"m\" \"\" MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\n Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]",
        "2:2: the medium changes at a bent surface: patch 0 of this mesh is not planar",
        "triangles",
    ),
    (
        "WorldBegin Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0 2 2 2]",
        "1:44: this bilinearmesh has no \"integer indices\"",
        "single patch",
    ),
    (
        "WorldBegin Shape \"bilinearmesh\" \"point3 P\" [0 0 0] \"integer indices\" [0 0 0]",
        "1:70: 3 indices cannot be grouped into patches",
        "",
    ),
    (
        "WorldBegin Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [0 0 1 1]",
        "1:76: 2 pairs (u, v) for 3 vertices",
        "",
    ),
    (
        "WorldBegin Material \"diffuse\" \"rgb reflectance\" [.5 1.5 0]",
        "1:49: \"reflectance\" must not exceed 1, found 1.5",
        "more light",
    ),
    (
        "WorldBegin Material \"diffuse\" \"texture reflectance\" \"wood\"",
        "1:53: spectrum texture \"wood\" is not defined",
        "before they are used",
    ),
    (
        "WorldBegin Material \"diffuse\" \"texture displacement\" \"bumps\"",
        "1:31: parameter \"displacement\" of Material \"diffuse\" is not yet supported",
        "no bumps",
    ),
    (
        "WorldBegin Material \"dielectric\" \"float eta\" 0",
        "1:46: a refractive index must be positive, found 0",
        "",
    ),
    (
        "WorldBegin Material \"dielectric\" \"spectrum eta\" \"glass-BK77\"",
        "1:49: named spectrum \"glass-BK77\" is not yet supported",
        "\"glass-BK7\"?",
    ),
    (
        "WorldBegin Material \"dielectric\" \"spectrum eta\" [400 1.5 700 1.6]",
        "1:49: this refractive index changes with the wavelength, which is not yet supported",
        "glass",
    ),
    (
        "WorldBegin Material \"dielectric\" \"float roughness\" -1",
        "1:52: \"roughness\" must be 0 or more, found -1",
        "",
    ),
    (
        "WorldBegin Material \"dielectric\" \"texture roughness\" \"rough\"",
        "1:54: float texture \"rough\" is not defined",
        "before they are used",
    ),
    (
        "WorldBegin Material \"conductor\" \"spectrum eta\" \"metal-W-eta\"",
        "1:48: named spectrum \"metal-W-eta\" is not yet supported",
        "did you mean",
    ),
    (
        "WorldBegin Material \"conductor\" \"rgb reflectance\" [1 1 1] \"rgb k\" [1 1 1]",
        "1:59: give either \"reflectance\" or \"k\"",
        "",
    ),
    (
        "WorldBegin Material \"conductor\" \"rgb reflectance\" [1 2 1]",
        "1:51: \"reflectance\" must not exceed 1, found 2",
        "",
    ),
    (
        "WorldBegin MakeNamedMaterial \"m\" \"rgb reflectance\" [1 1 1]",
        "1:30: material \"m\" has no \"string type\"",
        "",
    ),
    (
        "WorldBegin MakeNamedMaterial \"m\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"m\" \"string type\" \"diffuse\"",
        "2:19: material \"m\" is defined twice",
        "",
    ),
    (
        "WorldBegin Texture \"t\" \"spectrum\" \"checkerboard\"",
        "1:35: spectrum texture \"checkerboard\" is not yet supported",
        "imagemap",
    ),
    (
        "WorldBegin Texture \"t\" \"float\" \"imagemap\"",
        "1:32: float texture \"imagemap\" is not yet supported",
        "constant",
    ),
    (
        "WorldBegin Texture \"t\" \"colour\" \"constant\"",
        "1:24: texture type \"colour\" is unknown",
        "spectrum",
    ),
    (
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\"",
        "1:64: there is no file no.png",
        "relative to",
    ),
    (
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"s.pbrt\" \"string mapping\" \"planar\"",
        "1:90: mapping \"planar\" is not yet supported",
        "\"uv\"",
    ),
    (
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"s.pbrt\" \"string wrap\" \"mirror\"",
        "1:87: unknown wrap \"mirror\"",
        "clamp",
    ),
    (
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"s.pbrt\" \"string encoding\" \"gamma x\"",
        "1:91: encoding \"gamma x\" has no positive number",
        "gamma 2.2",
    ),
    (
        "WorldBegin Texture \"t\" \"float\" \"constant\"\nTexture \"t\" \"float\" \"constant\"",
        "2:9: float texture \"t\" is defined twice",
        "",
    ),
    (
        "WorldBegin Texture \"t\" \"spectrum\" \"scale\" \"float scale\" -2",
        "1:57: \"scale\" of Texture \"scale\" must be 0 or more, found -2",
        "",
    ),
    (
        "WorldBegin LightSource \"pont\"",
        "1:24: light source \"pont\" is unknown",
        "\"point\"?",
    ),
    (
        "WorldBegin LightSource \"infinite\" \"string filename\" \"s.pbrt\" \"rgb L\" [1 1 1]",
        "1:62: an infinite light has either \"L\" or \"filename\"",
        "",
    ),
    (
        "WorldBegin LightSource \"infinite\" \"point3 portal\" [0 0 0 1 0 0 1 1 0 0 1 0]",
        "1:35: parameter \"portal\" of LightSource \"infinite\" is not yet supported",
        "",
    ),
    (
        "WorldBegin LightSource \"goniometric\"",
        "1:12: this goniometric light has no \"string filename\"",
        "",
    ),
    (
        "WorldBegin LightSource \"spot\" \"point3 to\" [0 0 0]",
        "1:12: \"from\" and \"to\" of a spotlight must differ",
        "",
    ),
    (
        "WorldBegin LightSource \"spot\" \"float coneangle\" 10 \"float conedeltaangle\" 20",
        "1:75: \"conedeltaangle\" of LightSource \"spot\" must be from 0 to the cone's angle, found 20",
        "",
    ),
    (
        "WorldBegin LightSource \"point\" \"rgb I\" [1 -1 1]",
        "1:43: \"I\" must not be negative, found -1",
        "",
    ),
    (
        "WorldBegin AreaLightSource \"diffus\"",
        "1:28: unknown area light \"diffus\"",
        "\"diffuse\"?",
    ),
    (
        "WorldBegin AreaLightSource \"diffuse\" \"string filename\" \"a.exr\"",
        "1:38: parameter \"filename\" of AreaLightSource \"diffuse\" is not yet supported",
        "one radiance",
    ),
    (
        "WorldBegin AreaLightSource \"diffuse\" \"float power\" 5 Scale 1 1 2\nShape \"sphere\"",
        "2:1: the \"power\" of a stretched sphere's light is not yet supported",
        "\"L\"",
    ),
    (
        "WorldBegin AreaLightSource \"diffuse\" \"float power\" 5\nShape \"trianglemesh\" \"point3 P\" [0 0 0 0 0 0 0 0 0]",
        "2:1: the light of this shape is too bright: [inf, inf, inf]",
        "",
    ),
    (
        "WorldBegin ObjectBegin \"o\" ObjectBegin \"p\"",
        "1:28: objects cannot be defined within objects",
        "",
    ),
    (
        "WorldBegin ObjectBegin \"o\" ObjectEnd ObjectBegin \"o\"",
        "1:50: object \"o\" is defined twice",
        "",
    ),
    (
        "WorldBegin ObjectBegin \"oak\" ObjectEnd ObjectInstance \"oka\"",
        "1:55: object \"oka\" is not defined",
        "\"oak\"?",
    ),
    (
        "WorldBegin ObjectBegin \"o\" ObjectInstance \"o\"",
        "1:28: objects cannot be placed within objects",
        "",
    ),
    (
        "WorldBegin ObjectBegin \"o\"\nAttributeEnd",
        "2:1: AttributeEnd does not match the block that is open",
        "",
    ),
    (
        "WorldBegin ObjectBegin \"o\"",
        "1:12: this ObjectBegin has no ObjectEnd",
        "",
    ),
    (
        "WorldBegin AreaLightSource \"diffuse\" ObjectBegin \"o\"\nShape \"sphere\" ObjectEnd",
        "2:1: shapes within objects cannot be lights",
        "into the world",
    ),
];
