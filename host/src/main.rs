//! The `woodcock` command.
#![forbid(unsafe_code)]

use std::process::ExitCode;
use woodcock_host::cli::args::{ExplainArgs, InfoArgs, RenderArgs};
use woodcock_host::cli::failure::{EXIT_FAILURE, Failure};
use woodcock_host::cli::render::Prepared;
use woodcock_host::cli::{self, Commands, cpu};

fn main() -> ExitCode {
    if let Some(sentence) = cpu::missing_features() {
        eprintln!("error: {sentence}");
        return ExitCode::from(EXIT_FAILURE);
    }
    let commands = Commands {
        prepare,
        replay,
        explain,
        info,
    };
    cli::main(std::env::args_os(), &commands)
}

fn prepare(_: &RenderArgs) -> Result<Prepared, Failure> {
    Err(not_connected())
}

fn replay(_: &RenderArgs) -> Result<String, Failure> {
    Err(not_connected())
}

fn explain(_: &ExplainArgs) -> Result<String, Failure> {
    Err(not_connected())
}

fn info(_: &InfoArgs) -> Result<String, Failure> {
    Err(not_connected())
}

/// The renderer is connected where this branch meets the others; until then the binary says so.
fn not_connected() -> Failure {
    Failure::message("this build has no renderer")
}
