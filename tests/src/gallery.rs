//! Small scenes with everything that scalar integrators meet, each of which converges soon.
//!
//! None of them has light that only some integrators find: what lamps without extent send through glass or by mirrors, path
//! tracing never meets, and light paths do where it falls on something rough. Lamps without extent stay outside of media, where next-event estimation would have no variance.

use std::io::Cursor;

use woodcock_core::path::ShadowEstimator;
use woodcock_host::film::Window;
use woodcock_host::image::{Channel, Image, exr};
use woodcock_host::integrator::Integrator;
use woodcock_host::render::{Kernel, Plan};
use woodcock_host::scene::MemoryFiles;

use crate::pictures::*;

/// Pixels along each side of a picture.
pub const SIDE: u32 = 24;

/// A scene to be rendered in several ways.
#[derive(Clone, Debug)]
pub struct Exhibit {
    /// What it shows.
    pub name: &'static str,
    /// Everything before `Film`.
    pub camera: String,
    /// Everything after `WorldBegin`.
    pub world: String,
    /// What it refers to.
    pub files: MemoryFiles,
    /// Scatterings; `None` is no limit.
    pub max_depth: Option<u32>,
}

impl Exhibit {
    /// A scene without files or limits.
    pub fn new(name: &'static str, camera: String, world: String) -> Self {
        Self {
            name,
            camera,
            world,
            files: MemoryFiles::new(),
            max_depth: None,
        }
    }

    /// The same with the pictures that some refer to.
    #[must_use]
    pub fn with_pictures(self) -> Self {
        Self {
            files: pictures(),
            ..self
        }
    }

    /// The same with a limit.
    #[must_use]
    pub fn limited(self, max_depth: u32) -> Self {
        Self {
            max_depth: Some(max_depth),
            ..self
        }
    }

    /// The text of the scene.
    pub fn text(&self) -> String {
        scene(&self.camera, [SIDE; 2], &self.world)
    }

    /// The scene, assembled for an integrator.
    ///
    /// # Panics
    /// When it cannot be.
    #[track_caller]
    pub fn stage(&self, integrator: Integrator, seed: u64) -> Studio {
        let studio = stage_with(&self.text(), self.files.clone(), &[]);
        replan(studio, integrator, seed, self.max_depth)
    }
}

/// The same scene for an integrator, under a limit.
#[must_use]
pub fn replan(
    mut studio: Studio,
    integrator: Integrator,
    seed: u64,
    max_depth: Option<u32>,
) -> Studio {
    studio.plan = Plan::new(
        &studio.world,
        Kernel::Packet,
        integrator,
        crate::stats::seed(seed),
        ShadowEstimator::ByNeed,
        max_depth,
    );
    studio
}

/// A picture in OpenEXR.
///
/// # Panics
/// When it cannot be written, which memory always can.
pub fn picture([width, height]: [u32; 2], value: impl Fn(u32, u32) -> Xyz) -> Vec<u8> {
    let mut picture = Image::new([width, height], Window::full([width, height]));
    for (channel, name) in ["R", "G", "B"].into_iter().enumerate() {
        let at = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        picture.channels.push(Channel {
            name: name.into(),
            values: at.map(|(x, y)| value(x, y)[channel] as f32).collect(),
        });
    }
    let mut bytes = Cursor::new(Vec::new());
    exr::write(&picture, &mut bytes).expect("memory");
    bytes.into_inner()
}

/// `sky.exr` with a bright spot, `tiles.exr` between 0 and 1, and `round.exr` for a lamp.
fn pictures() -> MemoryFiles {
    let sky = |x: u32, y: u32| {
        let bright = if (x, y) == (3, 2) { 25.0 } else { 0.0 };
        [0.2, 0.3, 0.5 + 0.05 * f64::from(y)].map(|c| c + bright)
    };
    let tiles = |x: u32, y: u32| match (x + y) % 3 {
        0 => [0.8, 0.2, 0.1],
        1 => [0.1, 0.7, 0.3],
        _ => [0.6, 0.6, 0.9],
    };
    let round =
        |x: u32, y: u32| [1.0, 0.9, 0.8].map(|c| c * (0.4 + 0.1 * f64::from(x % 3 + y % 4)));
    MemoryFiles::new()
        .with("sky.exr", picture([16, 8], sky))
        .with("tiles.exr", picture([6, 5], tiles))
        .with("round.exr", picture([8, 8], round))
}

