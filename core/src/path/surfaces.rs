//! Surfaces among media: what paths ask of whoever knows them, one lane at a time.
//!
//! Media are tracked in lanes; surfaces are met one by one. So that few rays have to be compared with them, they come with a few boxes
//! that enclose them all: up to the nearest of those a ray is free ([`clearance`]), and flights go no further before they look.

use core::fmt::Debug;

use crate::ray::{FAR, Ray, clip_to_box};
use crate::real::{Mask, Real, Word};
use crate::vec3::Vec3;

/// A box that encloses surfaces, by its corners \[length\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// The least coordinates.
    pub low: [f32; 3],
    /// The largest coordinates.
    pub high: [f32; 3],
}

/// Where a path arrived on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The place \[length\].
    pub point: [f32; 3],
    /// Bound on the part of light that the surface sends on, by colour, for roulette.
    pub albedo: [f32; 3],
    /// Which of the boxes is flat and lies in the surface's plane: rays that leave the surface meet none of what it encloses.
    pub plane: Option<u32>,
}

/// A direction chosen at a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onward {
    /// Unit direction away from the surface.
    pub direction: [f32; 3],
    /// What the path's throughput is multiplied by, by colour.
    pub weight: [f32; 3],
    /// Density of the direction [1/sr], as it competes with the sampling of lights; `None` where nothing else finds it.
    pub pdf: Option<f32>,
}

/// The surfaces of a scene with matter, and where the path of each lane stands among them.
///
/// A lane *stands* at a place: in space, or on a surface where its path arrived. Its rays begin there, and where that is on a surface
/// they begin on the side that they lead to. Directions are unit vectors but for rounding.
pub trait Surfaces: Clone + Debug {
    /// Whether there are any. Without, nothing below is called, and nothing of it is compiled.
    const ANY: bool;

    /// Boxes that enclose all.
    fn enclosures(&self) -> &[Enclosure];

    /// Looks along a camera ray that waits at a `place` for a lane: the distance of the first surface, [`FAR`] if there is none.
    fn sight(&mut self, place: usize, origin: [f32; 3], direction: [f32; 3]) -> f32;

    /// Gives a lane the path of the camera ray that was looked along at `place`; `None` if it was not.
    fn launch(&mut self, lane: usize, place: Option<usize>, origin: [f32; 3]);

    /// The path of a lane stands in space.
    fn stand(&mut self, lane: usize, point: [f32; 3]);

    /// Looks from where a lane stands: the distance of the first surface, [`FAR`] if there is none.
    fn look(&mut self, lane: usize, direction: [f32; 3]) -> f32;

    /// Whether any surface lies in a direction from where a lane stands.
    fn is_hidden(&self, lane: usize, direction: [f32; 3]) -> bool;

    /// The path of a lane collides at distance `t` of the ray that was looked along last, before the surface found then. Stands there
    /// from now on, on this side of the surface; returns the place.
    fn collide(&mut self, lane: usize, direction: [f32; 3], t: f32) -> [f32; 3];

    /// The path of a lane arrives, in a direction, at the surface that was found last, and stands there from now on.
    fn arrive(&mut self, lane: usize, direction: [f32; 3]) -> Arrival;

    /// The BSDF of the surface where a lane arrived, times |cos θ|, by colour, for light that comes from `towards` [1/sr]; and the density
    /// with which [`sample`](Self::sample) chooses that direction [1/sr].
    fn scatter(&self, lane: usize, towards: [f32; 3]) -> ([f32; 3], f32);

    /// Chooses a direction by numbers in [0, 1), the kind of scattering by the first; `None` where the path ends.
    fn sample(&self, lane: usize, numbers: [f32; 3]) -> Option<Onward>;
}

/// No surfaces.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoSurfaces;

impl Surfaces for NoSurfaces {
    const ANY: bool = false;
    fn enclosures(&self) -> &[Enclosure] {
        &[]
    }
    fn sight(&mut self, _: usize, _: [f32; 3], _: [f32; 3]) -> f32 {
        FAR
    }
    fn launch(&mut self, _: usize, _: Option<usize>, _: [f32; 3]) {}
    fn stand(&mut self, _: usize, _: [f32; 3]) {}
    fn look(&mut self, _: usize, _: [f32; 3]) -> f32 {
        FAR
    }
    fn is_hidden(&self, _: usize, _: [f32; 3]) -> bool {
        false
    }
    fn collide(&mut self, _: usize, _: [f32; 3], _: f32) -> [f32; 3] {
        [0.0; 3]
    }
    fn arrive(&mut self, _: usize, _: [f32; 3]) -> Arrival {
        Arrival {
            point: [0.0; 3],
            albedo: [0.0; 3],
            plane: None,
        }
    }
    fn scatter(&self, _: usize, _: [f32; 3]) -> ([f32; 3], f32) {
        ([0.0; 3], 0.0)
    }
    fn sample(&self, _: usize, _: [f32; 3]) -> Option<Onward> {
        None
    }
}

