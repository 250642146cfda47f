//! Where some lights are, where they face, how strong they are, and what they may matter at a place.

use std::f64::consts::PI;

use glam::DVec3;

/// Least cosine that counts, at the receiver and at the light. Both are guesses: a glossy surface can send on grazing
/// light undiminished, and a cosine near zero is rounding.
const LEAST_COSINE: f64 = 1.0 / 64.0;

/// Angles widen by this at each union, so that rounding never cuts off what shines \[rad\].
const SLACK: f64 = 1e-7;

/// What a group of lights is like from outside.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Extent {
    /// Corners of a box around them.
    pub(in super::super) low: DVec3,
    pub(in super::super) high: DVec3,
    /// Unit; the middle of the cone that holds the axes of all.
    pub(in super::super) axis: DVec3,
    /// Half the opening of that cone \[rad\].
    pub(in super::super) spread: f64,
    /// How far from its own axis each shines \[rad\].
    pub(in super::super) reach: f64,
    /// The sum of their intensities along their axes \[W/sr\], colours averaged; positive.
    pub(in super::super) strength: f64,
    /// Some shine to the back as well.
    pub(in super::super) two_sided: bool,
}

/// [`Extent`] as the walk through a tree reads it: cosines in place of angles, 16 numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    centre: DVec3,
    radius: f64,
    axis: DVec3,
    cos_spread: f64,
    sin_spread: f64,
    cos_reach: f64,
    strength: f64,
    two_sided: bool,
}

impl Extent {
    pub(super) fn centre(&self) -> DVec3 {
        (self.low + self.high) * 0.5
    }

    /// Around both.
    pub(super) fn union(&self, other: &Self) -> Self {
        let (axis, spread) = cone_around((self.axis, self.spread), (other.axis, other.spread));
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            axis,
            spread,
            reach: self.reach.max(other.reach),
            strength: self.strength + other.strength,
            two_sided: self.two_sided || other.two_sided,
        }
    }

    /// What a group costs that a split makes: strength × solid angle it may shine into × area of its box
    /// [Conty Estevez, Kulla 2018]. Its diagonal counts a little beside the area, which a row of points has not.
    pub(super) fn cost(&self) -> f64 {
        let size = self.high - self.low;
        let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
        let outer = (self.spread + self.reach).min(PI);
        let (sin, cos) = libm::sincos(self.spread);
        let cap = 2.0 * PI * (1.0 - cos);
        let around =
            2.0 * outer * sin - libm::cos(self.spread - 2.0 * outer) - 2.0 * self.spread * sin
                + cos;
        let faces = cap + 0.5 * PI * around;
        self.strength * faces * (area + 0.01 * size.length_squared())
    }

    pub(super) fn bound(&self) -> Bound {
        let (sin_spread, cos_spread) = libm::sincos(self.spread);
        Bound {
            centre: self.centre(),
            radius: 0.5 * (self.high - self.low).length(),
            axis: self.axis,
            cos_spread,
            sin_spread,
            cos_reach: libm::cos((self.reach + SLACK).min(PI)),
            strength: self.strength,
            two_sided: self.two_sided,
        }
    }
}

/// A cone around two cones, each a unit axis and half its opening.
fn cone_around(a: (DVec3, f64), b: (DVec3, f64)) -> (DVec3, f64) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    if wide.1 >= PI {
        return wide;
    }
    let cos = wide.0.dot(narrow.0);
    let across = narrow.0 - wide.0 * cos;
    let sin = across.length();
    let between = libm::atan2(sin, cos);
    if between + narrow.1 <= wide.1 {
        return wide;
    }
    if sin <= SLACK && cos > 0.0 {
        // The same axis, but for rounding.
        return (wide.0, (between + narrow.1 + SLACK).min(PI));
    }
    let spread = 0.5 * (between + wide.1 + narrow.1) + SLACK;
    if spread >= PI || sin <= SLACK {
        return (wide.0, PI);
    }
    let (s, c) = libm::sincos(spread - wide.1);
    match (wide.0 * c + across * (s / sin)).try_normalize() {
        Some(axis) => (axis, spread),
        None => (wide.0, PI),
    }
}

