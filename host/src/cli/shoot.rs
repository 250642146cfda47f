//! A render between loading and writing: pilot, passes, and what is to be said of them.

use std::cell::RefCell;
use std::ops::Range;

use woodcock_core::path::Counts;

use super::commands::Loaded;
use super::failure::Failure;
use super::render::Rendered;
use crate::drive::{Goal, Outcome, Progress, Silent, Stopping, Watch, drive, drive_allotted};
use crate::film::{Allotment, Film};
use crate::image::{Channel, Layers, RenderMetadata};
use crate::integrator::Integrator;
use crate::pilot::{self, Decision, Target};
use crate::render::{Kernel, Plan, render_allotted};
use crate::report::{Statistics, cpu_time};

/// The threads that tiles run on; `0` or nothing is one for each core.
pub(super) fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .build()
        .map_err(|error| Failure::message(format!("cannot start threads: {error}")))
}

/// What is rendered, how, and by whom.
#[derive(Clone, Copy)]
pub(super) struct Shot<'a> {
    pub(super) loaded: &'a Loaded,
    pub(super) plan: &'a Plan,
    pub(super) pool: &'a rayon::ThreadPool,
    pub(super) watch: Watch<'a>,
    /// Whether words about progress are unwelcome.
    pub(super) quiet: bool,
}

/// A film, what it took, and how it ended.
struct Exposure {
    film: Film,
    counts: Counts,
    outcome: Outcome,
    /// What decided the counts of samples, and its paths.
    pilot: Option<(Decision, u64)>,
}

impl Shot<'_> {
    /// A pass on all threads.
    fn pass(
        &self,
        plan: &Plan,
        film: &mut Film,
        samples: Range<u32>,
        allotment: Option<&Allotment>,
        progress: &dyn Progress,
    ) -> Counts {
        let world = &self.loaded.world;
        self.pool
            .install(|| render_allotted(world, plan, film, samples, allotment, progress))
    }

    /// Samples as many as asked for.
    fn expose(&self, goal: &Goal) -> Result<Exposure, Failure> {
        let mut film = self.plan.film(&self.loaded.world);
        let counts = RefCell::new(Counts::default());
        let outcome = drive(&mut film, goal, self.watch, |film, samples| {
            let pass = self.pass(self.plan, film, samples, None, self.watch.progress);
            counts.borrow_mut().add(&pass);
            Ok::<_, Failure>(())
        })?;
        Ok(Exposure {
            film,
            counts: counts.into_inner(),
            outcome,
            pilot: None,
        })
    }

    /// Samples until the picture has a relative error, or the goal's limits are reached.
    fn expose_to(&self, error: f64, goal: &Goal) -> Result<Exposure, Failure> {
        let world = &self.loaded.world;
        let start = (self.watch.clock)();
        let target = Target {
            error,
            most: goal.samples,
            uniform: matches!(self.plan.integrator, Integrator::Bdpt | Integrator::Mlt),
            time: goal.time,
        };
        let plan = Plan {
            seed: pilot::seed(self.plan.seed),
            ..*self.plan
        };
        let mut film = Film::of_replicates(world.resolution, world.window, plan.replicate);
        let pilot_paths = RefCell::new(0);
        let decision = pilot::run(&mut film, &target, self.watch, |film, samples| {
            *pilot_paths.borrow_mut() += self.pass(&plan, film, samples, None, &Silent).paths;
            Ok::<_, Failure>(())
        })?;
        let pilot_time = (self.watch.clock)().saturating_sub(start);
        let allotment = &decision.allotment;
        if !self.quiet {
            eprintln!(
                "a pilot of {} samples per pixel took {:.1} s and asks for {} to {}, {:.1} on average",
                decision.pilot,
                pilot_time.as_secs_f64(),
                allotment.smallest(),
                allotment.largest(),
                allotment.mean(),
            );
        }
        // The memory of the pilot is free for the picture.
        drop(film);
        let mut film = self.plan.film(world);
        let goal = Goal {
            time: goal.time.map(|time| time.saturating_sub(pilot_time)),
            ..*goal
        };
        let counts = RefCell::new(Counts::default());
        let mut outcome =
            drive_allotted(&mut film, &goal, allotment, self.watch, |film, samples| {
                let pass = self.pass(
                    self.plan,
                    film,
                    samples,
                    Some(allotment),
                    self.watch.progress,
                );
                counts.borrow_mut().add(&pass);
                Ok::<_, Failure>(())
            })?;
        outcome.render_time += pilot_time;
        if outcome.stopping == Stopping::Samples {
            outcome.complete = decision.enough;
            if decision.enough {
                outcome.stopping = Stopping::Target;
            }
        } else {
            outcome.complete = false;
        }
        Ok(Exposure {
            film,
            counts: counts.into_inner(),
            outcome,
            pilot: Some((decision, pilot_paths.into_inner())),
        })
    }
}

