//! `woodcock bench`: scenes times methods times budgets times seeds, methods taking turns.

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::time::{Duration, Instant};

use super::args::{BenchArgs, RenderArgs};
use super::commands::{self, Loaded};
use super::failure::Failure;
use super::method::MethodSpec;
use super::shoot;
use crate::bench::page::{self, About};
use crate::bench::{self, Method, Reference, Run, Stage, drawing};
use crate::drive::Silent;
use crate::film::Film;
use crate::image::exr::read_image;
use crate::output::{self, OutputFile};
use crate::render::{Plan, render_pass};
use crate::report::cpu_time;
use crate::world::Feature;

/// Time for everything, unless the user says otherwise \[s\].
const DEFAULT_TIME: f64 = 120.0;
/// The same of `--quick`.
const QUICK_TIME: f64 = 10.0;
/// Pixels of a picture of `--quick`, at most.
const QUICK_PIXELS: f64 = 4096.0;
/// Part of a scene's time that makes its reference.
const REFERENCE_SHARE: f64 = 0.35;
/// Tells the reference's random numbers from those of runs: √13's fraction.
const REFERENCE: u64 = 0x9b05_688c_2b3e_6c1f;
/// The reference's error should be below this part of the least error of a run.
const REFERENCE_ERROR: f64 = 0.25;

/// A method, ready to run.
struct Contestant {
    spec: MethodSpec,
    loaded: Rc<Loaded>,
    plan: Plan,
    /// Wall-clock seconds of a sample per pixel.
    pace: f64,
}

/// Wall-clock and CPU seconds; the latter are the former where the system does not tell.
struct Took {
    wall: f64,
    cpu: f64,
}

impl Contestant {
    /// Renders samples with a seed.
    fn shoot(&self, pool: &rayon::ThreadPool, seed: u64, samples: u32) -> (Film, Took) {
        let plan = Plan { seed, ..self.plan };
        let world = &self.loaded.world;
        let mut film = plan.film(world);
        let (start, cpu) = (Instant::now(), cpu_time());
        pool.install(|| render_pass(world, &plan, &mut film, 0..samples, &Silent));
        let wall = start.elapsed().as_secs_f64();
        let cpu = cpu
            .zip(cpu_time())
            .map_or(wall, |(a, b)| b.saturating_sub(a).as_secs_f64());
        (film, Took { wall, cpu })
    }

    /// So many samples as take about so long, in whole replicates.
    fn samples_in(&self, seconds: f64) -> u32 {
        let unit = f64::from(self.plan.replicate.max(1));
        let units = (seconds / (self.pace * unit)).clamp(1.0, 1e8 / unit);
        (units.round() * unit) as u32
    }

    /// Finds the pace, on at least 20 ms of work.
    fn calibrate(&mut self, pool: &rayon::ThreadPool) {
        let mut samples = self.plan.replicate.max(1);
        loop {
            let (_, took) = self.shoot(pool, u64::MAX, samples);
            self.pace = (took.wall / f64::from(samples)).max(1e-9);
            if took.wall > 0.02 || samples > 1 << 20 {
                return;
            }
            samples *= 4;
        }
    }
}

/// What a scene's methods have in common.
struct Bench<'a> {
    args: &'a BenchArgs,
    pool: rayon::ThreadPool,
    notes: Vec<String>,
}

