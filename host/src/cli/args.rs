//! The command line: DESIGN's flags, pbrt's spellings beside them.
//!
//! What a flag's name promises and this version cannot do is refused with a sentence, never ignored.

use super::method::{self, MethodSpec};
use super::values::{self, Replay};
pub use crate::integrator::Integrator;
pub use crate::render::Kernel;
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Duration;

/// A command, ready to run.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// `woodcock render`, also `woodcock` alone.
    Render(Box<RenderArgs>),
    /// `woodcock explain`.
    Explain(ExplainArgs),
    /// `woodcock info`.
    Info(InfoArgs),
    /// `woodcock compare`.
    Compare(CompareArgs),
    /// `woodcock bench`.
    Bench(Box<BenchArgs>),
}

#[derive(Debug, Parser)]
#[command(
    name = "woodcock",
    version,
    about = "Unbiased rendering of clouds, smoke and fog",
    long_about = "Unbiased rendering of clouds, smoke and fog.\n\nWithout a command, woodcock renders: \
        `woodcock scene.pbrt -o image.exr`. Without a scene it renders a cloud of its own.",
    after_help = "Exit codes: 0 done; 1 scene or file error; 2 usage; 3 stopped early, with a valid partial image",
    args_conflicts_with_subcommands = true
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Sub>,
    #[command(flatten)]
    render: RenderArgs,
}

#[derive(Debug, Subcommand)]
enum Sub {
    /// Render a scene
    Render(Box<RenderArgs>),
    /// Say what a scene needs, what is skipped, and which kernel runs
    Explain(ExplainArgs),
    /// Describe a .vdb, .nvdb, .vol or .exr file
    Info(InfoArgs),
    /// Say whether two images show the same; exit code 1 if they differ significantly
    Compare(CompareArgs),
    /// Measure run time against error of several methods: table, CSV, SVG and an HTML page
    Bench(Box<BenchArgs>),
    // Names that are taken, so that they are not mistaken for scenes.
    #[command(hide = true, disable_help_flag = true)]
    Merge(Later),
    #[command(hide = true, disable_help_flag = true)]
    Farm(Later),
}

#[derive(Debug, Args)]
struct Later {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    _rest: Vec<OsString>,
}

/// Arguments of `render`; syntax, ranges and file kinds are checked, files are not touched.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct RenderArgs {
    /// Scene in pbrt-v4's language; the built-in cloud if none is given
    #[arg(value_name = "SCENE.pbrt")]
    pub scene: Option<PathBuf>,
    /// Image to write, .exr (linear, with variance) or .png (tone-mapped); may be given once for each
    #[arg(short, long = "output", visible_alias = "outfile", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,
    /// Samples per pixel
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(crate::film::sum::CAPACITY)))]
    pub spp: Option<u32>,
    /// Stop after this time, between whole passes
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub time: Option<Duration>,
    /// Relative error at which to stop, as 0.01 or 1%
    ///
    /// A pilot render, thrown away, decides how many samples each block of 8 x 8 pixels gets, so that with 95 % confidence its error
    /// is at most R: the root mean square over its pixels and colours of (standard error of the mean) / sqrt(mean^2 + 0.01 m^2), m the
    /// mean of the picture. With --spp, no pixel gets more samples than that; a target not reached ends with exit code 3.
    #[arg(long, value_name = "R", value_parser = values::relative)]
    pub target_error: Option<f64>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads; 0 for all. The image does not depend on it
    #[arg(short, long = "threads", visible_alias = "nthreads", value_name = "N")]
    pub threads: Option<usize>,
    /// How light is transported; the scene's way if not given
    #[arg(long, value_enum, value_name = "NAME")]
    pub integrator: Option<Integrator>,
    /// Transmittance estimator; chosen by the scene if not given
    #[arg(long, value_enum, value_name = "NAME")]
    pub transmittance: Option<Transmittance>,
    /// Sixteen lanes or one; the same bits
    #[arg(long, value_enum, value_name = "NAME", default_value_t)]
    pub kernel: Kernel,
    /// Keep work that the scene does not need (see `explain`); may be repeated
    #[arg(long, value_name = "FEATURE")]
    pub keep: Vec<String>,
    /// Size of the picture, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = values::resolution)]
    pub resolution: Option<[u32; 2]>,
    /// Part of the picture to render, in fractions of it
    #[arg(
        long,
        visible_alias = "cropwindow",
        value_name = "X0,X1,Y0,Y1",
        value_parser = values::crop,
        allow_hyphen_values = true
    )]
    pub crop: Option<[f64; 4]>,
    /// Most scatterings of a path; without it, no limit but the scene's
    #[arg(long, value_name = "N")]
    pub max_depth: Option<u32>,
    /// Split camera rays in media into this many paths, at evenly spread distances (path and single)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub split: Option<u32>,
    /// Bound on 1/r² where paths from camera and lights are joined; nothing is lost (bdpt and mlt)
    #[arg(long, value_name = "B", value_parser = values::positive)]
    pub connection_bound: Option<f64>,
    /// Further layers of the .exr image, separated by commas
    #[arg(long, value_enum, value_name = "LAYER", value_delimiter = ',')]
    pub aov: Vec<Aov>,
    /// Write statistics as JSON
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Trace a single path again and tell its story; writes no image
    #[arg(long, value_name = "X,Y,SAMPLE", value_parser = values::replay, conflicts_with_all = ["outputs", "stats", "spp", "time", "target_error"])]
    pub replay: Option<Replay>,
    /// Most memory for volumes and film, with K, M, G or T
    #[arg(long, value_name = "BYTES", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
    /// Warn about what is not understood in the scene instead of stopping
    #[arg(long)]
    pub lenient: bool,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
    /// Flags that are refused; nothing to read here
    #[command(flatten)]
    pub later: LaterFlags,
}

