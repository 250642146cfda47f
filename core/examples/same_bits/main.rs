//! Prints the hash of ten thousand results of the core, which every machine repeats; fails where this one does not.
//!
//! `cargo run --release -p woodcock-core --example same_bits`
mod table;

use std::process::ExitCode;
use woodcock_core::stream::PathStream;

fn main() -> ExitCode {
    let found = table::hash::<f32, PathStream>();
    println!("{} results of woodcock-core: {found:016x}", table::ROWS);
    if found == table::HASH {
        return ExitCode::SUCCESS;
    }
    eprintln!("expected: {:016x}", table::HASH);
    ExitCode::FAILURE
}
