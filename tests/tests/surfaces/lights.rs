//! Which light is sampled, how, and how often.
//!
//! Scenes are put together as structures: what the scene language says of lights is another suite's matter.

mod adjoint;
mod choice;
mod departures;
mod emitters;

mod errors;
mod points;
mod skies;

use std::f64::consts::PI;
use std::io::Cursor;
use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DVec3};
use woodcock_host::film::Window;
use woodcock_host::image::{Channel, Image, exr};
use woodcock_host::light::{Bounds, LightSample, Lights};
use woodcock_host::scene::{
    self, AreaEmission, ConstantLight, DistantLight, GoniometricLight, ImageLight, Light,
    MemoryFiles, Options, Place, PointLight, Scene, SceneError, Shape, Source, Sphere, SpotLight,
    Surface, TriangleMesh,
};
use woodcock_host::surface::Surfaces;
use woodcock_host::volume::Limits;
use woodcock_tests::stats::independent::SplitMix;

/// Around everything that these scenes hold.
const BOUNDS: Bounds = Bounds {
    centre: DVec3::new(0.25, -0.5, 0.125),
    radius: 5.0,
};

/// Where the world as rendered has its origin.
const ORIGIN: DVec3 = DVec3::new(100.0, -200.0, 50.0);

fn empty_scene() -> Scene {
    let files = MemoryFiles::new().with("test.pbrt", "WorldBegin\n");
    scene::read(Path::new("test.pbrt"), &files, &Options::default()).expect("a scene")
}

fn place() -> Place {
    Place::new(&Source::new("test.pbrt", b"LightSource".to_vec()), 0, 11)
}

/// A scene with its files, of lights placed relative to [`ORIGIN`].
struct Setting {
    scene: Scene,
    files: MemoryFiles,
}

impl Setting {
    fn new(lights: impl IntoIterator<Item = Light>) -> Self {
        let mut scene = empty_scene();
        scene.lights = lights.into_iter().collect();
        Self {
            scene,
            files: MemoryFiles::new(),
        }
    }

    fn file(mut self, name: &str, bytes: Vec<u8>) -> Self {
        self.files = self.files.with(name, bytes);
        self
    }

    fn with(mut self, surfaces: impl IntoIterator<Item = Surface>) -> Self {
        self.scene.surfaces.extend(surfaces);
        self
    }

    fn surfaces(&self) -> Surfaces {
        Surfaces::new(&self.scene, ORIGIN).expect("surfaces")
    }

    fn try_lights(&self) -> Result<Lights, SceneError> {
        let limits = Limits::default();
        let surfaces = self.surfaces();
        Lights::new(&self.scene, &surfaces, BOUNDS, ORIGIN, &self.files, &limits)
    }

    fn lights(&self) -> Lights {
        self.try_lights().expect("lights")
    }
}

/// A shape that shines, placed relative to [`ORIGIN`] already.
fn shining(shape: Shape, radiance: [f64; 3], two_sided: bool) -> Surface {
    Surface {
        shape,
        flipped: false,
        material: None,
        emission: Some(AreaEmission {
            radiance,
            two_sided,
        }),
        place: place(),
    }
}

/// Triangles, each of its own three corners.
fn triangles(corners: &[[DVec3; 3]]) -> Shape {
    Shape::TriangleMesh(Arc::new(TriangleMesh {
        positions: corners.iter().flatten().map(|p| ORIGIN + *p).collect(),
        indices: (0..corners.len() as u32)
            .map(|i| [0, 1, 2].map(|k| 3 * i + k))
            .collect(),
        ..TriangleMesh::default()
    }))
}

fn ball(centre: DVec3, radius: f64) -> Shape {
    Shape::Sphere(Sphere {
        radius,
        object_to_world: DAffine3::from_translation(ORIGIN + centre),
    })
}

fn point(at: DVec3, intensity: [f64; 3]) -> Light {
    Light::Point(PointLight {
        position: ORIGIN + at,
        intensity,
        place: place(),
    })
}

fn spot(at: DVec3, axis: DVec3, cosines: [f64; 2], intensity: [f64; 3]) -> Light {
    Light::Spot(SpotLight {
        position: ORIGIN + at,
        axis: axis.normalize(),
        cos_falloff_start: cosines[0],
        cos_total_width: cosines[1],
        intensity,
        place: place(),
    })
}

fn distant(towards: DVec3, irradiance: [f64; 3]) -> Light {
    Light::Distant(DistantLight {
        direction_to_light: towards.normalize(),
        irradiance,
        place: place(),
    })
}

fn constant(radiance: [f64; 3]) -> Light {
    Light::Constant(ConstantLight {
        radiance,
        place: place(),
    })
}

fn image(filename: &str, light_to_world: DAffine3) -> Light {
    Light::Image(ImageLight {
        filename: filename.into(),
        scale: 1.0,
        illuminance: None,
        light_to_world,
        place: place(),
    })
}

fn goniometric(filename: &str, light_to_world: DAffine3, power: Option<f64>) -> Light {
    Light::Goniometric(GoniometricLight {
        filename: filename.into(),
        light_to_world: DAffine3::from_translation(ORIGIN) * light_to_world,
        intensity: [1.0, 2.0, 3.0],
        power,
        place: place(),
    })
}

/// An OpenEXR picture whose colours are 1, 0.5 and 0.25 times a value by column and row.
fn picture([width, height]: [u32; 2], value: impl Fn(u32, u32) -> f64) -> Vec<u8> {
    let mut picture = Image::new([width, height], Window::full([width, height]));
    for (name, factor) in [("R", 1.0), ("G", 0.5), ("B", 0.25)] {
        let at = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        picture.channels.push(Channel {
            name: name.into(),
            values: at.map(|(x, y)| (factor * value(x, y)) as f32).collect(),
        });
    }
    let mut bytes = Cursor::new(Vec::new());
    exr::write(&picture, &mut bytes).expect("memory");
    bytes.into_inner()
}

/// Mean of [`picture`]'s colours where its value is one.
const TINT: f64 = 1.75 / 3.0;

fn mean(colour: [f64; 3]) -> f64 {
    (colour[0] + colour[1] + colour[2]) / 3.0
}

/// A turn about an axis that is none of the frame's, with a mirror, an even scale, and a shift.
fn turned() -> DAffine3 {
    let axis = DVec3::new(1.0, 2.0, -0.5).normalize();
    let turn = DAffine3::from_axis_angle(axis, 1.1);
    DAffine3::from_translation(DVec3::new(0.5, 1.0, -0.75))
        * turn
        * DAffine3::from_scale(DVec3::new(-2.0, 2.0, 2.0))
}

fn uniforms<const N: usize>(rng: &mut SplitMix) -> [f64; N] {
    std::array::from_fn(|_| rng.uniform())
}

/// A direction with cosine 2u − 1 to +z.
fn sphere([u, v]: [f64; 2]) -> DVec3 {
    let z = 2.0 * u - 1.0;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * v).sin_cos();
    DVec3::new(r * cos, r * sin, z)
}

/// What a sample adds to the irradiance on a surface (only from the side of its normal), or in space, without a
/// normal, to the fluence; colours averaged.
fn weight(sample: &LightSample, normal: DVec3) -> f64 {
    let cos = if normal == DVec3::ZERO {
        1.0
    } else {
        normal.dot(sample.direction).max(0.0)
    };
    mean(sample.radiance) * cos / (sample.pdf * sample.choice)
}
