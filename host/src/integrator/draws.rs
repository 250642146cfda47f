//! Random numbers as integrators draw them.

use woodcock_core::real::{Real, Word32};
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

    /// Uniform in [0, 1) on the grid k · 2⁻⁵³: choices among many lights, or rows of a picture near its poles, need more
    /// than 24 bits. Two words.
    fn one(&mut self) -> f64 {
        let mut word = || u64::from(Stream::<f64>::next_word(self, true).0);
        let bits = word() << 21 | word() >> 11;
        bits as f64 * (1.0 / 9_007_199_254_740_992.0)
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

/// A stream whose first number is given.
#[derive(Debug)]
pub(super) struct Given<'a, D> {
    first: Option<u32>,
    rest: &'a mut D,
}

impl<'a, D> Given<'a, D> {
    pub(super) fn new(first: u32, rest: &'a mut D) -> Self {
        Self {
            first: Some(first),
            rest,
        }
    }
}

impl<R, D> Stream<R> for Given<'_, D>
where
    R: Real<Mask = bool, Word = Word32>,
    D: Stream<R>,
{
    fn next_word(&mut self, active: bool) -> Word32 {
        if active && let Some(word) = self.first.take() {
            return Word32(word);
        }
        self.rest.next_word(active)
    }
}

impl<D: Draws> Draws for Given<'_, D> {
    fn vertex(&mut self, subpath: Subpath, number: u32) {
        self.rest.vertex(subpath, number);
    }
    fn begin_nulls(&mut self) {
        self.rest.begin_nulls();
    }
    fn end_nulls(&mut self) {
        self.rest.end_nulls();
    }
}
