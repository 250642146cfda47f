//! Scenes as text in the renderer's own language, and pictures of them through the library.
//!
//! Every suite writes its scenes here and not as structures, so that what is tested is what a user's file does.

use std::fmt::Write;
use std::ops::Range;
use std::path::Path;

use woodcock_core::path::{Counts, ShadowEstimator};
use woodcock_core::points::REPLICATE;
use woodcock_host::drive::Silent;
use woodcock_host::film::Film;
use woodcock_host::render::{Kernel, Plan, render_pass};
use woodcock_host::scene::{self, MemoryFiles, SceneError};
use woodcock_host::world::{self, Feature, World};

use crate::stats::{ImageMoments, Moments};

/// A point or a direction.
pub type Xyz = [f64; 3];

/// Name of the scene's file in memory.
pub const NAME: &str = "test.pbrt";

/// A whole scene: camera, size of the picture, and what follows `WorldBegin`.
pub fn scene(camera: &str, [width, height]: [u32; 2], world: &str) -> String {
    format!(
        "{camera}\nFilm \"rgb\" \"integer xresolution\" {width} \"integer yresolution\" {height}\nWorldBegin\n{world}\n"
    )
}

fn numbers(values: &[f64]) -> String {
    let mut text = String::from("[");
    for value in values {
        // Writing to a string cannot fail.
        let _ = write!(text, " {value}");
    }
    text + " ]"
}

fn look_at(from: Xyz, towards: Xyz) -> String {
    let at: Xyz = std::array::from_fn(|i| from[i] + towards[i]);
    let up = if towards[0].abs() + towards[2].abs() > 0.1 * towards[1].abs() {
        [0.0, 1.0, 0.0]
    } else {
        [0.0, 0.0, 1.0]
    };
    let values = [from, at, up].concat();
    let text: Vec<_> = values.iter().map(f64::to_string).collect();
    format!("LookAt {}", text.join(" "))
}

/// A pinhole camera; `fov` in degrees.
pub fn perspective(from: Xyz, towards: Xyz, fov: f64) -> String {
    format!(
        "{}\nCamera \"perspective\" \"float fov\" {fov}",
        look_at(from, towards)
    )
}

/// Parallel rays through a square of 2 × `half`.
pub fn orthographic(from: Xyz, towards: Xyz, half: f64) -> String {
    format!(
        "{}\nCamera \"orthographic\" \"float screenwindow\" {}",
        look_at(from, towards),
        numbers(&[-half, half, -half, half])
    )
}

/// One ray for all pixels, but for a hair's breadth.
pub fn single_ray(from: Xyz, towards: Xyz) -> String {
    orthographic(from, towards, 1e-7)
}

/// The same radiance from everywhere.
pub fn sky(radiance: f64) -> String {
    format!(
        "LightSource \"infinite\" \"rgb L\" {}\n",
        numbers(&[radiance; 3])
    )
}

/// Parallel light of irradiance 1 times `strength`, from where `towards` points.
pub fn sun(towards: Xyz, strength: Xyz) -> String {
    format!(
        "LightSource \"distant\" \"point3 from\" {} \"point3 to\" [ 0 0 0 ] \"rgb L\" {}\n",
        numbers(&towards),
        numbers(&strength)
    )
}

/// What scatters: coefficients by colour, and anything more.
#[derive(Clone, Debug, PartialEq)]
pub struct Matter {
    /// Absorption by colour [1/length].
    pub absorption: Xyz,
    /// Scattering by colour [1/length].
    pub scattering: Xyz,
    /// Further parameters, as text.
    pub more: String,
}

/// Grey matter of extinction `sigma_t`, scattering the share `albedo` with mean cosine `g`.
pub fn grey(sigma_t: f64, albedo: f64, g: f64) -> Matter {
    coloured([sigma_t * (1.0 - albedo); 3], [sigma_t * albedo; 3], g)
}

/// Matter by colour.
pub fn coloured(absorption: Xyz, scattering: Xyz, g: f64) -> Matter {
    Matter {
        absorption,
        scattering,
        more: format!("\"float g\" {g}"),
    }
}

/// Grey matter that scatters after Rayleigh.
pub fn rayleigh(sigma_t: f64, albedo: f64) -> Matter {
    Matter {
        more: "\"string phase\" \"rayleigh\"".to_owned(),
        ..grey(sigma_t, albedo, 0.0)
    }
}

