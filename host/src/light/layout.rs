//! Two ways to lay a sphere out as a picture, by pixel: the direction of a place within a pixel, the pixel of a
//! direction, and the solid angle of a pixel.
//!
//! Within a pixel, places that are spread evenly give directions that are spread evenly: in maps of latitude and
//! longitude because the cosine, not the angle, is divided evenly between a row's edges, and in the octahedron because
//! it keeps areas. So a pixel of one radiance needs no Jacobian beyond its solid angle, at the poles neither.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI, TAU};

use glam::DVec3;

/// A way to lay the sphere out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Rows by polar angle from +z, columns by azimuth from +x over +y.
    LatitudeLongitude,
    /// The equal-area octahedron [Clarberg 2008], turned as in pbrt-v4: +z in the middle, −z in the corners, +x on
    /// the right.
    Octahedral,
}

/// A way to lay the sphere out, and the picture's size.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    kind: Kind,
    width: u32,
    height: u32,
}

impl Layout {
    /// By shape: twice as wide as high, or square. `None` for others.
    pub(super) fn of(width: u32, height: u32) -> Option<Self> {
        let kind = match (u64::from(width), u64::from(height)) {
            (0, _) | (_, 0) => return None,
            (w, h) if w == 2 * h => Kind::LatitudeLongitude,
            (w, h) if w == h => Kind::Octahedral,
            _ => return None,
        };
        Some(Self {
            kind,
            width,
            height,
        })
    }

    pub(super) fn is_octahedral(&self) -> bool {
        self.kind == Kind::Octahedral
    }

    pub(super) fn width(&self) -> u32 {
        self.width
    }

    pub(super) fn height(&self) -> u32 {
        self.height
    }

    /// Polar angle of the upper edge of a row of latitude.
    fn polar(&self, row: u32) -> f64 {
        PI * (f64::from(row) / f64::from(self.height))
    }

    /// Solid angle of each pixel of a row \[sr\].
    pub(super) fn solid_angle(&self, row: u32) -> f64 {
        match self.kind {
            Kind::LatitudeLongitude => {
                // cos a − cos b without the cancellation near the poles.
                let (a, b) = (self.polar(row), self.polar(row + 1));
                let band = 2.0 * libm::sin(0.5 * (a + b)) * libm::sin(0.5 * (b - a));
                TAU / f64::from(self.width) * band
            }
            Kind::Octahedral => {
                let size = f64::from(self.width);
                4.0 * PI / (size * size)
            }
        }
    }

    /// ∫ max(z, 0) dω over a pixel \[sr\]: its share in the irradiance of a plane that faces +z.
    pub(super) fn projected_solid_angle(&self, [column, row]: [u32; 2]) -> f64 {
        match self.kind {
            Kind::LatitudeLongitude => {
                let sine = |row| libm::sin(self.polar(row).min(FRAC_PI_2));
                let (a, b) = (sine(row), sine(row + 1));
                TAU / f64::from(self.width) * 0.5 * (b - a) * (b + a)
            }
            Kind::Octahedral => {
                let size = f64::from(self.width);
                let edge = |i: u32| 2.0 * f64::from(i) / size - 1.0;
                let across = halves(edge(column), edge(column + 1));
                let down = halves(edge(row), edge(row + 1));
                let mut sum = 0.0;
                for [a, b] in across {
                    for [c, d] in down.clone() {
                        sum += diamond(b + d) - diamond(a + d) - diamond(b + c) + diamond(a + c);
                    }
                }
                // The square of area 4 holds the sphere's 4π.
                PI * sum
            }
        }
    }

    /// The unit direction at a place within a pixel, both coordinates in [0, 1) from its left upper corner.
    pub(super) fn direction(&self, [column, row]: [u32; 2], [s, t]: [f64; 2]) -> DVec3 {
        match self.kind {
            Kind::LatitudeLongitude => {
                let (a, b) = (libm::cos(self.polar(row)), libm::cos(self.polar(row + 1)));
                let z = a + (b - a) * t;
                let radius = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
                let turn = (f64::from(column) + s) / f64::from(self.width);
                let (sin, cos) = libm::sincos(TAU * turn);
                DVec3::new(radius * cos, radius * sin, z)
            }
            Kind::Octahedral => {
                let size = f64::from(self.width);
                square_to_sphere([f64::from(column) + s, f64::from(row) + t].map(|c| c / size))
            }
        }
    }