/// A floor at −1 of a material.
pub fn floor(material: &str) -> String {
    with_material(
        material,
        "Shape \"trianglemesh\" \"point3 P\" [ -3 -1 -3  3 -1 -3  3 -1 3  -3 -1 3 ] \
         \"point2 uv\" [ 0 0 1 0 1 1 0 1 ] \"integer indices\" [ 0 1 2 0 2 3 ]",
    )
}

/// Diffuse matter.
pub fn diffuse(reflectance: Xyz) -> String {
    let [r, g, b] = reflectance;
    format!("Material \"diffuse\" \"rgb reflectance\" [ {r} {g} {b} ]")
}

/// Shapes of a material.
pub fn with_material(material: &str, shapes: &str) -> String {
    format!("AttributeBegin\n{material}\n{shapes}\nAttributeEnd\n")
}

/// A sphere, after whatever directives come first.
pub fn sphere(before: &str, [x, y, z]: Xyz, radius: f64) -> String {
    with_material(
        before,
        &format!("Translate {x} {y} {z}\nShape \"sphere\" \"float radius\" {radius}"),
    )
}

/// A lamp of a shape: black, but shining from the front.
pub fn lamp(radiance: Xyz, shape: &str) -> String {
    let [r, g, b] = radiance;
    with_material(
        &format!(
            "{}\nAreaLightSource \"diffuse\" \"rgb L\" [ {r} {g} {b} ]",
            diffuse([0.0; 3])
        ),
        shape,
    )
}

/// A point that shines.
pub fn point([x, y, z]: Xyz, intensity: f64) -> String {
    format!(
        "LightSource \"point\" \"point3 from\" [ {x} {y} {z} ] \"rgb I\" [ {intensity} {intensity} {intensity} ]\n"
    )
}

/// A disk that shines downwards from above.
pub fn disk_above(radiance: Xyz) -> String {
    lamp(
        radiance,
        "Translate 0.3 2 0\nRotate 90 1 0 0\nShape \"disk\" \"float radius\" 0.8",
    )
}

/// Where densities of grids lie.
pub const UNIT: [Xyz; 2] = [[-1.0; 3], [1.0; 3]];

/// A density with structure at the scale of voxels.
pub fn lumps([x, y, z]: Xyz) -> f64 {
    ((4.0 * x).sin() + (5.0 * y).cos() + (3.0 * z + 1.0).sin()).max(0.0)
}

/// The view that most have.
pub fn front() -> String {
    perspective([0.0, 0.7, -4.0], [0.0, -0.17, 1.0], 38.0)
}

/// Numbers of a grid of 4 × 5 × 6 voxels, as text.
fn voxels(per_voxel: usize, value: impl Fn(usize, [f64; 3]) -> f64) -> String {
    let mut text = String::new();
    for index in 0..4 * 5 * 6 {
        let at = [index % 4, index / 4 % 5, index / 20].map(|n| n as f64);
        for channel in 0..per_voxel {
            text += &format!("{:.4} ", value(channel, at));
        }
    }
    text
}

const CELLS: &str = "\"integer nx\" 4 \"integer ny\" 5 \"integer nz\" 6 \
    \"point3 p0\" [ -1 -1 -1 ] \"point3 p1\" [ 1 1 1 ]";