fn medium(name: &str, kind: &str, matter: &Matter) -> String {
    format!(
        "MakeNamedMedium \"{name}\" {kind} \"rgb sigma_a\" {} \"rgb sigma_s\" {} {}\n",
        numbers(&matter.absorption),
        numbers(&matter.scattering),
        matter.more
    )
}

/// The same everywhere.
pub fn homogeneous(name: &str, matter: &Matter) -> String {
    medium(name, "\"string type\" \"homogeneous\"", matter)
}

/// Samples at the centres of the cells of a box from `low` to `high`, by a density of the place.
pub fn uniform_grid(
    name: &str,
    cells: [usize; 3],
    [low, high]: [Xyz; 2],
    density: impl Fn(Xyz) -> f64,
    matter: &Matter,
) -> String {
    let [nx, ny, nz] = cells;
    let mut values = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let cell = [x, y, z];
                values.push(density(std::array::from_fn(|i| {
                    let part = (cell[i] as f64 + 0.5) / cells[i] as f64;
                    low[i] + part * (high[i] - low[i])
                })));
            }
        }
    }
    let kind = format!(
        "\"string type\" \"uniformgrid\" \"integer nx\" {nx} \"integer ny\" {ny} \"integer nz\" {nz} \
         \"point3 p0\" {} \"point3 p1\" {} \"float density\" {}",
        numbers(&low),
        numbers(&high),
        numbers(&values)
    );
    medium(name, &kind, matter)
}

/// The grid `density` of a volume file.
pub fn openvdb(name: &str, file: &str, matter: &Matter) -> String {
    let kind = format!("\"string type\" \"openvdb\" \"string filename\" \"{file}\"");
    medium(name, &kind, matter)
}

fn within(inside: &str, outside: &str, shape: &str) -> String {
    format!(
        "AttributeBegin\nMaterial \"interface\"\nMediumInterface \"{inside}\" \"{outside}\"\n{shape}\nAttributeEnd\n"
    )
}

/// A ball of one medium in another.
pub fn ball(inside: &str, outside: &str, centre: Xyz, radius: f64) -> String {
    let [x, y, z] = centre;
    within(
        inside,
        outside,
        &format!("Translate {x} {y} {z}\nShape \"sphere\" \"float radius\" {radius}"),
    )
}

/// The corners' triangles of a block, normals outwards.
pub const BLOCK_TRIANGLES: &str =
    "[ 0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  3 7 6 3 6 2  0 4 7 0 7 3  1 2 6 1 6 5 ]";

/// A block with its faces along the axes, as a mesh.
pub fn block(inside: &str, outside: &str, [low, high]: [Xyz; 2]) -> String {
    within(inside, outside, &block_mesh([low, high]))
}

/// The shape of [`block`] alone.
pub fn block_mesh([low, high]: [Xyz; 2]) -> String {
    let corners = [0, 1, 3, 2, 4, 5, 7, 6].map(|i: usize| {
        std::array::from_fn::<_, 3, _>(|axis| {
            if i >> axis & 1 == 1 {
                high[axis]
            } else {
                low[axis]
            }
        })
    });
    format!(
        "Shape \"trianglemesh\" \"point3 P\" {} \"integer indices\" {BLOCK_TRIANGLES}",
        numbers(corners.as_flattened())
    )
}

/// A scene ready to be rendered in several ways.
#[derive(Debug)]
pub struct Studio {
    /// The scene, assembled.
    pub world: World,
    /// How it is rendered.
    pub plan: Plan,
}

/// Reads and assembles a scene.
///
/// # Errors
/// As reading and assembling do.
pub fn try_stage(
    text: &str,
    files: MemoryFiles,
    options: &world::Options,
) -> Result<Studio, SceneError> {
    let files = files.with(NAME, text.as_bytes());
    let reading = scene::Options {
        max_memory: options.limits.max_memory,
        ..scene::Options::default()
    };
    let scene = scene::read(Path::new(NAME), &files, &reading)?;
    let world = world::assemble(&scene, &files, options)?;
    let plan = Plan::new(
        &world,
        Kernel::Packet,
        woodcock_host::integrator::Integrator::Path,
        crate::stats::seed(1),
        ShadowEstimator::ByNeed,
        None,
    );
    Ok(Studio { world, plan }.apart())
}

/// Assembles a scene that has no files.
///
/// # Panics
/// When it cannot be assembled: a test's scene is right.
#[track_caller]
pub fn stage(text: &str) -> Studio {
    stage_keeping(text, &[])
}

