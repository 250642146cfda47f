//! One statistical body for every width: a scalar, its double-precision oracle and eight lanes.
//!
//! A core function is generic over [`Real`], so a test of it should be as well; [`each_width`](crate::each_width) stamps a body out
//! three times. Paths are keyed by their number, so all widths of `f32` draw the same paths.

use crate::stats::Sample;
use woodcock_core::ray::Ray;
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream};
use woodcock_core::vec3::Vec3;

/// Runs a block for `f32`, `f64` and eight lanes, naming the number and its stream as asked.
///
/// ```
/// use woodcock_core::real::Real;
/// use woodcock_tests::each_width;
///
/// let mut lanes = 0;
/// each_width!(R, S => { let _: Option<S> = None; lanes += R::LANES; });
/// assert_eq!(lanes, 1 + 1 + 8);
/// ```
#[macro_export]
macro_rules! each_width {
    ($number:ident, $stream:ident => $body:block) => {
        $crate::each_width!(@one f32, woodcock_core::stream::PathStream, $number, $stream, $body);
        $crate::each_width!(@one f64, woodcock_core::stream::PathStream, $number, $stream, $body);
        $crate::each_width!(@one woodcock_packet::lanes::Lanes, woodcock_packet::bits::LaneStream, $number, $stream, $body);
    };
    (@one $real:ty, $source:ty, $number:ident, $stream:ident, $body:block) => {{
        type $number = $real;
        type $stream = $source;
        $body
    }};
}

/// `f32`, `f64` or `x8`, for messages.
pub fn width<R: Real>() -> &'static str {
    match (R::LANES, size_of::<R>()) {
        (1, 4) => "f32",
        (1, _) => "f64",
        _ => "x8",
    }
}

/// Runs `draw` once for each of `n` paths, each with its own stream from the beginning; results in their order.
pub fn collect<R: Real, S: KeyedStream<R>>(
    seed: u64,
    pixel: u32,
    n: usize,
    mut draw: impl FnMut(&mut S) -> R,
) -> Vec<f64> {
    let mut results = Vec::with_capacity(n + R::LANES);
    let mut rng = S::idle();
    while results.len() < n {
        for lane in 0..R::LANES {
            let sample = (results.len() + lane) as u32;
            rng.set_key(
                lane,
                Key {
                    seed,
                    pixel,
                    sample,
                },
            );
        }
        let drawn = draw(&mut rng);
        results.extend((0..R::LANES).map(|lane| f64::from(drawn.lane(lane))));
    }
    results.truncate(n);
    results
}

/// The same as a [`Sample`].
pub fn sample<R: Real, S: KeyedStream<R>>(
    seed: u64,
    pixel: u32,
    n: usize,
    draw: impl FnMut(&mut S) -> R,
) -> Sample {
    collect(seed, pixel, n, draw).into_iter().collect()
}

/// A mask of all lanes.
pub fn everyone<R: Real>() -> R::Mask {
    R::Mask::splat(true)
}

/// A mask of no lane.
pub fn no_one<R: Real>() -> R::Mask {
    R::Mask::splat(false)
}

/// A function of position in `f64` as the function of lanes that core asks for.
pub fn per_lane<R: Real>(f: impl Fn(f64, f64, f64) -> f64) -> impl Fn(Vec3<R>) -> R {
    move |place| {
        let mut value = R::zero();
        for lane in 0..R::LANES {
            let [x, y, z] = place.lane(lane).map(f64::from);
            value.set_lane(lane, f(x, y, z) as f32);
        }
        value
    }
}

/// The same ray in every lane, rounded from `f64`.
pub fn ray<R: Real>(origin: [f64; 3], direction: [f64; 3]) -> Ray<R> {
    Ray {
        origin: Vec3::splat(origin.map(|v| v as f32)),
        direction: Vec3::splat(direction.map(|v| v as f32)),
    }
}
