//! A phase function from a table: linear in the cosine between its nodes.
//!
//! ```text
//! p(μ) = (v₀ (μ₁ − μ) + v₁ (μ − μ₀)) / (μ₁ − μ₀) / (2π ∫ v dμ)   for μ₀ ≤ μ ≤ μ₁, neighbouring nodes
//! ```
//!
//! The table is borrowed: cosines that rise from −1 to 1, a value at each in any unit, and the
//! distribution function at each, which [`fill_cumulative`] computes and [`Tabulated::new`] proves.
//! Nodes may lie as close as `f32` can tell apart, so a jump is two neighbouring numbers.
//!
//! Sampling finds the segment of u by bisection. Within it, ξ being the part of its share below u, the
//! place is the root of a quadratic, in the form that neither cancels nor divides by v₁ − v₀:
//!
//! ```text
//! x = ξ (v₀ + v₁) / (v₀ + √((1 − ξ) v₀² + ξ v₁²)),   ξ = x ((2 − x) v₀ + x v₁) / (v₀ + v₁)
//! ```
//!
//! The distribution function is exact to one rounding of `f32`, that is u to 6e-8; a segment with less
//! than that may never be drawn. Cost: ⌈log₂ segments⌉ look-ups per lane, and four more.

use core::f64::consts::TAU;
use core::fmt;

use crate::real::{Real, Word};

/// Most nodes of a table.
const MOST: usize = 1 << 24;

/// What can be wrong with a table.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// Fewer than two nodes, or more than 2²⁴.
    Nodes(usize),
    /// A slice has another length than there are cosines.
    Length {
        /// The number of cosines.
        expected: usize,
        /// The length of the slice.
        found: usize,
    },
    /// The cosines do not begin at −1 or do not end at 1.
    Range {
        /// The first cosine.
        first: f32,
        /// The last cosine.
        last: f32,
    },
    /// A cosine does not exceed the one before it, or is NaN.
    Order {
        /// Its index.
        at: usize,
    },
    /// A value is negative, infinite or NaN.
    Value {
        /// Its index.
        at: usize,
        /// The value.
        value: f32,
    },
    /// The integral over the sphere is zero, or so small or large that densities leave the range of `f32`.
    Integral(f64),
    /// The distribution function is not what [`fill_cumulative`] computes.
    Cumulative {
        /// The first index where it differs.
        at: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nodes(count) => write!(f, "a table of {count} nodes: it has 2 to 2^24"),
            Self::Length { expected, found } => {
                write!(f, "a slice of {found} numbers for {expected} cosines")
            }
            Self::Range { first, last } => {
                write!(
                    f,
                    "cosines from {first} to {last}: a table reaches from -1 to 1"
                )
            }
            Self::Order { at } => write!(f, "cosine {at} does not exceed the one before it"),
            Self::Value { at, value } => {
                write!(
                    f,
                    "value {at} is {value}: densities are finite and not negative"
                )
            }
            Self::Integral(integral) => write!(
                f,
                "the values integrate to {integral:e} over the sphere, which nothing can normalise"
            ),
            Self::Cumulative { at } => write!(
                f,
                "entry {at} of the distribution function does not belong to these values"
            ),
        }
    }
}

impl core::error::Error for TableError {}