fn rgb_grid() -> String {
    format!(
        "MakeNamedMedium \"m\" \"string type\" \"rgbgrid\" {CELLS} \"rgb sigma_s\" [ {} ] \"rgb sigma_a\" [ {} ] \
         \"float g\" 0.3\n",
        voxels(3, |c, [x, y, z]| 0.4
            * (1.0
                + ((1.0 + c as f64) * x + y).sin()
                + (z * y).cos().abs())),
        voxels(3, |c, [x, y, _]| 0.2
            * (1.0 + (x - (2.0 - c as f64) * y).cos())),
    )
}

/// A grid that shines by `Le` and a grid of factors.
pub fn fire(strength: f64) -> String {
    format!(
        "MakeNamedMedium \"fire\" \"string type\" \"uniformgrid\" {CELLS} \"float density\" [ {} ] \
         \"rgb sigma_a\" [ 0.8 0.8 0.8 ] \"rgb sigma_s\" [ 0.4 0.4 0.4 ] \"rgb Le\" [ 3 1.5 0.5 ] \"float Lescale\" [ {} ]\n",
        voxels(1, |_, [x, y, z]| 0.6 + 0.5 * (x + 2.0 * y - z).sin()),
        voxels(1, |_, [x, y, z]| strength * (y * (x + z).cos()).max(0.0)),
    )
}

fn hot_grid() -> String {
    format!(
        "MakeNamedMedium \"hot\" \"string type\" \"uniformgrid\" {CELLS} \"float density\" [ {} ] \
         \"rgb sigma_a\" [ 1 1 1 ] \"rgb sigma_s\" [ 0.5 0.5 0.5 ] \"float temperature\" [ {} ]\n",
        voxels(1, |_, [x, y, z]| 0.5 + 0.3 * (x * y - z).sin()),
        voxels(1, |_, [x, y, z]| 900.0 + 350.0 * y + 100.0 * (x - z).sin()),
    )
}

/// A ball of a medium bounded by glass.
pub fn in_glass(inside: &str, outside: &str, centre: Xyz, radius: f64) -> String {
    sphere(
        &format!(
            "Material \"dielectric\" \"float eta\" 1.4\nMediumInterface \"{inside}\" \"{outside}\""
        ),
        centre,
        radius,
    )
}

