//! Random numbers as integrators draw them.

use woodcock_core::stream::{PathStream, Stream};

/// A stream of one path, with marks at which a Markov chain treats numbers differently.
///
/// Marks mean nothing for independent paths.
pub(crate) trait Draws: Stream<f32> + Stream<f64> {
    /// What follows decides about this vertex of this subpath.
    fn vertex(&mut self, _subpath: Subpath, _number: u32) {}
    /// What follows are the null collisions of a segment.
    fn begin_nulls(&mut self) {}
    /// The null collisions of a segment are over.
    fn end_nulls(&mut self) {}

    /// Uniform in [0, 1).
    fn one(&mut self) -> f64 {
        Stream::<f64>::uniform(self, true)
    }
    /// Two of them.
    fn two(&mut self) -> [f64; 2] {
        [self.one(), self.one()]
    }
    /// Three of them.
    fn three(&mut self) -> [f64; 3] {
        [self.one(), self.one(), self.one()]
    }
}

/// Whose numbers are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Subpath {
    /// The path from the camera.
    Camera,
    /// The path from a light.
    Light,
    /// What joins the two.
    Join,
}

impl Draws for PathStream {}
