//! What the commands do: from arguments to scenes, volumes and kernels.

use std::path::PathBuf;
use std::time::Instant;

use woodcock_core::path::ShadowEstimator;

use super::args::{Aov, ExplainArgs, InfoArgs, RenderArgs, Transmittance};
use super::failure::{self, Failure};
use super::render::Prepared;
use super::shoot::{self, Shot};
use crate::builtin;
use crate::drive::Goal;
use crate::image::Layers;
use crate::info::{InfoOptions, info_json, info_text};
use crate::integrator::Integrator;
use crate::render::{Kernel, Plan, kernel_name, replay as replay_path};
use crate::report::Statistics;
use crate::scene::{self, DiskFiles, Files, Scene, SceneError};
use crate::volume::Limits;
use crate::world::{self, COLLISION_LIMIT, Feature, World};

/// Samples per pixel where neither the scene nor the user says.
const DEFAULT_SAMPLES: u32 = 64;

/// A scene, assembled under the user's choices.
pub(super) struct Loaded {
    pub(super) scene: Scene,
    pub(super) world: World,
    pub(super) name: String,
}

/// Reads and assembles a scene.
fn load(
    scene_file: Option<&PathBuf>,
    options: &world::Options,
    lenient: bool,
    quiet: bool,
) -> Result<Loaded, Failure> {
    let (scene, name) = match scene_file {
        Some(path) => {
            let reading = scene::Options {
                lenient,
                max_memory: options.limits.max_memory,
            };
            (
                scene::read(path, &DiskFiles, &reading)?,
                path.display().to_string(),
            )
        }
        None => {
            if !quiet {
                eprintln!("no scene given: rendering the built-in cloud");
            }
            (builtin::scene()?, "built-in".to_owned())
        }
    };
    let world = world::assemble(&scene, &DiskFiles, options)?;
    if !quiet {
        for warning in scene.warnings.iter().chain(&world.warnings) {
            failure::warn(warning);
        }
    }
    Ok(Loaded { scene, world, name })
}

fn limits(max_memory: Option<u64>) -> Limits {
    max_memory.map_or_else(Limits::default, |max_memory| Limits { max_memory })
}

fn options(args: &RenderArgs) -> Result<world::Options, Failure> {
    let keep = args.keep.iter().map(|name| {
        Feature::kept(name).ok_or_else(|| {
            let known = Feature::ALL
                .iter()
                .filter(|f| f.can_be_kept())
                .map(|f| f.name());
            let known: Vec<_> = known.collect();
            Failure::Usage(format!("--keep {name}: there is {}", known.join(", ")))
        })
    });
    Ok(world::Options {
        keep: keep.collect::<Result<_, _>>()?,
        resolution: args.resolution,
        crop: args.crop,
        limits: limits(args.max_memory),
    })
}

/// Reads and assembles the scene of `render`'s arguments.
pub(super) fn open(args: &RenderArgs) -> Result<Loaded, Failure> {
    load(
        args.scene.as_ref(),
        &options(args)?,
        args.lenient,
        args.quiet,
    )
}

