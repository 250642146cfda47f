//! From the bytes of an OpenVDB file to a scene that can be rendered: how long it takes, on all threads.
//!
//! ```text
//! cargo bench -p woodcock-benches --bench setup
//! cargo bench -p woodcock-benches --bench setup -- 256            # of this side
//! cargo bench -p woodcock-benches --bench setup -- DIRECTORY      # leaves files and scenes there, for `woodcock render`
//! ```
//!
//! A cube full of noise, no voxel empty, and a cloud that leaves 86 % empty; leaves stored, in blosc (OpenVDB's default) and in zip.
//! `read` unfolds the file's tree, `setup` is all that assembling the scene does, reading included: samples, bounds, controls. Medians
//! of rounds. `--test` takes each row once, on small cubes.
#![forbid(unsafe_code)]

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use woodcock_benches::measure::{assemble_text, median};
use woodcock_benches::quick;
use woodcock_benches::vdb::{Codec, cube};
use woodcock_benches::yardstick::{Matter, Yardstick};
use woodcock_host::volume::{Limits, vdb};

const CODECS: [Codec; 3] = [Codec::Stored, Codec::Blosc, Codec::Zip];

/// A density at the voxels of a cube.
struct Volume {
    name: &'static str,
    side: u32,
    density: Vec<f32>,
}

impl Volume {
    /// No voxel is empty, and no two are alike.
    fn full(side: u32) -> Self {
        let mut noise = 1_u32;
        let density = (0..side * side * side).map(|n| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let waves = (n % side + n / side % side + n / side / side) as f32 * 0.02;
            1.0 + 0.5 * waves.sin() + (noise >> 16) as f32 / 262_144.0
        });
        Self {
            name: "full",
            side,
            density: density.collect(),
        }
    }

    /// The cloud of the yardsticks.
    fn cloud(side: u32) -> Self {
        let Matter::Cells(cells) = Yardstick::cloud(side as usize).matter else {
            return Self::full(side);
        };
        Self {
            name: "cloud",
            side,
            density: cells.density,
        }
    }

    fn file(&self, codec: Codec) -> Result<Vec<u8>, Box<dyn Error>> {
        let side = self.side as usize;
        let at = |[x, y, z]: [i32; 3]| {
            self.density[(z as usize * side + y as usize) * side + x as usize]
        };
        Ok(cube(self.side, codec, at)?)
    }
}

/// What a work makes, and how long it takes on the clock \[s\]: threads share it.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = work();
    (made, start.elapsed().as_secs_f64())
}

/// A scene with a volume file as its only medium.
fn scene(file: &str) -> String {
    format!(
        "LookAt 0.5 0.7 -2.5  0.5 0.5 0.5  0 1 0\n\
         Camera \"perspective\" \"float fov\" 30\n\
         Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\n\
         WorldBegin\n\
         LightSource \"distant\" \"rgb L\" [ 3 3 3 ] \"point3 from\" [ -1 1 -1 ]\n\
         MakeNamedMedium \"m\" \"string type\" \"openvdb\" \"string filename\" \"{file}\"\n\
           \"rgb sigma_a\" [ 0.04 0.04 0.04 ] \"rgb sigma_s\" [ 40 40 40 ] \"float g\" 0.85\n\
         AttributeBegin\n\
         MediumInterface \"m\" \"\"\n\
         Material \"interface\"\n\
         Translate 0.5 0.5 0.5\n\
         Shape \"sphere\" \"float radius\" 1\n\
         AttributeEnd\n"
    )
}

fn main() -> Result<(), Box<dyn Error>> {
    let named: Vec<u32> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let (sides, rounds): (&[u32], usize) = match (quick(), named.as_slice()) {
        (true, _) => (&[48], 1),
        (false, []) => (&[256, 512], 7),
        (false, named) => (named, 7),
    };
    let is_directory = |a: &String| !a.starts_with('-') && a.parse::<u32>().is_err();
    let directory = std::env::args().skip(1).find(is_directory);
    println!(
        "{:<7} {:>5} {:<7} {:>8} {:>8} {:>8} {:>9}",
        "volume", "side", "leaves", "MB", "read s", "setup s", "bytes"
    );
    for side in sides {
        for volume in [Volume::full(*side), Volume::cloud(*side)] {
            for codec in CODECS {
                row(&volume, codec, rounds, directory.as_deref().map(Path::new))?;
            }
        }
    }
    Ok(())
}

fn row(
    volume: &Volume,
    codec: Codec,
    rounds: usize,
    directory: Option<&Path>,
) -> Result<(), Box<dyn Error>> {
    let bytes = volume.file(codec)?;
    let name = format!("{}_{}_{}.vdb", volume.name, volume.side, codec.name());
    let text = scene(&name);
    if let Some(directory) = directory {
        std::fs::write(directory.join(&name), &bytes)?;
        std::fs::write(
            directory.join(PathBuf::from(&name).with_extension("pbrt")),
            &text,
        )?;
        println!("{name}");
        return Ok(());
    }
    let megabytes = bytes.len() as f64 / 1e6;
    let (mut reading, mut setup, mut held) = (Vec::new(), Vec::new(), 0.0);
    for _ in 0..rounds {
        let (file, took) = timed(|| vdb::read(&bytes, &Limits::default()));
        file?;
        reading.push(took);
        // The copy is the file in memory, and not timed.
        let files = Some((name.clone(), bytes.clone()));
        let (world, took) = timed(|| assemble_text("setup.pbrt", &text, files, 16, &[]));
        let (samples, bytes) = world?.tables.size();
        held = bytes as f64 / samples as f64;
        setup.push(took);
    }
    println!(
        "{:<7} {:>5} {:<7} {megabytes:>8.1} {:>8.3} {:>8.3} {held:>9.3}",
        volume.name,
        volume.side,
        codec.name(),
        median(reading),
        median(setup),
    );
    Ok(())
}
