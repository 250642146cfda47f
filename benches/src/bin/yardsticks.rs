//! Writes the scenes that efficiency is measured by, as files.
//!
//! ```text
//! cargo run --release -p woodcock-benches --bin yardsticks -- DIRECTORY [NAME...]
//! ```
#![forbid(unsafe_code)]

use std::error::Error;
use std::fs;
use std::path::Path;

use woodcock_benches::yardstick::{BOX_FOG, NAMES, Yardstick};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let Some(directory) = arguments.next() else {
        return Err(format!(
            "usage: yardsticks DIRECTORY [NAME...], of {}",
            NAMES.join(", ")
        )
        .into());
    };
    let wanted: Vec<String> = arguments.collect();
    if let Some(unknown) = wanted.iter().find(|name| !NAMES.contains(&name.as_str())) {
        return Err(format!("no scene {unknown:?}; there are {}", NAMES.join(", ")).into());
    }
    let directory = Path::new(&directory);
    fs::create_dir_all(directory)?;
    for name in NAMES {
        if !wanted.is_empty() && !wanted.iter().any(|w| w == name) {
            continue;
        }
        let scene = Yardstick::named(name, 1);
        let text = scene.as_ref().map_or(BOX_FOG.to_owned(), Yardstick::text);
        fs::write(directory.join(format!("{name}.pbrt")), text)?;
        if let Some((file, bytes)) = scene.as_ref().and_then(Yardstick::volume) {
            fs::write(directory.join(file), bytes)?;
        }
    }
    Ok(())
}
