//! Surfaces as the paths of packets meet them: one by one, in double precision.
//!
//! Packets track media in single precision. Where a path stands on a surface, or close before one, its place is kept here with the
//! digits and the error bound that its rays need, so that none of them begins on the wrong side.

use glam::DVec3;
use woodcock_core::path::{Arrival, Enclosure, Onward, Surfaces};
use woodcock_core::ray::FAR;
use woodcock_packet::both::WIDTH;
use woodcock_packet::lanes::LANES;

use crate::bsdf::{Bsdf, Transport};
use crate::ray::{Anchor, Ray};
use crate::surface::Hit;
use crate::world::{Plane, World};

/// The path of a lane.
#[derive(Clone, Copy, Debug)]
struct Standing {
    anchor: Anchor,
    /// The surface that its present flight meets first.
    ahead: Option<Hit>,
    /// Unit direction to where it came from, and how the surface there scatters.
    from: DVec3,
    bsdf: Option<Bsdf>,
}

impl Standing {
    fn at(point: DVec3) -> Self {
        Self {
            anchor: Anchor::in_space(point),
            ahead: None,
            from: DVec3::ZERO,
            bsdf: None,
        }
    }
}

/// The surfaces of a world, and where the lanes of one packet stand.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceQueue<'w> {
    world: &'w World,
    lanes: [Standing; WIDTH],
    /// What camera rays that wait for lanes meet first.
    sights: [Option<Hit>; LANES],
}

impl<'w> SurfaceQueue<'w> {
    pub(crate) fn new(world: &'w World) -> Self {
        Self {
            world,
            lanes: [Standing::at(DVec3::ZERO); WIDTH],
            sights: [None; LANES],
        }
    }

    fn nearest(&self, ray: &Ray) -> Option<Hit> {
        self.world.surfaces.intersect(ray, f64::from(FAR))
    }
}

fn place(point: [f32; 3]) -> DVec3 {
    DVec3::from_array(point.map(f64::from))
}

/// A unit direction of single precision, to the last digit of double precision.
fn unit(direction: [f32; 3]) -> DVec3 {
    let direction = place(direction);
    direction / direction.length()
}

fn distance(hit: Option<&Hit>) -> f32 {
    hit.map_or(FAR, |hit| (hit.t as f32).min(FAR))
}

impl Surfaces for SurfaceQueue<'_> {
    const ANY: bool = true;

    fn enclosures(&self) -> &[Enclosure] {
        &self.world.enclosures
    }

    fn sight(&mut self, at: usize, origin: [f32; 3], direction: [f32; 3]) -> f32 {
        let hit = self.nearest(&Ray {
            origin: place(origin),
            direction: unit(direction),
        });
        if let Some(sight) = self.sights.get_mut(at) {
            *sight = hit;
        }
        distance(hit.as_ref())
    }

    fn launch(&mut self, lane: usize, at: Option<usize>, origin: [f32; 3]) {
        let ahead = at.and_then(|at| self.sights.get(at).copied().flatten());
        if let Some(standing) = self.lanes.get_mut(lane) {
            *standing = Standing {
                ahead,
                ..Standing::at(place(origin))
            };
        }
    }

    fn stand(&mut self, lane: usize, point: [f32; 3]) {
        if let Some(standing) = self.lanes.get_mut(lane) {
            *standing = Standing::at(place(point));
        }
    }

    fn look(&mut self, lane: usize, direction: [f32; 3]) -> f32 {
        let Some(standing) = self.lanes.get(lane) else {
            return FAR;
        };
        let hit = self.nearest(&standing.anchor.ray(unit(direction)));
        if let Some(standing) = self.lanes.get_mut(lane) {
            standing.ahead = hit;
        }
        distance(hit.as_ref())
    }

    fn is_hidden(&self, lane: usize, direction: [f32; 3]) -> bool {
        self.lanes.get(lane).is_some_and(|standing| {
            let ray = standing.anchor.ray(unit(direction));
            self.world.surfaces.occluded(&ray, f64::from(FAR))
        })
    }

    fn collide(&mut self, lane: usize, direction: [f32; 3], t: f32) -> [f32; 3] {
        let Some(standing) = self.lanes.get_mut(lane) else {
            return [0.0; 3];
        };
        let direction = unit(direction);
        let t = f64::from(t);
        let point = match &standing.ahead {
            Some(hit) if hit.t <= t => hit.anchor.leave(-direction),
            _ => standing.anchor.ray(direction).at(t),
        };
        *standing = Standing::at(point);
        point.as_vec3().to_array()
    }

    fn arrive(&mut self, lane: usize, direction: [f32; 3]) -> Arrival {
        let nowhere = Arrival {
            point: [0.0; 3],
            albedo: [0.0; 3],
            plane: None,
        };
        let Some(hit) = self.lanes.get(lane).and_then(|standing| standing.ahead) else {
            return nowhere;
        };
        let bsdf = self.world.materials.at(&hit);
        if let Some(standing) = self.lanes.get_mut(lane) {
            *standing = Standing {
                anchor: hit.anchor,
                ahead: None,
                from: -unit(direction),
                bsdf: Some(bsdf),
            };
        }
        Arrival {
            point: hit.anchor.point.as_vec3().to_array(),
            albedo: bsdf.albedo().map(|albedo| albedo as f32),
            plane: self.plane(&hit),
        }
    }

    fn scatter(&self, lane: usize, towards: [f32; 3]) -> ([f32; 3], f32) {
        let Some((standing, bsdf)) = self.scatterer(lane) else {
            return ([0.0; 3], 0.0);
        };
        if bsdf.is_specular() {
            return ([0.0; 3], 0.0);
        }
        let (from, to) = (standing.from, unit(towards));
        let value = bsdf.eval(from, to, Transport::Radiance);
        let pdf = bsdf.pdf(from, to, Transport::Radiance);
        (value.map(|value| value as f32), pdf as f32)
    }

    fn sample(&self, lane: usize, numbers: [f32; 3]) -> Option<Onward> {
        let (standing, bsdf) = self.scatterer(lane)?;
        let sample = bsdf.sample(standing.from, numbers.map(f64::from), Transport::Radiance)?;
        Some(Onward {
            direction: sample.direction.as_vec3().to_array(),
            weight: sample.weight.map(|weight| weight as f32),
            pdf: (!sample.specular).then_some(sample.pdf as f32),
        })
    }
}

impl SurfaceQueue<'_> {
    /// The flat box that a surface lies in, if it does.
    ///
    /// Flat boxes have the same number twice in an axis, of single precision as of double, and so have the corners of all triangles
    /// within, so that none of them leaves the plane by rounding.
    fn plane(&self, hit: &Hit) -> Option<u32> {
        let holds = |planes: &&Plane| hit.anchor.point[planes.axis] == planes.level;
        self.world
            .planes
            .iter()
            .find(holds)
            .map(|plane| plane.number)
    }

    /// What scatters where a lane arrived.
    fn scatterer(&self, lane: usize) -> Option<(&Standing, &Bsdf)> {
        let standing = self.lanes.get(lane)?;
        Some((standing, standing.bsdf.as_ref()?))
    }
}