/// The plan that arguments make for a world, and the name of its transmittance estimator.
pub(super) fn plan(
    args: &RenderArgs,
    scene: &Scene,
    world: &World,
) -> Result<(Plan, String), Failure> {
    let tracking = world.needs.runs(Feature::Tracking);
    let estimator = match args.transmittance {
        Some(Transmittance::Closed) if tracking => {
            let message =
                "--transmittance closed: this scene has media on grids, which have no closed form";
            return Err(Failure::Usage(message.into()));
        }
        Some(Transmittance::PowerSeries) if world.needs.runs(Feature::Scattering) => {
            let message = "--transmittance power-series: only scenes that absorb and do not scatter can do it";
            return Err(Failure::Usage(message.into()));
        }
        _ if !tracking => Transmittance::Closed,
        None if !world.needs.runs(Feature::Scattering) => Transmittance::PowerSeries,
        asked => asked.unwrap_or(Transmittance::Ratio),
    };
    let shadow = match estimator {
        Transmittance::Delta => ShadowEstimator::Delta,
        Transmittance::Ratio => ShadowEstimator::Ratio,
        Transmittance::PowerSeries | Transmittance::Closed => ShadowEstimator::ByNeed,
    };
    let seed = args.seed.or(scene.seed).unwrap_or(0);
    let integrator = args
        .integrator
        .unwrap_or_else(|| Integrator::named(&scene.integrator.name).unwrap_or_default());
    let mut plan = Plan::new(world, args.kernel, integrator, seed, shadow, args.max_depth);
    fit(args, &mut plan)?;
    if !plan.in_packets(world) && args.transmittance == Some(Transmittance::Delta) {
        let message = "--transmittance delta: only scenes of plain media under suns and constant skies can do it";
        return Err(Failure::Usage(message.into()));
    }
    if !world.surfaces.is_empty() {
        // Walls bound what fills space, and absorb; where neither does, scalar paths play roulette in the end.
        return Ok((plan, estimator.name().to_owned()));
    }
    if plan.settings.max_depth == u32::MAX && world.is_endless() {
        let message = "a medium of albedo 1 fills all space: paths would never end";
        let error = SceneError::of_file("the scene", message);
        return Err(error
            .help("give --max-depth, let the medium absorb, or bound it by a surface")
            .into());
    }
    let expected = world.collisions_expected();
    if expected.min(f64::from(plan.settings.max_depth)) > COLLISION_LIMIT {
        let message = format!(
            "paths are expected to collide about {expected:.0e} times each, more than {COLLISION_LIMIT:.0e}"
        );
        let error = SceneError::of_file("the scene", message);
        return Err(error
            .help("give --max-depth, lower the extinction, or let the medium absorb")
            .into());
    }
    Ok((plan, estimator.name().to_owned()))
}

/// The further layers that arguments ask for.
fn layers(args: &RenderArgs) -> Layers {
    let asked = |aov: Aov| args.aov.contains(&aov);
    Layers {
        albedo: asked(Aov::Albedo),
        normal: asked(Aov::Normal),
        depth: asked(Aov::Depth),
        matter: asked(Aov::Matter),
        order: asked(Aov::Order),
    }
}

/// Enters what only some integrators can do.
fn fit(args: &RenderArgs, plan: &mut Plan) -> Result<(), Failure> {
    let name = plan.integrator.name();
    let bidirectional = matches!(plan.integrator, Integrator::Bdpt | Integrator::Mlt);
    let refuse = |what: &str, can: &str| {
        Err(Failure::Usage(format!(
            "{what} does not work with --integrator {name}; {can} can do it"
        )))
    };
    if args.connection_bound.is_some() && !bidirectional {
        return refuse("--connection-bound", "bdpt and mlt");
    }
    let split = args.split.unwrap_or(1);
    if split > 1 && !matches!(plan.integrator, Integrator::Path | Integrator::Single) {
        return refuse("--split", "path and single");
    }
    let layers = layers(args);
    if layers.any() && plan.integrator == Integrator::Mlt {
        return refuse("--aov", "the other integrators");
    }
    if layers.parts() && bidirectional {
        return refuse("--aov matter and order", "path, single and transmittance");
    }
    plan.connection_bound = args.connection_bound;
    plan.split = split;
    plan.layers = layers.any();
    Ok(())
}

/// Prepares `woodcock render`.
///
/// # Errors
/// Scene and volume errors; usage that does not fit the scene.
pub fn prepare(args: &RenderArgs) -> Result<Prepared, Failure> {
    let setup = Instant::now();
    let loaded = open(args)?;
    let (plan, transmittance) = plan(args, &loaded.scene, &loaded.world)?;
    let image_name = args.scene.as_ref().and_then(|_| {
        let name = &loaded.scene.film.filename;
        (!name.is_empty()).then(|| PathBuf::from(name))
    });
    let goal = Goal {
        samples: match (args.spp, args.time, args.target_error) {
            (None, None, None) => Some(loaded.scene.samples_per_pixel.unwrap_or(DEFAULT_SAMPLES)),
            (spp, ..) => spp,
        },
        time: args.time,
        first_sample: 0,
        replicate: plan.replicate,
    };
    let (target, quiet) = (args.target_error, args.quiet);
    let pool = shoot::pool(args.threads)?;
    let layers = layers(args);
    let setup_seconds = setup.elapsed().as_secs_f64();
    Ok(Prepared {
        image_name,
        render: Box::new(move |watch| {
            let statistics = Statistics {
                transmittance,
                setup_seconds,
                threads: pool.current_num_threads() as u64,
                ..Statistics::default()
            };
            let shot = Shot {
                loaded: &loaded,
                plan: &plan,
                pool: &pool,
                watch,
                quiet,
            };
            shoot::render(&shot, layers, &goal, target, statistics)
        }),
    })
}

