//! Fog in front of the sun, with the core alone: `cargo run --release -p woodcock-core --example fog`.
//!
//! [`picture`] is what an embedder writes: no heap, no standard library, and firmware runs it as it
//! stands. Only this file, which prints, needs a terminal.
mod picture;

use std::process::ExitCode;

/// Prints the picture as characters or, asked with `--pgm`, as a grey map that viewers open.
fn main() -> ExitCode {
    let mut image = [[0.0; 64]; 20];
    if picture::render(&mut image, 256).is_none() {
        return ExitCode::FAILURE;
    }
    if std::env::args().any(|argument| argument == "--pgm") {
        println!("P2 64 20 255");
        for radiance in image.as_flattened() {
            println!("{}", (radiance * 200.0) as u8);
        }
        return ExitCode::SUCCESS;
    }
    for row in image {
        let shades = row.map(|radiance| char::from(picture::shade(radiance)));
        println!("{}", shades.iter().collect::<String>());
    }
    ExitCode::SUCCESS
}