/// The part of coordinates' magnitudes by which boxes are grown: some sixty roundings of single precision, of which a ray and
/// its clipping have less than sixteen.
const SLACK: f32 = 1.0 / 262_144.0;

/// No box's number.
pub const NO_PLANE: u32 = u32::MAX;

/// A distance up to which a ray meets no surface that the boxes enclose; [`FAR`] if it meets none at all.
///
/// * `plane`: the number of a box that counts for nothing, [`NO_PLANE`] where all count.
#[inline(always)]
pub fn clearance<R: Real>(enclosures: &[Enclosure], ray: &Ray<R>, plane: R::Word) -> R {
    clearance_by(SLACK, enclosures, ray, plane)
}

#[inline(always)]
fn clearance_by<R: Real>(grown: f32, enclosures: &[Enclosure], ray: &Ray<R>, plane: R::Word) -> R {
    let size = ray.origin.map(R::abs).sum();
    let mut near = R::splat(FAR);
    for (number, Enclosure { low, high }) in (0..).zip(enclosures) {
        let reach = low
            .iter()
            .chain(high)
            .fold(0.0_f32, |reach, x| reach + x.abs());
        let slack = (size + R::splat(reach)) * R::splat(grown);
        let slack = Vec3::new(slack, slack, slack);
        let corner = Vec3::splat(*low) - slack;
        let extent = Vec3::splat(*high) + slack - corner;
        let within = clip_to_box(ray.origin - corner, ray.direction, extent);
        let met = within
            .t0
            .le(within.t1)
            .and_not(plane.eq(R::Word::splat(number)));
        near = R::select(met, near.min(within.t0), near);
    }
    near
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::Word32;
    use crate::stream::{Key, PathStream, Stream};

    /// Where a ray enters a box, in double precision.
    fn enters(ray: &Ray<f32>, enclosure: &Enclosure) -> Option<f64> {
        let (origin, direction) = (ray.origin.lane(0), ray.direction.lane(0));
        let (mut t0, mut t1) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let [o, d] = [origin[axis], direction[axis]].map(f64::from);
            let [low, high] = [enclosure.low[axis], enclosure.high[axis]].map(f64::from);
            if d == 0.0 {
                if !(low..=high).contains(&o) {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - o) / d, (high - o) / d);
            (t0, t1) = (t0.max(a.min(b)), t1.min(a.max(b)));
        }
        (t0 <= t1).then_some(t0)
    }

    /// Rays that touch corners, edges and flat boxes: in how many a box is found too late, if boxes are grown by so much.
    fn late(grown: f32) -> u32 {
        let mut rng = PathStream::new(Key::default());
        let mut number = || Stream::<f32>::uniform(&mut rng, true);
        let mut late = 0;
        let mut met = 0;
        for round in 0..40_000_u32 {
            let scale = [1e-3, 1.0, 30.0, 1e4][(round % 4) as usize];
            let mut point = |by: f32| [number(), number(), number()].map(|x| (x - 0.5) * by);
            let (origin, low, size, mut at) = (point(scale), point(2.0), point(2.0), point(2.0));
            let mut size = size.map(|x| x + 1.0);
            size[1] *= f32::from(u8::from(round % 3 > 0));
            let high = [0, 1, 2].map(|i| low[i] + size[i]);
            let enclosure = Enclosure { low, high };
            for i in 0..3 {
                // In its middle, or on a face.
                at[i] = low[i] + size[i] * (at[i] * 0.5 + 0.5).clamp(0.0, 1.0);
                if round >> i & 4 == 4 {
                    at[i] = high[i];
                }
            }
            let origin = Vec3::splat(origin);
            let ray = Ray {
                origin,
                direction: (Vec3::splat(at) - origin).normalised(),
            };
            let near = clearance_by(grown, &[enclosure], &ray, Word32(NO_PLANE));
            if let Some(t) = enters(&ray, &enclosure) {
                met += 1;
                late += u32::from(f64::from(near) > t);
            }
            assert_eq!(clearance(&[enclosure], &ray, Word32(0)), FAR);
        }
        assert!(met > 10_000, "{met}");
        late
    }

    #[test]
    fn no_box_is_found_too_late() {
        assert_eq!(late(SLACK), 0);
        assert!(late(0.0) > 100, "rounding alone would not show");
    }

    #[test]
    fn rays_beside_boxes_are_free() {
        let ball = Enclosure {
            low: [-1.0; 3],
            high: [1.0; 3],
        };
        let along = |origin: [f32; 3]| Ray::<f32> {
            origin: Vec3::splat(origin),
            direction: Vec3::splat([0.0, 0.0, 1.0]),
        };
        let near = |origin| clearance(&[ball], &along(origin), Word32(NO_PLANE));
        assert_eq!(near([1.1, 0.0, -3.0]), FAR);
        assert_eq!(near([0.0, 0.0, 1.1]), FAR);
        assert_eq!(near([0.0; 3]), 0.0);
        let before = near([0.0, 0.0, -3.0]);
        assert!((1.9999..2.0).contains(&before), "{before}");
    }
}