impl Bench<'_> {
    fn say(&self, words: &str) {
        if !self.args.quiet {
            eprintln!("{words}");
        }
    }

    /// The arguments of `render` that a method on a scene stands for.
    fn render_args(&self, scene: Option<&PathBuf>, spec: &MethodSpec) -> RenderArgs {
        RenderArgs {
            scene: scene.cloned(),
            integrator: spec.integrator,
            kernel: spec.kernel,
            transmittance: spec.transmittance,
            keep: spec.keep.clone(),
            split: spec.split,
            resolution: self.args.resolution,
            max_depth: self.args.max_depth,
            max_memory: self.args.max_memory,
            lenient: self.args.lenient,
            quiet: self.args.quiet,
            ..RenderArgs::default()
        }
    }

    /// Loads a scene for a method, or takes it from those that keep the same features.
    fn enter(
        &self,
        scene: Option<&PathBuf>,
        spec: &MethodSpec,
        entered: &[Contestant],
    ) -> Result<Contestant, Failure> {
        let mut args = self.render_args(scene, spec);
        args.quiet |= !entered.is_empty();
        let known = entered.iter().find(|other| other.spec.keep == spec.keep);
        let loaded = match known {
            Some(other) => Rc::clone(&other.loaded),
            None => {
                let mut loaded = commands::open(&args)?;
                if let Some(size) = self.quick_size(&loaded) {
                    args.resolution = Some(size);
                    args.quiet = true;
                    loaded = commands::open(&args)?;
                }
                Rc::new(loaded)
            }
        };
        let (plan, _) = commands::plan(&args, &loaded.scene, &loaded.world)?;
        Ok(Contestant {
            spec: spec.clone(),
            loaded,
            plan,
            pace: 0.0,
        })
    }

    /// The size of a quick picture, if it is to be smaller than the scene's.
    fn quick_size(&self, loaded: &Loaded) -> Option<[u32; 2]> {
        let size = loaded.world.resolution.map(f64::from);
        let pixels = size[0] * size[1];
        let shrink = self.args.quick && self.args.resolution.is_none() && pixels > QUICK_PIXELS;
        shrink.then(|| {
            let factor = (QUICK_PIXELS / pixels).sqrt();
            size.map(|n| ((n * factor) as u32).max(1))
        })
    }

    /// The methods on a scene: those asked for, or those that suit it.
    fn contestants(&self, scene: Option<&PathBuf>) -> Result<Vec<Contestant>, Failure> {
        let mut entered = Vec::new();
        if !self.args.methods.is_empty() {
            for spec in &self.args.methods {
                entered.push(self.enter(scene, spec, &entered)?);
            }
            return Ok(entered);
        }
        let first = self.enter(scene, &MethodSpec::plain("path"), &entered)?;
        let world = &first.loaded.world;
        let mut names = Vec::new();
        if first.plan.in_packets(world) {
            names.push("path,kernel=scalar");
            if world.needs.runs(Feature::Tracking) {
                names.push("path,transmittance=delta");
            }
        }
        names.push("bdpt");
        if !first.plan.in_packets(world) {
            names.push("mlt");
        }
        entered.push(first);
        for name in names {
            // What a scene cannot do is no method for it.
            if let Ok(contestant) = self.enter(scene, &MethodSpec::plain(name), &entered) {
                entered.push(contestant);
            }
        }
        Ok(entered)
    }

    /// The picture to compare with: read from a file, or rendered for so long.
    fn reference(
        &self,
        contestants: &[Contestant],
        scene: Option<&PathBuf>,
        seconds: f64,
    ) -> Result<(Reference, String), Failure> {
        if let Some(path) = &self.args.reference {
            let window = contestants.first().map(|c| c.loaded.world.window);
            return Ok((read_reference(path, window)?, path.display().to_string()));
        }
        let own;
        let by = match (&self.args.reference_method, contestants.first()) {
            (None, Some(first)) => first,
            (spec, _) => {
                let spec = spec.clone().unwrap_or_default();
                let mut contestant = self.enter(scene, &spec, contestants)?;
                contestant.calibrate(&self.pool);
                own = contestant;
                &own
            }
        };
        let unit = by.plan.replicate.max(1);
        let samples = by.samples_in(seconds).max(8 * unit);
        let (film, _) = by.shoot(&self.pool, self.args.seed ^ REFERENCE, samples);
        let name = format!("{}, {samples} samples per pixel", by.spec.name);
        Ok((Reference::of_film(&film), name))
    }

    fn stage(&mut self, scene: Option<&PathBuf>, seconds: f64) -> Result<Stage, Failure> {
        let mut contestants = self.contestants(scene)?;
        let start = Instant::now();
        for contestant in &mut contestants {
            contestant.calibrate(&self.pool);
        }
        let (budgets, seeds) = (self.args.budgets, self.args.seeds);
        let share = if self.args.reference.is_some() {
            0.0
        } else {
            REFERENCE_SHARE
        };
        let (reference, words) = self.reference(&contestants, scene, share * seconds)?;
        let left = (seconds - start.elapsed().as_secs_f64()).max(0.3 * seconds);
        let runs = contestants.len() as f64 * f64::from(seeds) * ((1_u64 << budgets) - 1) as f64;
        let name = contestants
            .first()
            .map_or_else(String::new, |c| c.loaded.name.clone());
        self.say(&format!(
            "{name}: {} methods, reference {words} of relMSE {:.1e}",
            contestants.len(),
            reference.error()
        ));
        let least: Vec<u32> = contestants
            .iter()
            .map(|c| c.samples_in(left / runs))
            .collect();
        let mut methods: Vec<Method> = contestants
            .iter()
            .map(|c| Method {
                name: c.spec.name.clone(),
                runs: Vec::new(),
            })
            .collect();
        let mut skipped = 0;
        for budget in 0..budgets {
            // What does not fit any more is left out with all its seeds, unless there would be no line at all.
            let elapsed = start.elapsed().as_secs_f64();
            let fits = |index: usize, contestant: &Contestant| {
                let samples = f64::from(least[index].saturating_mul(1 << budget));
                let end = elapsed + contestant.pace * samples * f64::from(seeds);
                budget < 3 || end < 1.2 * seconds
            };
            let fit: Vec<bool> = contestants
                .iter()
                .enumerate()
                .map(|(index, contestant)| fits(index, contestant))
                .collect();
            skipped += seeds as usize * fit.iter().filter(|fit| !**fit).count();
            for seed in 0..seeds {
                for (index, contestant) in contestants.iter().enumerate() {
                    let samples = least[index].saturating_mul(1 << budget);
                    if !fit[index] {
                        continue;
                    }
                    let number = u64::from(budget) * u64::from(seeds) + u64::from(seed) + 1;
                    let seed = self.args.seed.wrapping_add(number);
                    let (film, took) = contestant.shoot(&self.pool, seed, samples);
                    methods[index].runs.push(Run {
                        budget,
                        seed,
                        samples,
                        seconds: took.cpu,
                        judgement: reference.judge(&film),
                    });
                }
            }
            let elapsed = start.elapsed().as_secs_f64();
            self.say(&format!(
                "  budget {} of {budgets}: {elapsed:.1} s",
                budget + 1
            ));
        }
        if skipped > 0 {
            self.notes.push(format!(
                "{name}: {skipped} runs did not fit the time; give --time more seconds"
            ));
        }
        let errors = methods.iter().flat_map(|m| &m.runs);
        let smallest = errors
            .map(|run| run.judgement.relative)
            .fold(f64::INFINITY, f64::min);
        if reference.error() > REFERENCE_ERROR * smallest {
            self.notes.push(format!(
                "{name}: the reference is hardly better than the best run; longer --time, or --reference, helps"
            ));
        }
        let size = reference.window().size();
        Ok(Stage {
            name,
            size,
            reference: words,
            reference_error: reference.error(),
            methods,
        })
    }
}

