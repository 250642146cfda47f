//! A picture of the whole sphere, looked up and sampled.
//!
//! ```text
//! p(ω) = w(pixel of ω) / ∫ w dω,   w the mean of the three colours
//! ```
//!
//! Pixels are looked up as they are, without interpolation, as pbrt-v4 does: so the density is in proportion to what is
//! seen at *every* direction, for maps of latitude as for octahedra, and black pixels are never met. Row by row, then
//! within the row; both by inversion of running sums in double precision. The density is not lowered for what other
//! samplers find [Karlík et al. 2019]: an integrator that only looks for light would never meet the dimmer half.
//!
//! Memory: 12.5 bytes per pixel, half a byte of it for sampling, since sums are kept for every sixteenth pixel only.

use glam::DVec3;

use super::discrete::{BELOW_ONE, Discrete};
use super::layout::Layout;
use crate::image::Picture;

/// Pixels from one kept sum to the next.
const BLOCK: usize = 16;

/// Sampled places keep this far from the edges of their pixel, in its widths, so that rounding on the way to the world
/// and back never leads to the neighbour: what is sampled is what is seen there.
const EDGE: f64 = 1.0 / 4_294_967_296.0;

/// A picture of the whole sphere.
#[derive(Debug)]
pub(super) struct SphericalPicture {
    layout: Layout,
    pixels: Vec<[f32; 3]>,
    rows: Discrete,
    /// For each row, sums of weights up to the end of each block.
    blocks: Vec<f64>,
}

/// A direction, what is seen there, and the density [1/sr] of its choice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) direction: DVec3,
    pub(super) colour: [f64; 3],
    pub(super) pdf: f64,
}

/// The mean of the colours: positive wherever any colour is.
pub(super) fn mean(colour: [f64; 3]) -> f64 {
    (colour[0] + colour[1] + colour[2]) / 3.0
}

fn weight(pixel: &[f32; 3]) -> f64 {
    mean(pixel.map(f64::from))
}

impl SphericalPicture {
    /// # Errors
    /// A shape that is no map of the sphere, or a pixel that is no radiance, in a sentence without a subject.
    pub(super) fn new(picture: Picture) -> Result<Self, String> {
        let Picture {
            width,
            height,
            pixels,
        } = picture;
        let layout = Layout::of(width, height).ok_or_else(|| {
            format!(
                "has {width} × {height} pixels; a map of all directions is twice as wide as high, or square"
            )
        })?;
        let columns = width as usize;
        if pixels.len() != columns * height as usize {
            return Err("has not all of its pixels".into());
        }
        let bad = |pixel: &[f32; 3]| pixel.iter().any(|c| !(*c >= 0.0 && c.is_finite()));
        if let Some(index) = pixels.iter().position(bad) {
            let (x, y) = (index % columns, index / columns);
            return Err(format!(
                "has the pixel ({x}, {y}), counted from the top left, of {:?}; light is finite and not negative",
                pixels[index]
            ));
        }
        let mut blocks = Vec::with_capacity(columns.div_ceil(BLOCK) * height as usize);
        let rows = Discrete::new((0..height).zip(pixels.chunks(columns)).map(|(y, row)| {
            let mut sum = 0.0;
            for block in row.chunks(BLOCK) {
                block.iter().for_each(|pixel| sum += weight(pixel));
                blocks.push(sum);
            }
            sum * layout.solid_angle(y)
        }));
        Ok(Self {
            layout,
            pixels,
            rows,
            blocks,
        })
    }

    pub(super) fn layout(&self) -> &Layout {
        &self.layout
    }

    /// ∫ w dω \[sr\].
    pub(super) fn total(&self) -> f64 {
        self.rows.total()
    }

    /// The largest value of any pixel.
    pub(super) fn brightest(&self) -> f32 {
        let values = self.pixels.iter().flatten();
        values.copied().fold(0.0, f32::max)
    }

    /// ∫ of a linear function of colour times max(z, 0) dω: illuminance, if the function is luminance.
    pub(super) fn irradiance(&self, of: impl Fn([f64; 3]) -> f64) -> f64 {
        let columns = self.layout.width();
        let mut sum = 0.0;
        let at = (0..self.layout.height()).flat_map(|y| (0..columns).map(move |x| [x, y]));
        for (pixel, at) in self.pixels.iter().zip(at) {
            sum += of(pixel.map(f64::from)) * self.layout.projected_solid_angle(at);
        }
        sum
    }

    fn seen(&self, direction: DVec3, pixel: &[f32; 3]) -> Seen {
        let total = self.total();
        Seen {
            direction,
            colour: pixel.map(f64::from),
            pdf: if total > 0.0 {
                weight(pixel) / total
            } else {
                0.0
            },
        }
    }

    /// What is seen in a unit direction, and the density with which [`sample`](Self::sample) finds it.
    pub(super) fn look(&self, direction: DVec3) -> Seen {
        let [x, y] = self.layout.pixel(direction);
        let index = y as usize * self.layout.width() as usize + x as usize;
        let pixel = self.pixels.get(index).unwrap_or(&[0.0; 3]);
        self.seen(direction, pixel)
    }

