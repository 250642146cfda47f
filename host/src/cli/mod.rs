//! The command line: arguments, progress, signals, files and exit codes around what the library computes.
//!
//! [`main`] is handed the commands' work as functions ([`Commands`]), so that nothing here knows how a scene is loaded or rendered.
//!
//! Exit codes: 0 done, also when `--time` is reached; 1 scene or file error, or images that differ; 2 usage; 3 stopped before what was asked
//! (signal, or time up before the samples or the error asked for), with a valid partial image.

pub mod args;
#[cfg(test)]
mod args_tests;
pub mod bench;
pub mod commands;
mod compare;
pub mod cpu;
pub mod failure;
pub mod info;
pub mod method;
pub mod progress;
pub mod render;
#[cfg(test)]
mod render_tests;
mod shoot;
pub mod values;

use args::{BenchArgs, Command, ExplainArgs, InfoArgs, RenderArgs};
use failure::Failure;
use render::Prepared;
use std::ffi::OsString;
use std::io::{self, Write};
use std::process::ExitCode;

/// What the commands do. The text that some return goes to standard output.
#[derive(Clone, Copy, Debug)]
pub struct Commands {
    /// Loads and checks a scene; the result renders it.
    pub prepare: fn(&RenderArgs) -> Result<Prepared, Failure>,
    /// Traces the path of `args.replay`, which is given, and tells its story.
    pub replay: fn(&RenderArgs) -> Result<String, Failure>,
    /// Tells what a scene needs.
    pub explain: fn(&ExplainArgs) -> Result<String, Failure>,
    /// Describes a volume file. Images are described here.
    pub info: fn(&InfoArgs) -> Result<String, Failure>,
    /// Measures run time against error, and writes it down.
    pub bench: fn(&BenchArgs) -> Result<String, Failure>,
}

/// Runs a command line, program name first.
pub fn main(args: impl IntoIterator<Item = OsString>, commands: &Commands) -> ExitCode {
    let command = match args::parse(args) {
        Ok(command) => command,
        Err(error) => {
            // Help goes to standard output, errors to standard error; a closed pipe is nobody's fault.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(failure::EXIT_USAGE));
        }
    };
    let result = match command {
        Command::Render(args) if args.replay.is_some() => (commands.replay)(&args).map(show),
        Command::Render(args) => render::run(&args, commands.prepare),
        Command::Explain(args) => (commands.explain)(&args).map(show),
        Command::Bench(args) => (commands.bench)(&args).map(show),
        Command::Compare(args) => compare::run(&args).map(|(text, differ)| {
            let shown = show(text);
            if differ {
                ExitCode::from(failure::EXIT_FAILURE)
            } else {
                shown
            }
        }),
        Command::Info(args) => {
            let extension = args.file.extension();
            let is_image = extension.is_some_and(|e| e.eq_ignore_ascii_case("exr"));
            let text = if is_image {
                info::image(&args)
            } else {
                (commands.info)(&args)
            };
            text.map(show)
        }
    };
    result.unwrap_or_else(|failure| failure.exit())
}

/// Prints a command's answer. A closed pipe (`woodcock info x | head`) is no error.
fn show(text: String) -> ExitCode {
    match io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() != io::ErrorKind::BrokenPipe => {
            Failure::message(format!("standard output: {e}")).exit()
        }
        _ => ExitCode::SUCCESS,
    }
}
