//! The `woodcock` command.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use woodcock_host::cli::failure::EXIT_FAILURE;
use woodcock_host::cli::{self, Commands, bench, commands, cpu};

fn main() -> ExitCode {
    if let Some(sentence) = cpu::missing_features() {
        eprintln!("error: {sentence}");
        return ExitCode::from(EXIT_FAILURE);
    }
    let commands = Commands {
        prepare: commands::prepare,
        replay: commands::replay,
        explain: commands::explain,
        info: commands::info,
        bench: bench::run,
    };
    cli::main(std::env::args_os(), &commands)
}