/// Runs `woodcock render --replay`.
///
/// # Errors
/// As [`prepare`], and a pixel outside of the picture.
pub fn replay(args: &RenderArgs) -> Result<String, Failure> {
    let Some(wanted) = args.replay else {
        return Err(Failure::Usage("--replay x,y,sample is missing".into()));
    };
    let loaded = open(args)?;
    let [width, height] = loaded.world.resolution;
    let (x, y, sample) = (wanted.x, wanted.y, wanted.sample);
    if x >= width || y >= height {
        return Err(Failure::Usage(format!(
            "--replay {x},{y},{sample}: the picture has {width} x {height} pixels"
        )));
    }
    let (plan, _) = plan(args, &loaded.scene, &loaded.world)?;
    let (path, counts) = replay_path(&loaded.world, &plan, x, y, sample);
    let [r, g, b] = path.radiance;
    Ok(format!(
        "path {sample} of pixel ({x}, {y}), seed {}\n\
         radiance               {r:e} {g:e} {b:e}\n\
         met a medium           {}\n\
         tentative collisions   {}\n\
         real collisions        {}\n\
         null collisions        {}\n\
         majorant cells         {}\n\
         majorant violations    {}\n",
        plan.seed,
        if path.alpha > 0.0 { "yes" } else { "no" },
        counts.tentative_collisions,
        counts.real_collisions,
        counts.null_collisions,
        counts.majorant_cells,
        counts.majorant_violations,
    ))
}

/// Runs `woodcock explain`.
///
/// # Errors
/// As [`prepare`].
pub fn explain(args: &ExplainArgs) -> Result<String, Failure> {
    let loaded = {
        let options = world::Options {
            limits: limits(args.max_memory),
            ..world::Options::default()
        };
        load(args.scene.as_ref(), &options, args.lenient, false)?
    };
    let Loaded { scene, world, name } = loaded;
    let [width, height] = world.resolution;
    let mut text = format!(
        "{name}: {width} x {height} pixels, {} media seen, {} lights\nkernel {}\n\n{}",
        world.media.len(),
        scene.lights.len(),
        kernel_name(&world, Kernel::Packet),
        world.needs,
    );
    let (voxels, bytes) = world.tables.size();
    if voxels > 0 {
        let bounds = world.tables.majorants.len();
        let megabytes = bytes as f64 / 1e6;
        text += &format!("\n{voxels} samples and {bounds} majorants in {megabytes:.1} MB\n");
    }
    Ok(text)
}

/// Runs `woodcock info` on a volume.
///
/// # Errors
/// A file that cannot be read, or is no volume.
pub fn info(args: &InfoArgs) -> Result<String, Failure> {
    let bytes = DiskFiles
        .read(&args.file)
        .map_err(|error| Failure::message(format!("{}: {error}", args.file.display())))?;
    let options = InfoOptions {
        grid: args.grid.clone(),
        at: args.at.clone(),
        rays: args.ray.clone(),
        limits: limits(args.max_memory),
    };
    let context = |error: crate::info::InfoError| {
        Failure::message(format!("{}: {error}", args.file.display()))
    };
    if args.json {
        let value = info_json(&bytes, &options).map_err(context)?;
        let text = serde_json::to_string_pretty(&value);
        Ok(text.map_err(Failure::message)? + "\n")
    } else {
        info_text(&bytes, &options).map_err(context)
    }
}
