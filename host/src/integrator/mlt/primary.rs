//! The space of random numbers that a Markov chain walks in [Kelemen 2002].
//!
//! Each vertex of each subpath has a few numbers of its own, so that a longer path does not shift those of another.
//! A *large step* draws all of them anew; a *small step* moves each a little. Numbers are touched when they are asked
//! for: what a number missed meanwhile is made up then.
//!
//! Null collisions, taps and whatever else a segment needs beyond its first free flight come from streams keyed by the last
//! large step and the vertex, and so do numbers beyond a vertex's own. Small steps leave them as they are: given the
//! key the path is a function of the numbers that move, and the chain is exact for the space of both.

use woodcock_core::real::{Mask, Real, Word32};
use woodcock_core::stream::{Key, PathStream, Stream};

use crate::integrator::{Draws, Subpath};

/// Numbers that each vertex has of its own.
const OWN: usize = 8;

/// A number, and what it was before the present proposal.
#[derive(Clone, Copy, Debug, Default)]
struct Primary {
    word: u32,
    /// The step that last touched it.
    step: u64,
    old_word: u32,
    old_step: u64,
}

/// Where a chain is, and where it may go.
#[derive(Debug)]
pub(super) struct Primaries {
    numbers: [Vec<Primary>; 3],
    /// Accepted steps so far, the proposed one included.
    step: u64,
    /// The last large step, and the key that it drew.
    large_step: u64,
    key: u64,
    /// The same of the last accepted state.
    old_large_step: u64,
    old_key: u64,
    large: bool,
    /// What steps are drawn from.
    moves: PathStream,
    cursor: Cursor,
}

/// Whose numbers are asked for.
#[derive(Debug)]
struct Cursor {
    subpath: Subpath,
    /// Index of the first number; none for what is keyed altogether.
    first: Option<usize>,
    asked: usize,
    in_nulls: bool,
    keyed: PathStream,
}

impl Primaries {
    /// A state of its own for each key.
    pub(super) fn new(key: u64, moves: PathStream) -> Self {
        Self {
            numbers: [const { Vec::new() }; 3],
            step: 1,
            large_step: 1,
            key,
            old_large_step: 1,
            old_key: key,
            large: false,
            moves,
            cursor: Cursor {
                subpath: Subpath::Camera,
                first: None,
                asked: 0,
                in_nulls: false,
                keyed: PathStream::new(Key::default()),
            },
        }
    }

    /// What steps are drawn from.
    pub(super) fn moves(&mut self) -> &mut PathStream {
        &mut self.moves
    }

    /// Begins a proposal.
    pub(super) fn propose(&mut self, large: bool) {
        self.step += 1;
        self.large = large;
        self.old_key = self.key;
        self.old_large_step = self.large_step;
        if large {
            let mut word = || u64::from(Stream::<f64>::next_word(&mut self.moves, true).0);
            self.key = word() << 32 | word();
            self.large_step = self.step;
        }
    }

    /// Stays at the proposal.
    pub(super) fn accept(&mut self) {
        self.large = false;
    }

    /// Goes back.
    pub(super) fn reject(&mut self) {
        for number in self.numbers.iter_mut().flatten() {
            if number.step == self.step {
                number.word = number.old_word;
                number.step = number.old_step;
            }
        }
        self.key = self.old_key;
        self.large_step = self.old_large_step;
        self.large = false;
        self.step -= 1;
    }

    /// The number of a place, as the proposal has it.
    fn number(&mut self, index: usize) -> u32 {
        let subpath = self.cursor.subpath as usize;
        let fresh = |key: u64| {
            let place = Key {
                seed: key,
                pixel: subpath as u32,
                sample: index as u32,
            };
            (place.hash() >> 32) as u32
        };
        let numbers = &mut self.numbers[subpath];
        if numbers.len() <= index {
            numbers.resize(index + 1, Primary::default());
        }
        let number = &mut numbers[index];
        if number.step == self.step {
            return number.word;
        }
        // As the last accepted state has it, small steps since its large one still to come.
        if number.step < self.old_large_step {
            number.word = fresh(self.old_key);
            number.step = self.old_large_step;
        }
        number.old_word = number.word;
        number.old_step = number.step;
        if self.large {
            number.word = fresh(self.key);
        } else {
            for _ in number.step..self.step {
                number.word = moved(number.word, &mut self.moves);
            }
        }
        number.step = self.step;
        number.word
    }
}

