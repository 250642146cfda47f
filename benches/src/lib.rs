//! What the benches share: media to track through, rays through them, and rounds that interleave what is
//! compared.
#![forbid(unsafe_code)]

pub mod agreement;
pub mod analog;
pub mod choice;
pub mod measure;
pub mod noise;
pub mod passing;
pub mod picture;
pub mod plot;
pub mod profile;
pub mod relative;
pub mod shadow;
pub mod vdb;
pub mod yardstick;

use woodcock_core::majorant::{MajorantError, fill_majorants, majorant_count};
use woodcock_core::ray::clip_to_box;
use woodcock_core::stream::{Key, PathStream, Stream};
use woodcock_core::vec3::Vec3;
use woodcock_packet::bundle::{Bundle, BundleRay};

/// Rays of a bundle.
pub const RAYS: usize = 256;
/// Bundles of a round: the same rays with other random numbers.
pub const BUNDLES: usize = 32;

/// Samples of a cube with bounds: clumps in a ball, a third of it empty, with voxel noise.
#[derive(Clone, Debug)]
pub struct Cube {
    /// Samples along each axis.
    pub side: u32,
    /// Samples, x fastest.
    pub samples: Vec<f32>,
    /// Bounds of blocks.
    pub majorants: Vec<f32>,
}

impl Cube {
    /// A cube of `side`³ samples.
    ///
    /// # Errors
    /// A side that no grid can have.
    pub fn new(side: u32) -> Result<Self, MajorantError> {
        let dims = [side; 3];
        let scale = 1.0 / (side - 1) as f32;
        let mut noise = PathStream::new(Key {
            seed: 17,
            pixel: side,
            sample: 0,
        });
        let mut samples = Vec::new();
        for z in 0..side {
            for y in 0..side {
                for x in 0..side {
                    let p = [x, y, z].map(|i| i as f32 * scale - 0.5);
                    let radius = p.iter().map(|c| c * c).sum::<f32>().sqrt();
                    let clump = (p[0] * 23.0).sin() * (p[1] * 19.0).cos() * (p[2] * 29.0).sin();
                    let grain: f32 = noise.uniform(true);
                    let density = (clump + 0.3).max(0.0) * (0.8 + 0.2 * grain);
                    samples.push(if radius < 0.5 { density } else { 0.0 });
                }
            }
        }
        let count = majorant_count(dims).ok_or(MajorantError::Dimensions(dims))?;
        let mut majorants = vec![0.0; count];
        fill_majorants(&samples, dims, &mut majorants)?;
        Ok(Self {
            side,
            samples,
            majorants,
        })
    }
}

/// Rays from the face z = 0 of a cube of the given edge to the one opposite, in random directions.
pub fn rays(edge: f32, bundle: usize) -> Vec<BundleRay> {
    let ray = |index: usize| {
        let mut rng = PathStream::new(Key {
            seed: 5,
            pixel: index as u32,
            sample: 0,
        });
        let mut u = || Stream::<f32>::uniform(&mut rng, true) * edge;
        let (from, to) = ([u(), u(), 0.0], [u(), u(), edge]);
        let way = [0, 1, 2].map(|i| to[i] - from[i]);
        let t_max = way.iter().map(|c| c * c).sum::<f32>().sqrt();
        BundleRay {
            origin: from,
            direction: way.map(|c| c / t_max),
            t_max,
            key: Key {
                seed: 1,
                pixel: index as u32,
                sample: bundle as u32,
            },
        }
    };
    (0..RAYS).map(ray).collect()
}

/// The same rays for scalar code and for packets, in all bundles of a round.
#[derive(Clone, Debug)]
pub struct Work {
    /// Rays with their streams at the beginning, so that keying them is nobody's cost.
    pub singles: Vec<Vec<(BundleRay, PathStream)>>,
    /// The same in columns.
    pub bundles: Vec<Bundle>,
}

impl Work {
    /// Rays through a cube of the given edge, the same in all bundles.
    pub fn new(edge: f32) -> Self {
        Self::of((0..BUNDLES).map(|bundle| rays(edge, bundle)).collect())
    }