/// cos and sin of max(0, a − b), both in [0, π].
fn less((cos_a, sin_a): (f64, f64), (cos_b, sin_b): (f64, f64)) -> (f64, f64) {
    if cos_a >= cos_b {
        (1.0, 0.0)
    } else {
        (cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b)
    }
}

fn with_sine(cos: f64) -> (f64, f64) {
    (cos, (1.0 - cos * cos).max(0.0).sqrt())
}

impl Bound {
    pub(super) fn strength(&self) -> f64 {
        self.strength
    }

    /// What the lights may matter at a place: strength × cosine at the light × cosine at the receiver / distance²,
    /// each as large as the bound allows [Conty Estevez, Kulla 2018]. Zero only where none of them shines.
    ///
    /// * `normal`: unit, or zero in space. Its sign is of no account: light may pass through.
    /// * `nearest`: least squared distance that counts, positive.
    pub(super) fn importance(&self, from: DVec3, normal: DVec3, nearest: f64) -> f64 {
        let to_light = self.centre - from;
        let squared = to_light.length_squared();
        let radius_squared = self.radius * self.radius;
        let base = self.strength / squared.max(radius_squared).max(nearest);
        if squared <= radius_squared || squared == 0.0 {
            return base;
        }
        let direction = to_light / squared.sqrt();
        // The angle that the sphere around the box is seen under.
        let sin_box = (radius_squared / squared).min(1.0).sqrt();
        let seen = ((1.0 - sin_box * sin_box).sqrt(), sin_box);

        let cos = -self.axis.dot(direction);
        let cos = if self.two_sided { cos.abs() } else { cos };
        let off_axis = less(with_sine(cos), (self.cos_spread, self.sin_spread));
        let (cos_light, _) = less(off_axis, seen);
        if cos_light < self.cos_reach {
            return 0.0;
        }
        let mut importance = base * cos_light.max(LEAST_COSINE);
        if normal != DVec3::ZERO {
            let (cos_receiver, _) = less(with_sine(normal.dot(direction).abs()), seen);
            importance *= cos_receiver.max(LEAST_COSINE);
        }
        importance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light::direction::{about, uniform};

    /// Numbers that fill the unit interval evenly, a different sequence for each `base`.
    fn halton(mut index: u32, base: u32) -> f64 {
        let (mut sum, mut digit) = (0.0, 1.0);
        while index > 0 {
            digit /= f64::from(base);
            sum += digit * f64::from(index % base);
            index /= base;
        }
        sum
    }

    #[test]
    fn a_cone_around_two_holds_both() {
        for i in 1..2000 {
            let h = |base| halton(i, base);
            let a = (uniform([h(2), h(3)]), PI * h(5) * h(5));
            // Every third pair nearly coincides, or is opposite.
            let b = match i % 3 {
                0 => uniform([h(7), h(11)]),
                1 => about(a.0, 1.0 - 1e-9, h(7)),
                _ => -a.0,
            };
            let b = (b, PI * h(13) * h(13));
            let (axis, spread) = cone_around(a, b);
            for cone in [a, b] {
                let edge = about(cone.0, libm::cos(cone.1), h(17));
                let angle = libm::atan2(axis.cross(edge).length(), axis.dot(edge));
                assert!(angle <= spread + 1e-9, "{i}: {angle} {spread}");
            }
            assert!(spread <= PI && (axis.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn differences_of_angles_are_those_of_trigonometry() {
        for i in 0..40 {
            for j in 0..40 {
                let (a, b) = (PI * f64::from(i) / 39.0, PI * f64::from(j) / 39.0);
                let of = |angle| (libm::cos(angle), libm::sin(angle));
                let (cos, sin) = less(of(a), of(b));
                let difference = (a - b).max(0.0);
                assert!((cos - libm::cos(difference)).abs() < 1e-14);
                assert!((sin - libm::sin(difference)).abs() < 1e-14);
            }
        }
    }
}