/// The integral over the sphere, once everything about a table is proved but its distribution function.
fn integrate(cosines: &[f32], values: &[f32]) -> Result<f64, TableError> {
    let nodes = cosines.len();
    let (2..=MOST, Some(&first), Some(&last)) = (nodes, cosines.first(), cosines.last()) else {
        return Err(TableError::Nodes(nodes));
    };
    if values.len() != nodes {
        return Err(TableError::Length {
            expected: nodes,
            found: values.len(),
        });
    }
    if first != -1.0 || last != 1.0 {
        return Err(TableError::Range { first, last });
    }
    let rises = |pair: &[f32]| matches!(pair, [before, after] if before < after);
    if let Some(at) = cosines.windows(2).position(|pair| !rises(pair)) {
        return Err(TableError::Order { at: at + 1 });
    }
    let wrong = |&(_, &value): &(usize, &f32)| !(value >= 0.0 && value.is_finite());
    if let Some((at, &value)) = values.iter().enumerate().find(wrong) {
        return Err(TableError::Value { at, value });
    }
    let integral = TAU * masses(cosines, values).sum::<f64>();
    let normal = |scale: f64| (scale as f32).is_normal();
    let largest = values.iter().copied().fold(0.0, f32::max);
    if !(normal(1.0 / integral) && normal(f64::from(largest) / integral)) {
        return Err(TableError::Integral(integral));
    }
    Ok(integral)
}

/// ∫ v dμ of each segment.
fn masses(cosines: &[f32], values: &[f32]) -> impl Iterator<Item = f64> {
    let sides = |pair: &[f32]| match pair {
        &[a, b] => (f64::from(a), f64::from(b)),
        _ => (0.0, 0.0),
    };
    let heights = values.windows(2).map(sides).map(|(a, b)| 0.5 * (a + b));
    let widths = cosines.windows(2).map(sides).map(|(a, b)| b - a);
    heights.zip(widths).map(|(height, width)| height * width)
}

/// P(cosine < μ) at each node, each rounded once from `f64`.
fn cumulative(cosines: &[f32], values: &[f32], integral: f64) -> impl Iterator<Item = f32> {
    let mut sum = 0.0;
    let inner = masses(cosines, values).map(move |mass| {
        sum += mass;
        ((TAU * sum / integral) as f32).min(1.0)
    });
    // The order of the sum is that of the integral, so the last entry is 1.
    core::iter::once(0.0).chain(inner)
}

/// Computes the distribution function of a table at its nodes.
///
/// * `cosines`: rising from −1 to 1. `values`: one at each, finite and not negative, in any unit.
/// * `out`: one at each, overwritten.
///
/// # Errors
/// Whatever is wrong with the table, and the wrong length of `out`.
pub fn fill_cumulative(cosines: &[f32], values: &[f32], out: &mut [f32]) -> Result<(), TableError> {
    let integral = integrate(cosines, values)?;
    if out.len() != cosines.len() {
        return Err(TableError::Length {
            expected: cosines.len(),
            found: out.len(),
        });
    }
    for (out, value) in out.iter_mut().zip(cumulative(cosines, values, integral)) {
        *out = value;
    }
    Ok(())
}

/// A borrowed table, shared by all lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tabulated<'a> {
    cosines: &'a [f32],
    values: &'a [f32],
    cumulative: &'a [f32],
    /// From values to densities.
    scale: f32,
    mean_cosine: f32,
}

/// The ends of a segment.
struct Segment<R> {
    cosines: [R; 2],
    values: [R; 2],
    cumulative: [R; 2],
}

impl<'a> Tabulated<'a> {
    /// Proves that the distribution function belongs to the values, and keeps all three.
    ///
    /// # Errors
    /// As [`fill_cumulative`], and the first entry of `cumulative` that differs from what it computes.
    pub fn new(
        cosines: &'a [f32],
        values: &'a [f32],
        cumulative: &'a [f32],
    ) -> Result<Self, TableError> {
        let integral = integrate(cosines, values)?;
        if cumulative.len() != cosines.len() {
            return Err(TableError::Length {
                expected: cosines.len(),
                found: cumulative.len(),
            });
        }
        let mut exact = self::cumulative(cosines, values, integral);
        if let Some(at) = cumulative
            .iter()
            .position(|&given| exact.next() != Some(given))
        {
            return Err(TableError::Cumulative { at });
        }
        Ok(Self {
            cosines,
            values,
            cumulative,
            scale: (1.0 / integral) as f32,
            mean_cosine: (TAU * first_moment(cosines, values) / integral) as f32,
        })
    }