fn read_reference(path: &Path, window: Option<crate::film::Window>) -> Result<Reference, Failure> {
    let fail =
        |words: &dyn std::fmt::Display| Failure::message(format!("{}: {words}", path.display()));
    let file = std::fs::File::open(path).map_err(|e| fail(&e))?;
    let image = read_image(std::io::BufReader::new(file), 8 << 30).map_err(|e| fail(&e))?;
    let reference = Reference::of_image(&image);
    let reference =
        reference.ok_or_else(|| fail(&"a reference needs finite R G B and Variance.R/G/B"))?;
    if window.is_some_and(|window| window != reference.window()) {
        return Err(fail(&"its size or crop window is not the scene's"));
    }
    Ok(reference)
}

/// Runs `woodcock bench` and writes its files; the text is the table.
///
/// # Errors
/// Scenes and files as `render` has them; methods that a scene cannot do.
pub fn run(args: &BenchArgs) -> Result<String, Failure> {
    let file = |extension: &str| {
        let mut name = args.output.clone().into_os_string();
        name.push(extension);
        OutputFile::statistics(Path::new(&name))
    };
    let files = [".csv", ".svg", ".html"].map(file);
    for file in &files {
        file.probe().map_err(Failure::output)?;
    }
    if args.reference.is_some() && args.scenes.len() > 1 {
        let message = "--reference is the picture of one scene; there are several";
        return Err(Failure::Usage(message.into()));
    }
    let time = args.time.map(|time: Duration| time.as_secs_f64());
    let time = time.unwrap_or(if args.quick { QUICK_TIME } else { DEFAULT_TIME });
    let scenes: Vec<Option<&PathBuf>> = if args.scenes.is_empty() {
        vec![None]
    } else {
        args.scenes.iter().map(Some).collect()
    };
    let mut bench = Bench {
        args,
        pool: shoot::pool(args.threads)?,
        notes: Vec::new(),
    };
    let each = time / scenes.len() as f64;
    let mut stages = Vec::new();
    for scene in scenes {
        stages.push(bench.stage(scene, each)?);
    }
    let about = About {
        command: std::env::args().collect::<Vec<_>>().join(" "),
        threads: bench.pool.current_num_threads(),
        seeds: args.seeds,
        notes: bench.notes,
    };
    let svg = drawing::draw(&stages).map_err(Failure::message)?;
    let csv = bench::csv(&stages);
    let html = page::html(&stages, &about, &svg, &csv);
    let mut staged = Vec::new();
    for (file, text) in files.iter().zip([&csv, &svg, &html]) {
        let write = |to: &mut std::io::BufWriter<std::fs::File>| {
            std::io::Write::write_all(to, text.as_bytes())
        };
        staged.push(file.stage(write).map_err(Failure::output)?);
    }
    output::commit(staged).map_err(Failure::output)?;
    if !args.quiet {
        let [csv, svg, html] = files.each_ref().map(|f| f.path().display());
        eprintln!("written: {csv}, {svg}, {html}");
    }
    Ok(page::table(&stages, &about))
}