    /// The pixel that a unit direction lies in: column, row.
    pub(super) fn pixel(&self, direction: DVec3) -> [u32; 2] {
        let [s, t] = match self.kind {
            Kind::LatitudeLongitude => {
                let DVec3 { x, y, z } = direction;
                let turn = libm::atan2(y, x) / TAU;
                let turn = if turn < 0.0 { turn + 1.0 } else { turn };
                [turn, libm::atan2((x * x + y * y).sqrt(), z) / PI]
            }
            Kind::Octahedral => sphere_to_square(direction),
        };
        // Saturating casts: no direction is outside.
        let index = |at: f64, size: u32| ((at * f64::from(size)) as u32).min(size - 1);
        [index(s, self.width), index(t, self.height)]
    }
}

/// An interval of [−1, 1] cut at zero, as one or two intervals of distances from zero.
fn halves(a: f64, b: f64) -> impl Iterator<Item = [f64; 2]> + Clone {
    let positive = (b > 0.0).then(|| [a.max(0.0), b]);
    let negative = (a < 0.0).then(|| [(-b).max(0.0), -a]);
    positive.into_iter().chain(negative)
}

/// The function whose second derivative is max(0, 1 − s²), the octahedron's z at s = |u| + |v|: its second difference
/// over a rectangle of one quadrant is the integral of z's positive part there.
fn diamond(s: f64) -> f64 {
    if s <= 1.0 {
        let q = s * s;
        0.5 * q - q * q / 12.0
    } else {
        5.0 / 12.0 + (s - 1.0) * (2.0 / 3.0)
    }
}

/// From the unit square to the sphere, keeping areas [Clarberg 2008].
fn square_to_sphere(at: [f64; 2]) -> DVec3 {
    let [u, v] = at.map(|c| 2.0 * c - 1.0);
    let (a, b) = (u.abs(), v.abs());
    let height = 1.0 - (a + b);
    let r = 1.0 - height.abs();
    let angle = if r == 0.0 {
        FRAC_PI_4
    } else {
        ((b - a) / r + 1.0) * FRAC_PI_4
    };
    let (sin, cos) = libm::sincos(angle);
    let across = r * (2.0 - r * r).max(0.0).sqrt();
    DVec3::new(
        (cos * across).copysign(u),
        (sin * across).copysign(v),
        (1.0 - r * r).copysign(height),
    )
}