/// A number moved a little, up or down, by 2⁻¹⁰ to 2⁻⁶ of the whole with the logarithm of the way even [Kelemen 2002];
/// around the corner at the ends.
fn moved(word: u32, moves: &mut PathStream) -> u32 {
    const LEAST: f64 = 4_194_304.0; // 2³² · 2⁻¹⁰
    let draw = Stream::<f64>::next_word(moves, true).0;
    let u = f64::from(draw >> 1) / 2_147_483_648.0;
    let way = LEAST * libm::exp2(4.0 * u);
    if draw & 1 == 0 {
        word.wrapping_add(way as u32)
    } else {
        word.wrapping_sub(way as u32)
    }
}

impl<R: Real<Mask = bool, Word = Word32>> Stream<R> for Primaries {
    fn next_word(&mut self, active: bool) -> Word32 {
        if !active.any() {
            return Word32(0);
        }
        match self.cursor.first {
            Some(first) if !self.cursor.in_nulls && self.cursor.asked < OWN => {
                let index = first + self.cursor.asked;
                self.cursor.asked += 1;
                Word32(self.number(index))
            }
            _ => Stream::<R>::next_word(&mut self.cursor.keyed, true),
        }
    }
}

impl Draws for Primaries {
    fn vertex(&mut self, subpath: Subpath, number: u32) {
        // Joins of two subpaths sample nothing but null collisions; those with a light or the camera do.
        let place = match (subpath, number >> 16, number & 0xffff) {
            (Subpath::Join, 1, t) => Some(2 * t),
            (Subpath::Join, s, 1) => Some(2 * s + 1),
            (Subpath::Join, ..) => None,
            _ => Some(number),
        };
        self.cursor = Cursor {
            subpath,
            first: place.map(|place| place as usize * OWN),
            asked: 0,
            in_nulls: false,
            keyed: PathStream::new(Key {
                seed: self.key,
                pixel: !(subpath as u32),
                sample: number,
            }),
        };
    }
    fn begin_nulls(&mut self) {
        self.cursor.in_nulls = true;
    }
    fn end_nulls(&mut self) {
        self.cursor.in_nulls = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(primaries: &mut Primaries) -> Vec<u32> {
        let mut words = Vec::new();
        for (subpath, vertex) in [(Subpath::Camera, 0), (Subpath::Light, 3), (Subpath::Join, 1 << 16 | 5)] {
            primaries.vertex(subpath, vertex);
            for _ in 0..OWN + 2 {
                words.push(Stream::<f64>::next_word(primaries, true).0);
            }
        }
        words
    }

    fn chain() -> Primaries {
        Primaries::new(77, PathStream::new(Key::default()))
    }

    #[test]
    fn a_rejected_step_leaves_no_trace() {
        let mut primaries = chain();
        let before = state(&mut primaries);
        for i in 0..100 {
            primaries.propose(i % 3 == 0);
            assert_ne!(state(&mut primaries), before);
            primaries.reject();
            // A null step, so to speak.
            primaries.propose(false);
            primaries.reject();
        }
        assert_eq!(state(&mut primaries), before);
    }

    #[test]
    fn small_steps_are_small_and_leave_keyed_numbers() {
        let mut primaries = chain();
        let before = state(&mut primaries);
        primaries.propose(false);
        let after = state(&mut primaries);
        primaries.accept();
        for (i, (a, b)) in before.iter().zip(&after).enumerate() {
            let way = a.wrapping_sub(*b).cast_signed().unsigned_abs();
            if i % (OWN + 2) < OWN {
                assert!((1 << 22..=1 << 26).contains(&way), "{i}: {way}");
            } else {
                assert_eq!(a, b);
            }
        }
        assert_eq!(state(&mut primaries), after, "asking again changes nothing");
    }

    #[test]
    fn what_was_not_asked_for_catches_up() {
        let mut primaries = chain();
        let before = state(&mut primaries);
        for _ in 0..5 {
            primaries.propose(false);
            primaries.accept();
        }
        primaries.propose(false);
        let after = state(&mut primaries);
        assert_ne!(before[0], after[0]);
        primaries.reject();
        primaries.propose(true);
        let large = state(&mut primaries);
        primaries.accept();
        assert_ne!(large[OWN], before[OWN], "keys change with large steps");
    }
}