/// Flags of the design that do not work yet: known, so that the refusal can be clear.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct LaterFlags {
    #[arg(long, hide = true, num_args = 1)]
    shard: Option<Box<str>>,
    #[arg(long, hide = true)]
    resume: bool,
    #[arg(long, hide = true, num_args = 1)]
    display_server: Option<Box<str>>,
}

impl LaterFlags {
    fn first(&self) -> Option<&'static str> {
        [
            (self.shard.is_some(), "--shard"),
            (self.resume, "--resume"),
            (self.display_server.is_some(), "--display-server"),
        ]
        .into_iter()
        .find_map(|(given, name)| given.then_some(name))
    }
}

/// Arguments of `explain`.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct ExplainArgs {
    /// Scene in pbrt-v4's language; the built-in cloud if none is given
    #[arg(value_name = "SCENE.pbrt")]
    pub scene: Option<PathBuf>,
    /// Most memory for volumes, with K, M, G or T
    #[arg(long, value_name = "BYTES", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
    /// Warn about what is not understood in the scene instead of stopping
    #[arg(long)]
    pub lenient: bool,
}

/// Arguments of `info`.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct InfoArgs {
    /// A .vdb, .nvdb, .vol or .exr file
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Machine-readable
    #[arg(long)]
    pub json: bool,
    /// This grid only
    #[arg(long, value_name = "NAME")]
    pub grid: Option<String>,
    /// Trilinear value at a world point; may be repeated
    #[arg(long, value_name = "X,Y,Z", value_parser = values::point, allow_hyphen_values = true)]
    pub at: Vec<[f64; 3]>,
    /// Exact line integral along a world segment; may be repeated
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", value_parser = values::segment, allow_hyphen_values = true)]
    pub ray: Vec<[f64; 6]>,
    /// Most memory, with K, M, G or T
    #[arg(long, value_name = "BYTES", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
}

/// Arguments of `compare`.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct CompareArgs {
    /// An .exr image of woodcock
    #[arg(value_name = "A.exr")]
    pub first: PathBuf,
    /// Another of the same size
    #[arg(value_name = "B.exr")]
    pub second: PathBuf,
    /// How often images of the same expectation may be said to differ
    #[arg(long, value_name = "RATE", value_parser = values::relative, default_value = "0.001")]
    pub false_alarms: f64,
    /// Most memory, with K, M, G or T
    #[arg(long, value_name = "BYTES", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
}