/// The inverse of [`square_to_sphere`].
fn sphere_to_square(direction: DVec3) -> [f64; 2] {
    let DVec3 { x, y, z } = direction.abs();
    // √(1 − z) without the cancellation at the poles.
    let r = ((x * x + y * y) / (1.0 + z)).min(1.0).sqrt();
    let angle = libm::atan2(y, x) * FRAC_2_PI;
    let (mut u, mut v) = (r - angle * r, angle * r);
    if direction.z < 0.0 {
        (u, v) = (1.0 - v, 1.0 - u);
    }
    [
        0.5 * (u.copysign(direction.x) + 1.0),
        0.5 * (v.copysign(direction.y) + 1.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUTS: [[u32; 2]; 6] = [[2, 1], [12, 6], [14, 7], [1, 1], [6, 6], [7, 7]];

    fn layouts() -> impl Iterator<Item = Layout> {
        LAYOUTS
            .into_iter()
            .map(|[w, h]| Layout::of(w, h).expect("a known shape"))
    }

    fn pixels(layout: Layout) -> impl Iterator<Item = [u32; 2]> {
        (0..layout.height()).flat_map(move |y| (0..layout.width()).map(move |x| [x, y]))
    }

    #[test]
    fn other_shapes_are_unknown() {
        for [w, h] in [[0, 0], [3, 2], [1, 2], [4, 3], [u32::MAX, 2]] {
            assert!(Layout::of(w, h).is_none(), "{w} x {h}");
        }
    }

    #[test]
    fn pixels_fill_the_sphere_and_project_to_a_disk() {
        for layout in layouts() {
            let (mut sphere, mut disk) = (0.0, 0.0);
            for pixel in pixels(layout) {
                sphere += layout.solid_angle(pixel[1]);
                disk += layout.projected_solid_angle(pixel);
            }
            assert!(
                (sphere / (4.0 * PI) - 1.0).abs() < 1e-14,
                "{layout:?} {sphere}"
            );
            assert!((disk / PI - 1.0).abs() < 1e-14, "{layout:?} {disk}");
        }
    }

    #[test]
    fn places_within_a_pixel_have_equal_shares_of_its_solid_angle() {
        // The Jacobian by central differences: |∂ω/∂s × ∂ω/∂t| is the solid angle, wherever in the pixel.
        let h = 1e-6;
        for layout in layouts() {
            for pixel in pixels(layout) {
                for at in [[0.1, 0.2], [0.31, 0.93], [0.77, 0.04], [0.86, 0.55]] {
                    let d = |i: usize| {
                        let (mut a, mut b) = (at, at);
                        a[i] -= h;
                        b[i] += h;
                        (layout.direction(pixel, b) - layout.direction(pixel, a)) / (2.0 * h)
                    };
                    let area = d(0).cross(d(1)).length();
                    let expected = layout.solid_angle(pixel[1]);
                    assert!(
                        (area / expected - 1.0).abs() < 1e-6,
                        "{layout:?} {pixel:?} {at:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_direction_lies_in_the_pixel_it_came_from() {
        for layout in layouts() {
            for pixel in pixels(layout) {
                for at in [[0.001, 0.001], [0.5, 0.5], [0.999, 0.001], [0.4, 0.999]] {
                    let direction = layout.direction(pixel, at);
                    assert!((direction.length() - 1.0).abs() < 1e-14);
                    assert_eq!(layout.pixel(direction), pixel, "{layout:?} {at:?}");
                }
            }
        }
    }

    #[test]
    fn the_projected_solid_angle_is_the_integral() {
        let n = 200;
        for layout in layouts() {
            for pixel in pixels(layout) {
                let mut sum = 0.0;
                for i in 0..n * n {
                    let at = [i % n, i / n].map(|c| (f64::from(c) + 0.5) / f64::from(n));
                    sum += layout.direction(pixel, at).z.max(0.0);
                }
                let expected = sum / f64::from(n * n) * layout.solid_angle(pixel[1]);
                let got = layout.projected_solid_angle(pixel);
                let error = (got - expected).abs() / layout.solid_angle(pixel[1]);
                assert!(error < 1e-4, "{layout:?} {pixel:?} {got} {expected}");
            }
        }
    }

    #[test]
    fn axes_lie_where_the_formats_say() {
        let close = |a: DVec3, b: DVec3| (a - b).length() < 1e-12;
        assert!(close(square_to_sphere([0.5, 0.5]), DVec3::Z));
        assert!(close(square_to_sphere([1.0, 0.5]), DVec3::X));
        assert!(close(square_to_sphere([0.5, 1.0]), DVec3::Y));
        for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
            assert!(close(square_to_sphere(corner), DVec3::NEG_Z));
        }
        let map = Layout::of(8, 4).expect("a map");
        assert_eq!(map.pixel(DVec3::Z)[1], 0);
        assert_eq!(map.pixel(DVec3::NEG_Z)[1], 3);
        assert_eq!(map.pixel(DVec3::new(1.0, 0.1, 0.1).normalize()), [0, 1]);
        assert_eq!(map.pixel(DVec3::new(-0.1, 1.0, -0.1).normalize()), [2, 2]);
        // Every direction has a pixel, even those that are none.
        for odd in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
            for layout in layouts() {
                let [x, y] = layout.pixel(odd);
                assert!(x < layout.width() && y < layout.height());
            }
        }
    }
}