    /// A direction in proportion to what is seen there. `None` if all is black.
    pub(super) fn sample(&self, u: [f64; 2]) -> Option<Seen> {
        let (row, t) = self.rows.choose(u[0])?;
        let columns = self.layout.width() as usize;
        let pixels = self.pixels.chunks(columns).nth(row)?;
        let blocks = self.blocks.chunks(columns.div_ceil(BLOCK)).nth(row)?;
        let at = u[1] * blocks.last()?;
        let last = blocks.last()?;
        let block = blocks
            .partition_point(|sum| *sum <= at)
            .min(blocks.partition_point(|sum| sum < last));
        let mut sum = if block == 0 { 0.0 } else { blocks[block - 1] };
        let mut chosen = None;
        for (index, pixel) in pixels.iter().enumerate().skip(block * BLOCK).take(BLOCK) {
            let weight = weight(pixel);
            if weight > 0.0 {
                chosen = Some((index, ((at - sum) / weight).clamp(0.0, BELOW_ONE)));
            }
            sum += weight;
            if sum > at {
                break;
            }
        }
        let (column, s) = chosen?;
        let within = [s, t].map(|c| c.clamp(EDGE, 1.0 - EDGE));
        let direction = self.layout.direction([column as u32, row as u32], within);
        Some(self.seen(direction, pixels.get(column)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(width: u32, height: u32, of: impl Fn(u32, u32) -> f32) -> Picture {
        let at = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Picture {
            width,
            height,
            pixels: at.map(|(x, y)| [of(x, y), 0.0, 0.5 * of(x, y)]).collect(),
        }
    }

    #[test]
    fn what_is_no_map_of_light_is_refused() {
        let message = |p| SphericalPicture::new(p).map(|_| ()).expect_err("refused");
        assert!(message(picture(3, 2, |_, _| 1.0)).contains("3 × 2"));
        let negative = message(picture(
            4,
            2,
            |x, y| if (x, y) == (3, 1) { -1.0 } else { 1.0 },
        ));
        assert!(negative.contains("pixel (3, 1)"), "{negative}");
        assert!(message(picture(2, 2, |_, _| f32::NAN)).contains("finite"));
        let mut short = picture(2, 2, |_, _| 1.0);
        short.pixels.pop();
        assert!(message(short).contains("not all"));
    }

    #[test]
    fn every_pixel_is_met_at_its_share_of_the_unit_square() {
        // A grid of uniform numbers: the share that each pixel takes is its probability, to the grid's step.
        let n = 2000;
        for (width, height) in [(40, 20), (33, 33)] {
            let value = |x: u32, y: u32| match (x, y) {
                (_, 3) | (17, _) => 0.0,
                (20, 7) => 300.0,
                _ => 1.0 + ((x * 7 + y * 13) % 5) as f32,
            };
            let map = SphericalPicture::new(picture(width, height, value)).expect("a map");
            let mut counts = vec![0_u32; (width * height) as usize];
            for i in 0..n * n {
                let u = [i / n, i % n].map(|c| (f64::from(c) + 0.5) / f64::from(n));
                let seen = map.sample(u).expect("not black");
                let [x, y] = map.layout.pixel(seen.direction);
                assert_eq!(seen.colour[0], f64::from(value(x, y)));
                assert_eq!(seen.pdf, map.look(seen.direction).pdf);
                counts[(y * width + x) as usize] += 1;
            }
            for y in 0..height {
                for x in 0..width {
                    let expected =
                        0.5 * f64::from(value(x, y)) * map.layout.solid_angle(y) / map.total();
                    let got = f64::from(counts[(y * width + x) as usize]) / f64::from(n * n);
                    // A pixel is a rectangle of the unit square: at most a step is lost along each side.
                    let high = map.rows.probability(y as usize);
                    let wide = if expected > 0.0 { expected / high } else { 0.0 };
                    let slack = (high + wide + 1.0 / f64::from(n)) / f64::from(n);
                    assert!(
                        (got - expected).abs() < slack,
                        "({x}, {y}): {got} {expected}"
                    );
                    assert_eq!(expected == 0.0, got == 0.0);
                }
            }
        }
    }

    #[test]
    fn black_pictures_are_never_met_and_edges_of_the_square_are() {
        let black = SphericalPicture::new(picture(4, 2, |_, _| 0.0)).expect("a map");
        assert!(black.sample([0.5, 0.5]).is_none());
        assert_eq!(black.look(DVec3::Z).pdf, 0.0);
        let map =
            SphericalPicture::new(picture(64, 32, |x, y| ((x + y) % 2) as f32)).expect("a map");
        for u in [0.0, 0.5, BELOW_ONE] {
            for v in [0.0, 0.5, BELOW_ONE] {
                assert!(map.sample([u, v]).is_some_and(|seen| seen.pdf > 0.0));
            }
        }
    }
}