    /// The last segment whose entry of `table` is at most `x`; the first where none is.
    #[inline(always)]
    fn segment<R: Real>(&self, table: &[f32], x: R) -> Segment<R> {
        let word = R::Word::splat;
        let mut first = word(0);
        // As many steps for every lane: the number of candidates does not depend on what is found.
        let mut candidates = self.cosines.len().saturating_sub(1) as u32;
        while candidates > 1 {
            let half = candidates / 2;
            let middle = first + word(half);
            let right = R::gather(table, middle).le(x);
            first = R::Word::select(right, middle, first);
            candidates -= half;
        }
        let ends = |table: &[f32]| [first, first + word(1)].map(|i| R::gather(table, i));
        Segment {
            cosines: ends(self.cosines),
            values: ends(self.values),
            cumulative: ends(self.cumulative),
        }
    }

    /// Density of a cosine in [−1, 1] over the sphere [1/sr]; error at most 5e-7, relative, in `f32`.
    #[inline(always)]
    pub fn eval<R: Real>(&self, cos_theta: R) -> R {
        let segment = self.segment(self.cosines, cos_theta);
        let [from, to] = segment.cosines;
        let [low, high] = segment.values.map(|value| value * R::splat(self.scale));
        (low * (to - cos_theta) + high * (cos_theta - from)) / (to - from)
    }

    /// The cosine at u in [0, 1), per lane; error at most 3e-7 + 2e-7/(2πp) in `f32`.
    #[inline(always)]
    pub fn sample<R: Real>(&self, u: R) -> R {
        let (zero, one) = (R::zero(), R::one());
        let segment = self.segment(self.cumulative, u);
        let [below, up_to] = segment.cumulative;
        // Segments without a share have no part of u; where one is asked for nonetheless, its beginning.
        let share = up_to - below;
        let part = R::select(zero.lt(share), (u - below) / share, zero);
        let part = part.max(zero).min(one);
        let [low, high] = relative(segment.values);
        let root = ((one - part) * (low * low) + part * (high * high)).sqrt();
        // Zero over zero where the density begins at zero, and so does the part.
        let x = part * (low + high) / (low + root);
        let x = R::select(zero.lt(root), x, zero).min(one);
        let [from, to] = segment.cosines;
        (from + x * (to - from)).min(to)
    }

    /// P(cosine < μ), the u of a cosine in [−1, 1]; error at most 8e-7 in `f32`.
    #[inline(always)]
    pub fn invert<R: Real>(&self, cos_theta: R) -> R {
        let segment = self.segment(self.cosines, cos_theta);
        let [from, to] = segment.cosines;
        let [below, up_to] = segment.cumulative;
        let [low, high] = relative(segment.values);
        let x = (cos_theta - from) / (to - from);
        let area = low + high;
        let part = x * ((R::splat(2.0) - x) * low + x * high) / area;
        below + (up_to - below) * part.or_zero(R::zero().lt(area))
    }

    /// The mean cosine.
    pub fn mean_cosine(&self) -> f32 {
        self.mean_cosine
    }
}

/// Two values by the larger of them, so that squares neither overflow nor vanish; zeros stay zeros.
#[inline(always)]
fn relative<R: Real>([low, high]: [R; 2]) -> [R; 2] {
    let largest = low.max(high);
    let largest = R::select(R::zero().lt(largest), largest, R::one());
    [low / largest, high / largest]
}

/// ∫ μ v dμ, exact for what is linear in between.
fn first_moment(cosines: &[f32], values: &[f32]) -> f64 {
    let segments = cosines.windows(2).zip(values.windows(2));
    segments
        .map(|(c, v)| match (c, v) {
            (&[a, b], &[low, high]) => {
                let [a, b, low, high] = [a, b, low, high].map(f64::from);
                (b - a) * (low * (2.0 * a + b) + high * (a + 2.0 * b)) / 6.0
            }
            _ => 0.0,
        })
        .sum()
}