/// Arguments of `bench`.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub struct BenchArgs {
    /// Scenes; the built-in cloud if none is given
    #[arg(value_name = "SCENE.pbrt")]
    pub scenes: Vec<PathBuf>,
    /// A method, as path,kernel=scalar,transmittance=delta,keep=FEATURE,split=N; may be repeated. Those that suit the scene if not given
    #[arg(short, long = "method", value_name = "METHOD", value_parser = method::method)]
    pub methods: Vec<MethodSpec>,
    /// Name of the files to write, to which .csv, .svg and .html are added
    #[arg(short, long, value_name = "NAME", default_value = "woodcock-bench")]
    pub output: PathBuf,
    /// Time for everything, about; 120 if not given
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds)]
    pub time: Option<Duration>,
    /// Small pictures in ten seconds: to see that it runs
    #[arg(long)]
    pub quick: bool,
    /// Budgets, each of twice as many samples as the one before
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(3..=16))]
    pub budgets: u32,
    /// Runs of each method at each budget
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(2..=1000))]
    pub seeds: u32,
    /// Seed from which those of all runs are counted
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Picture to compare with, an .exr with variance, of other seeds; rendered if not given
    #[arg(long, value_name = "FILE.exr", conflicts_with = "reference_method")]
    pub reference: Option<PathBuf>,
    /// Method that renders the reference; the first if not given
    #[arg(long, value_name = "METHOD", value_parser = method::method)]
    pub reference_method: Option<MethodSpec>,
    /// Size of the pictures, in place of the scenes'
    #[arg(long, value_name = "WxH", value_parser = values::resolution)]
    pub resolution: Option<[u32; 2]>,
    /// Most scatterings of a path; without it, no limit but the scene's
    #[arg(long, value_name = "N")]
    pub max_depth: Option<u32>,
    /// Threads; 0 for all
    #[arg(short, long = "threads", visible_alias = "nthreads", value_name = "N")]
    pub threads: Option<usize>,
    /// Most memory for volumes and film, with K, M, G or T
    #[arg(long, value_name = "BYTES", value_parser = values::bytes)]
    pub max_memory: Option<u64>,
    /// Warn about what is not understood in a scene instead of stopping
    #[arg(long)]
    pub lenient: bool,
    /// No progress
    #[arg(short, long)]
    pub quiet: bool,
}

/// Further layers of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Aov {
    /// Albedo.R/G/B of what is seen first
    Albedo,
    /// N.X/Y/Z: shading normal of what is seen first
    Normal,
    /// Z: distance of what is seen first
    Depth,
    /// Volume.* and Surface.*: light from media, and the rest
    Matter,
    /// Direct.* and Indirect.*: light scattered at most once, and the rest
    Order,
}

/// Transmittance estimators for shadow rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Transmittance {
    /// Product of null-collision probabilities
    Ratio,
    /// Zero or one: did a delta-tracking flight get through
    Delta,
    /// Closed form, for media that have one
    Closed,
    /// Power series about a jittered estimate, for scenes that only absorb
    PowerSeries,
}

impl Transmittance {
    /// Name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ratio => "ratio",
            Self::Delta => "delta",
            Self::Closed => "closed",
            Self::PowerSeries => "power-series",
        }
    }
}

/// Parses a command line, program name first.
///
/// The error carries its own message and exit code: 2, or 0 for `--help` and `--version`.
pub fn parse(args: impl IntoIterator<Item = OsString>) -> Result<Command, clap::Error> {
    let cli = Cli::try_parse_from(args)?;
    match cli.command {
        None => render(cli.render),
        Some(Sub::Render(args)) => render(*args),
        Some(Sub::Explain(args)) => Ok(Command::Explain(args)),
        Some(Sub::Info(args)) => Ok(Command::Info(args)),
        Some(Sub::Compare(args)) => Ok(Command::Compare(args)),
        Some(Sub::Bench(args)) => Ok(Command::Bench(args)),
        Some(Sub::Merge(_)) => Err(not_yet("merge")),
        Some(Sub::Farm(_)) => Err(not_yet("farm")),
    }
}

fn render(args: RenderArgs) -> Result<Command, clap::Error> {
    if let Some(flag) = args.later.first() {
        return Err(not_yet(flag));
    }
    if let Err(error) = crate::output::OutputFile::images(&args.outputs) {
        return Err(Cli::command().error(ErrorKind::ValueValidation, error.to_string()));
    }
    Ok(Command::Render(Box::new(args)))
}

fn not_yet(what: &str) -> clap::Error {
    let message = format!("{what} is not yet supported by this version");
    Cli::command().error(ErrorKind::InvalidValue, message)
}
