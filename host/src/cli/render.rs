//! The frame around a render: outputs checked first, signals and clock watched, files written last.

use super::args::RenderArgs;
use super::failure::{EXIT_PARTIAL, Failure};
use super::progress;
use crate::drive::Watch;
use crate::film::Film;
use crate::image::{Channel, Image, RenderMetadata, exr, png};
use crate::output::{self, OutputFile, OutputKind};
use crate::report::Statistics;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A scene that is loaded and checked, ready to render.
pub struct Prepared {
    /// The name of the image that the scene asks for, used if the command line gives none.
    pub image_name: Option<PathBuf>,
    /// Renders: builds the film, calls [`drive`](crate::drive::drive) with the watch, returns what it made.
    pub render: Box<RenderFn>,
}

/// The rendering itself.
pub type RenderFn = dyn FnOnce(Watch<'_>) -> Result<Rendered, Failure>;

impl std::fmt::Debug for Prepared {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Prepared")
            .field("image_name", &self.image_name)
            .finish_non_exhaustive()
    }
}

/// What a render made.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// The picture.
    pub film: Film,
    /// Further channels over the film's window (`Albedo.*`, `N.*`, `Z`).
    pub channels: Vec<Channel>,
    /// How it was made.
    pub metadata: RenderMetadata,
    /// What was counted. Size, relative error and dropped paths are filled in from the film.
    pub statistics: Statistics,
    /// Whether everything asked for was done ([`Outcome::complete`](crate::drive::Outcome::complete)).
    pub complete: bool,
}

/// Runs `woodcock render`: checks the outputs, loads by `prepare`, renders, writes.
///
/// From here on the first SIGINT or SIGTERM asks the render to stop after the pass in flight; the second ends the process as if nobody
/// had listened. Returns exit code 0, or 3 for a valid partial image.
pub fn run(
    args: &RenderArgs,
    prepare: impl FnOnce(&RenderArgs) -> Result<Prepared, Failure>,
) -> Result<ExitCode, Failure> {
    let stats = args.stats.as_deref().map(OutputFile::statistics);
    let given = OutputFile::images(&args.outputs).map_err(Failure::output)?;
    probe(given.iter().chain(&stats))?;
    let interrupted = listen()?;
    let prepared = prepare(args)?;
    let images = if given.is_empty() {
        let images = default_images(args.scene.as_deref(), prepared.image_name.as_deref());
        probe(&images)?;
        images
    } else {
        given
    };

    let progress = progress::display(args.quiet);
    let start = Instant::now();
    let mut rendered = (prepared.render)(Watch {
        clock: &|| start.elapsed(),
        interrupted: &|| interrupted.load(Ordering::Relaxed),
        progress: progress.as_ref(),
    })?;
    complete_statistics(&mut rendered);
    write(&rendered, &images, stats.as_ref())?;
    warn(&rendered);
    if !args.quiet {
        summarise(&rendered, &images);
    }
    Ok(if rendered.complete {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(EXIT_PARTIAL)
    })
}

/// A flag that the first SIGINT or SIGTERM sets; the second kills.
fn listen() -> Result<Arc<AtomicBool>, Failure> {
    let interrupted = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the first signal must not see the flag it sets itself.
        flag::register_conditional_default(signal, Arc::clone(&interrupted))
            .and_then(|_| flag::register(signal, Arc::clone(&interrupted)))
            .map_err(|e| Failure::message(format!("cannot listen to signals: {e}")))?;
    }
    Ok(interrupted)
}

fn probe<'a>(outputs: impl IntoIterator<Item = &'a OutputFile>) -> Result<(), Failure> {
    for output in outputs {
        output.probe().map_err(Failure::output)?;
    }
    Ok(())
}

/// Where images go if the command line does not say: the built-in scene to `woodcock.exr` and `woodcock.png` here, other scenes where their
/// film says, else to their own name with `.exr` here. A film name of a kind that cannot be written becomes `.exr`.
fn default_images(scene: Option<&Path>, film: Option<&Path>) -> Vec<OutputFile> {
    let names = match (film, scene) {
        (Some(film), _) if OutputFile::image(film).is_ok() => vec![film.to_owned()],
        (Some(film), _) => vec![film.with_extension("exr")],
        (None, Some(scene)) => {
            let stem = scene.file_stem().unwrap_or("woodcock".as_ref());
            vec![Path::new(stem).with_extension("exr")]
        }
        (None, None) => vec!["woodcock.exr".into(), "woodcock.png".into()],
    };
    let image = |name: PathBuf| OutputFile::image(&name).ok();
    names.into_iter().filter_map(image).collect()
}

fn complete_statistics(rendered: &mut Rendered) {
    let [width, height] = rendered.film.window().size();
    let statistics = &mut rendered.statistics;
    statistics.width = width.into();
    statistics.height = height.into();
    statistics.nonfinite_paths = rendered.film.nonfinite().count;
    statistics.relative_error = rendered.film.relative_error();
}

/// Writes all files under temporary names, then renames them.
fn write(
    rendered: &Rendered,
    images: &[OutputFile],
    stats: Option<&OutputFile>,
) -> Result<(), Failure> {
    let mut image = Image::from_film(&rendered.film);
    image.channels.extend(rendered.channels.iter().cloned());
    rendered.metadata.apply(&mut image);
    let mut staged = Vec::new();
    for output in images.iter().chain(stats) {
        let file = match output.kind() {
            OutputKind::Exr => output.stage(|to| exr::write(&image, to)),
            OutputKind::Png => output.stage(|to| png::write(&image, 1.0, to)),
            OutputKind::Json => output.stage(|to| rendered.statistics.write(to)),
        };
        staged.push(file.map_err(Failure::output)?);
    }
    output::commit(staged).map_err(Failure::output)
}

/// What nobody may overlook, `--quiet` or not.
fn warn(rendered: &Rendered) {
    let nonfinite = rendered.film.nonfinite();
    if let Some(path) = nonfinite.first {
        let count = nonfinite.count;
        eprintln!(
            "warning: {count} paths were not finite and were dropped; the first: --replay {},{},{} --seed {}",
            path.x, path.y, path.sample, rendered.metadata.seed
        );
    }
    let violations = rendered.metadata.majorant_violations;
    if violations > 0 {
        eprintln!("warning: {violations} look-ups exceeded their majorant; the image is biased");
    }
}

fn summarise(rendered: &Rendered, images: &[OutputFile]) {
    let names: Vec<_> = images
        .iter()
        .map(|i| i.path().display().to_string())
        .collect();
    let error = rendered.statistics.relative_error;
    let error = error.map_or_else(String::new, |e| {
        format!(", relative error {}", progress::percent(e))
    });
    let early = if rendered.complete {
        ""
    } else {
        " (stopped early)"
    };
    eprintln!(
        "{}: {} samples per pixel in {:.1} s{error}{early}",
        names.join(", "),
        rendered.statistics.spp,
        rendered.metadata.render_time.as_secs_f64(),
    );
}