/// The channel that says how many samples each pixel has.
fn samples_channel(film: &Film) -> Channel {
    let window = film.window();
    let mut values = vec![0.0; window.pixels() as usize];
    for (x, y, pixel) in film.pixels() {
        values[window.index(x, y)] = pixel.samples() as f32;
    }
    Channel {
        name: "Samples".to_owned(),
        values,
    }
}

/// Renders; `statistics` has what is known of the setup.
pub(super) fn render(
    shot: &Shot<'_>,
    layers: Layers,
    goal: &Goal,
    target: Option<f64>,
    statistics: Statistics,
) -> Result<Rendered, Failure> {
    let Shot { loaded, plan, .. } = *shot;
    let Loaded { scene, world, name } = loaded;
    let cpu_before = cpu_time();
    let exposure = match target {
        Some(error) => shot.expose_to(error, goal)?,
        None => shot.expose(goal)?,
    };
    let cpu = cpu_before
        .zip(cpu_time())
        .map(|(a, b)| b.saturating_sub(a).as_secs_f64());
    let Exposure {
        film,
        counts,
        outcome,
        pilot,
    } = exposure;
    let used = if plan.in_packets(world) || plan.in_room(world) {
        plan.kernel
    } else {
        Kernel::Scalar
    };
    let kernel = used.name();
    let utilisation = match used {
        Kernel::Packet => counts.busy_lanes as f64 / counts.lanes.max(1) as f64,
        Kernel::Scalar => 1.0,
    };
    let mut channels = layers.channels(&film);
    let samples_per_pixel = match &pilot {
        Some(_) => {
            channels.push(samples_channel(&film));
            film.samples_per_pixel()
        }
        None => outcome.samples.len() as f64,
    };
    Ok(Rendered {
        channels,
        film,
        metadata: RenderMetadata {
            seed: plan.seed,
            scene_hash: scene.source_hash,
            integrator: plan.integrator.name().to_owned(),
            kernel: kernel.to_owned(),
            samples: outcome.samples.clone(),
            samples_per_pixel,
            replicate: plan.replicate,
            target_error: target,
            majorant_violations: counts.majorant_violations,
            stopping: outcome.stopping,
            render_time: outcome.render_time,
        },
        statistics: Statistics {
            scene: name.clone(),
            integrator: plan.integrator.name().to_owned(),
            kernel: kernel.to_owned(),
            seed: plan.seed,
            spp: samples_per_pixel.round() as u64,
            render_seconds: outcome.render_time.as_secs_f64(),
            cpu_seconds: cpu,
            paths: counts.paths,
            tentative_collisions: counts.tentative_collisions,
            real_collisions: counts.real_collisions,
            null_collisions: counts.null_collisions,
            lookups: counts.lookups,
            exact_lookups: counts.exact_lookups,
            majorant_cells: counts.majorant_cells,
            lane_utilisation: utilisation,
            majorant_violations: counts.majorant_violations,
            target_error: target,
            pilot_paths: pilot.map_or(0, |(_, paths)| paths),
            needs: world.needs.running(),
            skipped: world.needs.skipped(),
            ..statistics
        },
        complete: outcome.complete,
    })
}