/// The same, keeping features that the scene does not need.
///
/// # Panics
/// As [`stage`].
#[track_caller]
pub fn stage_keeping(text: &str, keep: &[Feature]) -> Studio {
    stage_with(text, MemoryFiles::new(), keep)
}

/// The same with files beside the scene.
///
/// # Panics
/// As [`stage`].
#[track_caller]
pub fn stage_with(text: &str, files: MemoryFiles, keep: &[Feature]) -> Studio {
    let options = world::Options {
        keep: keep.to_vec(),
        ..world::Options::default()
    };
    match try_stage(text, files, &options) {
        Ok(studio) => studio,
        Err(error) => panic!("{}", error.report()),
    }
}

/// A picture, with what was counted while it was taken.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The picture.
    pub film: Film,
    /// What was done for it.
    pub counts: Counts,
}

impl Studio {
    /// Renders `n` samples per pixel, times the environment's factor.
    pub fn shoot(&self, n: u32) -> Picture {
        let n = crate::stats::samples(n as usize) as u32;
        self.shoot_range(0..n)
    }

    /// The same with samples that are independent of each other: what pictures of few samples need for their variance.
    #[must_use]
    fn apart(mut self) -> Self {
        self.plan.replicate = 1;
        self.plan.settings.points = false;
        self
    }

    /// The same with points shared out among the samples of a replicate, as users get it.
    #[must_use]
    pub fn pointed(mut self) -> Self {
        self.plan.replicate = REPLICATE;
        self.plan.settings.points = true;
        self
    }

    /// The same with other random numbers.
    #[must_use]
    pub fn seeded(mut self, base: u64) -> Self {
        self.plan.seed = crate::stats::seed(base);
        self
    }

    /// Renders the samples with these indices, in one pass.
    pub fn shoot_range(&self, samples: Range<u32>) -> Picture {
        self.shoot_passes(std::slice::from_ref(&samples))
    }

    /// Renders these samples, pass by pass.
    pub fn shoot_passes(&self, passes: &[Range<u32>]) -> Picture {
        let mut film = self.plan.film(&self.world);
        let mut counts = Counts::default();
        for samples in passes {
            let pass = render_pass(&self.world, &self.plan, &mut film, samples.clone(), &Silent);
            counts.add(&pass);
        }
        Picture { film, counts }
    }
}

impl Picture {
    /// The means of all pixels, each as one weight: where every pixel sees the same, their mean and its error.
    pub fn moments(&self, channel: usize) -> Moments {
        self.film
            .pixels()
            .map(|(.., p)| p.mean()[channel])
            .collect()
    }

    /// One channel with its variance, for comparisons of images.
    pub fn image(&self, channel: usize) -> ImageMoments {
        let window = self.film.window();
        let [width, height] = window.size().map(|n| n as usize);
        let (mut mean, mut variance) = (vec![0.0; width * height], vec![0.0; width * height]);
        let mut samples = 0;
        for (x, y, pixel) in self.film.pixels() {
            let at = window.index(x, y);
            mean[at] = pixel.mean()[channel];
            variance[at] = pixel.variance_of_mean().map_or(f64::NAN, |v| v[channel]);
            samples = pixel.independent();
        }
        ImageMoments::new(width, mean, variance, samples.into())
    }

    /// Asserts what every picture owes: no dropped path, no look-up above its bound.
    ///
    /// # Panics
    /// When it does not hold.
    #[track_caller]
    pub fn assert_sound(&self, name: &str) -> &Self {
        assert_eq!(
            self.film.nonfinite().count,
            0,
            "{name}: paths were not finite"
        );
        assert_eq!(
            self.counts.majorant_violations, 0,
            "{name}: a bound was exceeded"
        );
        self
    }

    /// Asserts that every pixel and colour is `value` on every path, within `tolerance` of f32.
    ///
    /// # Panics
    /// When one is not.
    #[track_caller]
    pub fn assert_constant(&self, name: &str, value: f64, tolerance: f64) -> &Self {
        for (x, y, pixel) in self.film.pixels() {
            let deviations = pixel.variance_of_mean().unwrap_or([0.0; 3]);
            for (mean, variance) in pixel.mean().into_iter().zip(deviations) {
                assert!(
                    (mean - value).abs() <= tolerance && variance.sqrt() <= tolerance,
                    "{name}: pixel ({x}, {y}) is {mean} ± {} where every path brings {value}",
                    variance.sqrt()
                );
            }
        }
        self
    }
}
