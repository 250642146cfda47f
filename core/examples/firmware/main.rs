//! Firmware for a Cortex-M4F: a picture of fog, a transmittance and the table of results that every machine repeats, in
//! 32 KiB of flash and 16 KiB of RAM, checked on the machine itself.
//!
//! `.ci/run firmware` runs it under QEMU; elsewhere it is an ordinary program that says and checks the same.
#![cfg_attr(target_os = "none", no_std, no_main)]

use woodcock_core::majorant::{MajorantGrid, fill_majorants};
use woodcock_core::medium::{Grid, IDENTITY};
use woodcock_core::ray::Ray;
use woodcock_core::stream::{Key, PathStream};
use woodcock_core::transmittance::ratio;
use woodcock_core::vec3::Vec3;

#[cfg(target_os = "none")]
mod board;
#[path = "../fog/picture.rs"]
mod picture;
#[path = "../same_bits/table.rs"]
mod table;

/// The [hash](fog) of the picture.
const PICTURE: u32 = 0xe93f_d117;
/// The bits of the [transmittance].
const TRANSMITTANCE: u32 = 0x3e09_2bb3;

/// Where text goes.
type Out<'a> = &'a mut dyn FnMut(&[u8]);

/// Renders fog, writes it row by row, and returns FNV-1a over the bits of its radiances.
#[inline(never)]
fn fog(out: Out<'_>) -> Option<u32> {
    let mut image = [[0.0; 32]; 10];
    picture::render(&mut image, 16)?;
    let mut hash = 0x811c_9dc5_u32;
    for row in &image {
        for &radiance in row {
            for byte in radiance.to_bits().to_le_bytes() {
                hash = (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
            }
            out(&[picture::shade(radiance)]);
        }
        out(b"\n");
    }
    Some(hash)
}

/// Transmittance by ratio tracking on a ray along which extinction rises from 0 to 1/4 and falls back, in 16 cells.
///
/// ```text
/// τ = 16 · 1/4 · 1/2 = 2,   relative variance exp(∫σ_t²/σ̄) − 1 = e^(4/3) − 1
/// ```
#[inline(never)]
fn transmittance(paths: u16) -> Option<f32> {
    let mut samples = [0.0; 17 * 2 * 2];
    let mut majorants = [0.0; 4 * 3 * 3];
    for (i, sample) in samples.iter_mut().enumerate() {
        *sample = 0.125 * (i % 17).min(16 - i % 17) as f32;
    }
    fill_majorants(&samples, [17, 2, 2], &mut majorants).ok()?;
    let bounds = MajorantGrid::new(&samples, [17, 2, 2], &majorants).ok()?;
    let grid = Grid::new(bounds, IDENTITY, 0.25)?;
    let ray: Ray<f32> = Ray {
        origin: Vec3::splat([0.0, 0.5, 0.5]),
        direction: Vec3::splat([1.0, 0.0, 0.0]),
    };
    let mut sum = 0.0;
    for sample in 0..paths.into() {
        let mut rng = PathStream::new(Key {
            seed: 6,
            pixel: 2,
            sample,
        });
        sum += ratio::estimate(&grid, &ray, 16.0, &mut rng, true);
    }
    Some(sum / f32::from(paths))
}

fn hexadecimal(out: Out<'_>, name: &[u8], number: u64, digits: u32) {
    out(name);
    for digit in (0..digits).rev() {
        let digit = (number >> (4 * digit)) as u8 & 15;
        out(&[if digit < 10 {
            b'0' + digit
        } else {
            b'a' + digit - 10
        }]);
    }
    out(b"\n");
}

/// Does everything, says how it went, and whether all came out as it must.
fn run(out: Out<'_>) -> bool {
    let picture = fog(out).unwrap_or(0);
    hexadecimal(out, b"fog           ", picture.into(), 8);
    let mean = transmittance(4096).unwrap_or(f32::NAN);
    hexadecimal(out, b"transmittance ", mean.to_bits().into(), 8);
    let table = table::hash::<f32, PathStream>();
    hexadecimal(out, b"table         ", table, 16);
    // e⁻², and four standard errors of 4096 estimates.
    let right = (mean - 0.135_335).abs() < 4.0 * 0.135_335 * 1.671 / 64.0;
    let same = picture == PICTURE && mean.to_bits() == TRANSMITTANCE && table == table::HASH;
    out(if right && same {
        b"passed\n"
    } else {
        b"FAILED\n"
    });
    right && same
}

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    let passed = run(&mut |text| print!("{}", String::from_utf8_lossy(text)));
    std::process::ExitCode::from(u8::from(!passed))
}
