//! Textures made ready: a colour at each (u, v).
//!
//! ```text
//! (s, t) = (su u + du, sv v + dv)       column = s · width, row from below = t · height
//! value  = scale · picture              or max(0, 1 − scale · picture)
//! ```
//!
//! t = 0 is the bottom of a picture, as in pbrt. Pixels have their centres at halves. The filter comes before scale and
//! inversion. Source of the conventions: [Pharr, Jakob, Humphreys 2023], chapter 10.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec2;

use crate::image::{Picture, read_picture};
use crate::scene::{self, Encoding, Files, Filter, ImageMap, Place, SceneError, Wrap};
use crate::volume::Limits;

/// By how much rounding may lift a reflectance above one.
const ROUNDING: f64 = 1e-6;

/// Pictures already read, so that each is held once.
pub struct Pictures<'f> {
    files: &'f dyn Files,
    /// Of this, pictures take away.
    limits: Limits,
    read: Vec<(PathBuf, Option<Encoding>, Arc<Picture>)>,
}

impl std::fmt::Debug for Pictures<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} pictures", self.read.len())
    }
}

impl<'f> Pictures<'f> {
    /// None yet; all together may take what `limits` says.
    pub fn new(files: &'f dyn Files, limits: Limits) -> Self {
        let read = Vec::new();
        Self {
            files,
            limits,
            read,
        }
    }

    fn read(&mut self, map: &ImageMap) -> Result<Arc<Picture>, SceneError> {
        let known = self
            .read
            .iter()
            .find(|(path, encoding, _)| *path == map.filename && *encoding == map.encoding);
        if let Some((_, _, picture)) = known {
            return Ok(Arc::clone(picture));
        }
        let picture = read_picture(self.files, &map.filename, map.encoding, &self.limits)
            .map_err(|error| refuse(&map.place, &map.filename, &error))?;
        let held = size_of_val(picture.pixels.as_slice()) as u64;
        self.limits.max_memory = self.limits.max_memory.saturating_sub(held);
        let picture = Arc::new(picture);
        self.read
            .push((map.filename.clone(), map.encoding, Arc::clone(&picture)));
        Ok(picture)
    }
}

fn refuse(place: &Place, path: &std::path::Path, error: &str) -> SceneError {
    SceneError::at(place, format!("{}: {error}", path.display()))
}

/// A colour at each point of a surface, linear Rec. 709: a constant times pictures.
#[derive(Clone, Debug)]
pub struct Texture {
    factor: [f64; 3],
    images: Vec<Image>,
}

/// A picture laid onto a surface.
#[derive(Clone, Debug)]
struct Image {
    picture: Arc<Picture>,
    map: ImageMap,
}

impl Texture {
    /// Makes a texture ready. However deep the nesting of products, it becomes a list.
    ///
    /// # Errors
    /// At the picture's place, a file that cannot be read or a mapping that is not finite; at `place`, a constant that
    /// is not finite.
    pub fn new(
        texture: &scene::Texture,
        pictures: &mut Pictures<'_>,
        place: &Place,
    ) -> Result<Self, SceneError> {
        let mut factor = [1.0; 3];
        let mut images = Vec::new();
        let mut left = vec![texture];
        while let Some(texture) = left.pop() {
            match texture {
                scene::Texture::Constant(value) => factor = product(factor, *value),
                scene::Texture::Scale(a, b) => left.extend([&**b, &**a]),
                scene::Texture::Image(map) => {
                    let numbers = map.mapping.iter().chain([&map.scale]);
                    if numbers.into_iter().any(|x| !x.is_finite()) {
                        return Err(SceneError::at(&map.place, "a mapping is not finite"));
                    }
                    let picture = pictures.read(map)?;
                    let map = map.clone();
                    images.push(Image { picture, map });
                }
            }
        }
        if factor.iter().any(|x| !x.is_finite()) {
            return Err(SceneError::at(place, "a colour is not finite"));
        }
        Ok(Self { factor, images })
    }

    /// The colour at texture coordinates; total.
    pub fn at(&self, uv: DVec2) -> [f64; 3] {
        let images = self.images.iter().map(|image| image.at(uv));
        images.fold(self.factor, product)
    }

    /// Checks that values are reflectances, up to rounding: in [0, 1] at each pixel. For a product of pictures, the
    /// product of their extremes is taken.
    ///
    /// # Errors
    /// The value beyond: at the place of its picture, with the pixel; at `place` for constants.
    pub fn check_reflectance(&self, place: &Place) -> Result<(), SceneError> {
        for colour in 0..3 {
            let factor = self.factor[colour];
            let start = [Extreme::of(factor), Extreme::of(factor)];
            let images = self.images.iter().map(|image| image.extremes(colour));
            for extreme in images.fold(start, products) {
                let value = extreme.value;
                if (0.0..=1.0 + ROUNDING).contains(&value) {
                    continue;
                }
                let error = match extreme.pixel {
                    Some(([x, y], map)) => {
                        let error = format!(
                            "pixel ({x}, {y}), counted from the top left, makes a reflectance of {value}, \
                             outside of [0, 1]"
                        );
                        refuse(&map.place, &map.filename, &error)
                    }
                    None => {
                        let error = format!("a reflectance is {value}, outside of [0, 1]");
                        SceneError::at(place, error)
                    }
                };
                return Err(error.help("scale it down"));
            }
        }
        Ok(())
    }
}