/// All of them.
pub fn all() -> Vec<Exhibit> {
    let ground = floor(&diffuse([0.6, 0.5, 0.4]));
    let tinted = coloured([0.2, 0.5, 1.2], [2.0, 1.2, 0.6], 0.4);
    let fog = homogeneous("fog", &grey(0.5, 0.8, 0.3));
    let metals = sphere(
        "Material \"conductor\" \"float roughness\" 0.3",
        [-0.7, 0.0, 0.0],
        0.6,
    ) + &sphere("Material \"conductor\"", [0.6, -0.4, 0.3], 0.5)
        + &sphere(
            "Material \"dielectric\" \"float roughness\" 0.25",
            [0.7, 0.6, 0.0],
            0.45,
        );
    let grid = uniform_grid("m", [9, 8, 7], UNIT, lumps, &grey(2.5, 0.85, -0.2));
    let spot = "LightSource \"spot\" \"point3 from\" [ -1.5 2.5 -1 ] \"point3 to\" [ 0 -0.5 0 ] \
        \"rgb I\" [ 30 25 20 ] \"float coneangle\" 32 \"float conedeltaangle\" 10\n";
    vec![
        Exhibit::new(
            "a ball of fog by a point",
            front(),
            point([1.5, 2.0, -1.5], 8.0)
                + &ground
                + &homogeneous("m", &grey(1.5, 0.8, 0.4))
                + &ball("m", "", [0.0; 3], 0.9),
        ),
        Exhibit::new(
            "a grid by a spot and the sun",
            front(),
            spot.to_owned() + &sun([1.0, 1.5, -1.0], [0.6, 0.8, 1.0]) + &ground + &grid + &block("m", "", UNIT),
        )
        .limited(8),
        Exhibit::new(
            "an rgb grid under a triangle",
            front(),
            lamp(
                [6.0, 5.0, 7.0],
                "Shape \"trianglemesh\" \"point3 P\" [ -0.9 2 -0.9  0.9 2 -0.9  0 2 1 ] \"integer indices\" [ 0 1 2 ]",
            ) + &ground
                + &rgb_grid()
                + &block("m", "", UNIT),
        ),
        Exhibit::new(
            "a cloud on parallel rays",
            orthographic([0.0, 0.3, -4.0], [0.0, 0.0, 1.0], 1.2),
            sun([1.0, 1.5, -1.0], [2.0, 2.0, 2.0])
                + &sky(0.4)
                + "MakeNamedMedium \"m\" \"string type\" \"cloud\" \"float density\" 2 \"point3 p0\" [ -1 -1 -1 ] \
                   \"point3 p1\" [ 1 1 1 ] \"rgb sigma_a\" [ 0.5 0.5 0.5 ] \"rgb sigma_s\" [ 2 2 2 ]\n"
                + &block("m", "", UNIT),
        )
        .limited(6),
        Exhibit::new(
            "a caustic of glass in fog",
            front(),
            lamp([20.0, 20.0, 15.0], "Translate 0.6 2.4 0\nShape \"sphere\" \"float radius\" 0.5")
                + &ground
                + &fog
                + &ball("fog", "", [0.0, 0.1, 0.0], 1.6)
                + &in_glass("", "fog", [0.0, 0.1, 0.0], 0.6),
        )
        .limited(8),
        Exhibit::new(
            "metals under a picture",
            front(),
            "LightSource \"infinite\" \"string filename\" \"sky.exr\"\n".to_owned() + &ground + &metals,
        )
        .limited(6)
        .with_pictures(),
        Exhibit::new(
            "a texture under a patch",
            front(),
            lamp(
                [5.0; 3],
                "Shape \"bilinearmesh\" \"point3 P\" [ -0.8 1.8 -0.8  0.8 2 -0.8  -0.8 2.2 0.8  0.8 1.9 0.8 ]",
            ) + "Texture \"tiles\" \"spectrum\" \"imagemap\" \"string filename\" \"tiles.exr\" \"float uscale\" 2\n"
                + &floor("Material \"diffuse\" \"texture reflectance\" \"tiles\"")
                + &sphere("Material \"diffuse\" \"texture reflectance\" \"tiles\"", [0.0; 3], 0.7),
        )
        .with_pictures(),
        Exhibit::new(
            "fog that shines",
            front(),
            "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0.5 0.6 0.7 ] \
             \"rgb sigma_s\" [ 0.6 0.5 0.4 ] \"rgb Le\" [ 2 1 0.5 ]\n"
                .to_owned()
                + &ground
                + &ball("m", "", [0.0; 3], 0.9),
        ),
        Exhibit::new(
            "a fire over a floor",
            front(),
            fire(1.0) + &ground + &sphere(&diffuse([0.5; 3]), [1.2, -0.5, -0.5], 0.4) + &block("fire", "", UNIT),
        ),
        Exhibit::new(
            "a fire by its temperature and a lamp",
            front(),
            hot_grid() + &ground + &disk_above([1.0, 2.0, 4.0]) + &block("hot", "", UNIT),
        ),
        Exhibit::new(
            "coloured smoke under a disk",
            front(),
            disk_above([5.0, 6.0, 7.0]) + &ground + &homogeneous("m", &tinted) + &ball("m", "", [0.0; 3], 0.9),
        ),
        Exhibit::new(
            "media that overlap",
            front(),
            disk_above([4.0; 3])
                + &fog
                + &fire(0.5)
                + &homogeneous("smoke", &grey(2.0, 0.7, -0.3))
                + &ball("fog", "", [0.0; 3], 1.4)
                + &block("fire", "", [[-0.8, -0.9, -0.8], [0.5, 0.9, 0.8]])
                + &ball("smoke", "", [0.5, 0.1, 0.0], 0.6),
        ),
        Exhibit::new(
            "instances",
            front(),
            point([-1.0, 2.5, -2.0], 10.0)
                + &sky(0.2)
                + "ObjectBegin \"two\"\n"
                + &sphere(&diffuse([0.7, 0.3, 0.2]), [0.0; 3], 0.4)
                + &with_material(&diffuse([0.2, 0.6, 0.7]), &block_mesh([[-0.2, 0.3, -0.2], [0.4, 0.9, 0.3]]))
                + "ObjectEnd\nAttributeBegin Translate -0.7 -0.2 0 ObjectInstance \"two\" AttributeEnd\n\
                   AttributeBegin Translate 0.6 0 0.2 Rotate 40 0 1 0 Scale 1.2 0.8 1 ObjectInstance \"two\" AttributeEnd\n"
                + &ground,
        ),
        Exhibit::new(
            "a lens before fog",
            front() + " \"float lensradius\" 0.25 \"float focaldistance\" 3.4",
            disk_above([6.0; 3])
                + &ground
                + &sphere(&diffuse([0.7, 0.6, 0.2]), [-0.6, -0.4, -1.0], 0.4)
                + &homogeneous("m", &grey(1.5, 0.8, 0.0))
                + &ball("m", "", [0.5, 0.0, 0.5], 0.8),
        ),
        Exhibit::new(
            "a lens on parallel rays",
            orthographic([0.0, 0.6, -4.0], [0.0, -0.15, 1.0], 1.4)
                + " \"float lensradius\" 0.25 \"float focaldistance\" 3.4",
            disk_above([6.0; 3])
                + &ground
                + &sphere(&diffuse([0.7, 0.6, 0.2]), [-0.6, -0.4, -1.0], 0.4)
                + &homogeneous("m", &grey(1.5, 0.8, 0.0))
                + &ball("m", "", [0.5, 0.0, 0.5], 0.8),
        ),
        Exhibit::new(
            "a camera in fog",
            format!("MediumInterface \"\" \"fog\"\n{}", perspective([0.0, 0.2, -1.0], [0.0, -0.1, 1.0], 60.0)),
            "MediumInterface \"\" \"\"\n".to_owned()
                + &disk_above([8.0; 3])
                + &ground
                + &fog + &ball("fog", "", [0.0; 3], 1.5),
        ),
        Exhibit::new(
            "milk in a glass ball",
            front(),
            sky(0.5)
                + &disk_above([5.0; 3])
                + &ground
                + &homogeneous("milk", &coloured([0.2, 0.3, 0.6], [2.0, 2.0, 2.0], 0.5))
                + &in_glass("milk", "", [0.0; 3], 0.8),
        )
        .limited(8),
        Exhibit::new(
            "a thin pane before a ball",
            front(),
            disk_above([5.0; 3])
                + &sky(0.3)
                + &ground
                + &sphere(&diffuse([0.3, 0.5, 0.7]), [0.3, -0.4, 0.8], 0.6)
                + &with_material(
                    "Material \"thindielectric\"",
                    "Shape \"trianglemesh\" \"point3 P\" [ -1.5 -0.9 -0.3  0.5 -0.9 -0.5  0.5 1 -0.5  -1.5 1 -0.3 ] \
                     \"integer indices\" [ 0 1 2 0 2 3 ]",
                ),
        ),
        Exhibit::new(
            "a lamp with a picture",
            front(),
            "AttributeBegin Translate 1.3 1.9 -1.2 LightSource \"goniometric\" \"string filename\" \"round.exr\" \
             \"rgb I\" [ 9 8 7 ] AttributeEnd\n"
                .to_owned()
                + &ground
                + &homogeneous("m", &coloured([0.3; 3], [0.9, 0.6, 0.3], -0.4))
                + &ball("m", "", [-0.4, 0.0, 0.0], 0.7)
                + &sphere(&diffuse([0.3, 0.5, 0.7]), [0.6, -0.4, 0.3], 0.5),
        )
        .with_pictures(),
    ]
}