    /// Rays as after many scatterings: from anywhere in a cube of the given edge to anywhere, no two alike.
    ///
    /// * `batch`: another one, other rays.
    pub fn scattered(edge: f32, batch: usize) -> Self {
        let ray = |bundle: usize, index: usize| {
            let sample = (batch * BUNDLES + bundle) as u32;
            let pixel = index as u32;
            let mut rng = PathStream::new(Key {
                seed: 6,
                pixel,
                sample,
            });
            let mut u = || Stream::<f32>::uniform(&mut rng, true);
            let origin = Vec3::new(u(), u(), u()).times(Vec3::uniform(edge));
            let direction = Vec3::new(0.0, 0.0, 1.0).deflected(2.0 * u() - 1.0, u());
            let numbers = |v: Vec3<f32>| [v.x, v.y, v.z];
            BundleRay {
                origin: numbers(origin),
                direction: numbers(direction),
                t_max: clip_to_box(origin, direction, Vec3::uniform(edge)).t1,
                key: Key {
                    seed: 1,
                    pixel,
                    sample,
                },
            }
        };
        let bundle = |bundle| (0..RAYS).map(|index| ray(bundle, index)).collect();
        Self::of((0..BUNDLES).map(bundle).collect())
    }

    fn of(rays: Vec<Vec<BundleRay>>) -> Self {
        Self {
            bundles: rays.iter().map(|bundle| bundle.iter().collect()).collect(),
            singles: rays
                .iter()
                .map(|bundle| {
                    bundle
                        .iter()
                        .map(|r| (*r, PathStream::new(r.key)))
                        .collect()
                })
                .collect(),
        }
    }

    /// Paths of a round.
    pub const PATHS: usize = RAYS * BUNDLES;
}

/// Times of several ways to do the same work.
#[derive(Clone, Debug, Default)]
pub struct Times(Vec<f64>);

impl Times {
    /// Adds the CPU time of a run, in seconds: who else uses the machine is not counted.
    pub fn time(&mut self, run: impl FnOnce()) {
        let ((), took) = measure::timed(run);
        self.0.push(took);
    }

    /// The value below which a fraction of the times lies.
    pub fn quantile(&self, fraction: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        let at = (fraction * (sorted.len().saturating_sub(1)) as f64).round() as usize;
        sorted.get(at).copied().unwrap_or(f64::NAN)
    }

    /// Median of the ratios of another's times to these, round by round: noise that lasts longer than a
    /// round cancels.
    pub fn speed_up_over(&self, other: &Self) -> f64 {
        self.ratios(other).quantile(0.5)
    }

    /// The ratios of another's times to these, round by round.
    pub fn ratios(&self, other: &Self) -> Self {
        let ratios = other.0.iter().zip(&self.0).map(|(slow, fast)| slow / fast);
        Self(ratios.collect())
    }
}

/// Mean over rays of the variance over bundles: `values[bundle][ray]`.
pub fn variance_within_rays(values: &[Vec<f32>]) -> f64 {
    let n = values.len() as f64;
    let variance = |ray: usize| {
        let of = |b: &Vec<f32>| b.get(ray).copied().map_or(0.0, f64::from);
        let mean = values.iter().map(of).sum::<f64>() / n;
        values.iter().map(|b| (of(b) - mean).powi(2)).sum::<f64>() / (n - 1.0)
    };
    (0..RAYS).map(variance).sum::<f64>() / RAYS as f64
}

/// Whether cargo asks for one quick run of everything (`cargo bench -- --test`, or `cargo test`).
pub fn quick() -> bool {
    std::env::args().any(|argument| argument == "--test")
}

/// Whether the command line asks for a row: names it, or names none.
pub fn selected(name: &str) -> bool {
    let mut names = std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let first = names.next();
    first.is_none() || first.into_iter().chain(names).any(|wanted| wanted == name)
}

/// The number of an option of the command line, `--name=number`.
pub fn option(name: &str, otherwise: u64) -> u64 {
    let value = |argument: String| argument.strip_prefix(name)?.strip_prefix('=')?.parse().ok();
    std::env::args().find_map(value).unwrap_or(otherwise)
}