fn product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// The least or the greatest value of something, and the pixel (column, row) of the picture that has it.
#[derive(Clone, Copy)]
struct Extreme<'t> {
    value: f64,
    pixel: Option<([usize; 2], &'t ImageMap)>,
}

impl Extreme<'_> {
    fn of(value: f64) -> Self {
        Self { value, pixel: None }
    }
}

/// Bounds of a product from those of its factors.
fn products<'t>(a: [Extreme<'t>; 2], b: [Extreme<'t>; 2]) -> [Extreme<'t>; 2] {
    let mut all = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| Extreme {
        value: a[i].value * b[j].value,
        pixel: b[j].pixel.or(a[i].pixel),
    });
    all.sort_by(|x, y| x.value.total_cmp(&y.value));
    [all[0], all[3]]
}

impl Image {
    fn at(&self, uv: DVec2) -> [f64; 3] {
        let [su, sv, du, dv] = self.map.mapping;
        let (s, t) = (su * uv.x + du, sv * uv.y + dv);
        if !(s.is_finite() && t.is_finite()) {
            return self.shade([0.0; 3]);
        }
        // To one period, or to where nothing changes any more: far away no digits are left for pixels.
        let near = |s: f64| match self.map.wrap {
            Wrap::Repeat => s - s.floor(),
            Wrap::Black | Wrap::Clamp => s.clamp(-1.0, 2.0),
        };
        let (s, t) = (near(s), near(t));
        let x = s * f64::from(self.picture.width);
        let y = t * f64::from(self.picture.height);
        self.shade(match self.map.filter {
            Filter::Point => self.pixel(x.floor(), y.floor()),
            Filter::Bilinear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (column, row) = (x.floor(), y.floor());
                let (x, y) = (x - column, y - row);
                let corners = [
                    ((1.0 - x) * (1.0 - y), self.pixel(column, row)),
                    (x * (1.0 - y), self.pixel(column + 1.0, row)),
                    ((1.0 - x) * y, self.pixel(column, row + 1.0)),
                    (x * y, self.pixel(column + 1.0, row + 1.0)),
                ];
                let mut sum = [0.0; 3];
                for (weight, pixel) in corners {
                    for (sum, value) in sum.iter_mut().zip(pixel) {
                        *sum += weight * value;
                    }
                }
                sum
            }
        })
    }

    /// The pixel of a column and a row *from below*, both whole.
    fn pixel(&self, column: f64, row: f64) -> [f64; 3] {
        let (Some(x), Some(y)) = (
            self.wrapped(column, self.picture.width),
            self.wrapped(row, self.picture.height),
        ) else {
            return [0.0; 3];
        };
        let width = self.picture.width as usize;
        let from_top = self.picture.height as usize - 1 - y;
        self.picture.pixels[from_top * width + x].map(f64::from)
    }

    /// A whole number brought into [0, size); `None` is black.
    fn wrapped(&self, x: f64, size: u32) -> Option<usize> {
        let last = f64::from(size) - 1.0;
        let inside = (0.0..=last).contains(&x);
        let x = match self.map.wrap {
            _ if inside => x,
            Wrap::Black => return None,
            Wrap::Clamp => x.clamp(0.0, last),
            // Coordinates are within a period already, so that a step beyond is one pixel.
            Wrap::Repeat if x < 0.0 => last,
            Wrap::Repeat => 0.0,
        };
        Some(x as usize)
    }

    /// Scale and inversion.
    fn shade(&self, value: [f64; 3]) -> [f64; 3] {
        value.map(|x| {
            let x = self.map.scale * x;
            if self.map.invert {
                (1.0 - x).max(0.0)
            } else {
                x
            }
        })
    }

    fn extremes(&self, colour: usize) -> [Extreme<'_>; 2] {
        let width = self.picture.width as usize;
        let mut extremes = [Extreme::of(f64::INFINITY), Extreme::of(f64::NEG_INFINITY)];
        for (index, pixel) in self.picture.pixels.iter().enumerate() {
            let value = self.shade(pixel.map(f64::from))[colour];
            let found = Extreme {
                value,
                pixel: Some(([index % width, index / width], &self.map)),
            };
            if value < extremes[0].value {
                extremes[0] = found;
            }
            if value > extremes[1].value {
                extremes[1] = found;
            }
        }
        extremes
    }
}
