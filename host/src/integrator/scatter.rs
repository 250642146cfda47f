//! A place where a path changes direction: on a surface or at a real collision.

use glam::DVec3;

use super::Draws;
use crate::bsdf::{Bsdf, Transport};
use crate::ray::Anchor;
use crate::surface::Hit;
use crate::world::World;

/// What scatters.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scatterer {
    /// A surface. Densities and values are the BSDF's, times |cos θ|.
    Surface(Bsdf),
    /// A particle of a medium, by its phase function. (The albedo is the throughput's affair.)
    Particle {
        /// Index of the medium.
        medium: usize,
    },
}

/// A place with what scatters there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    /// Where.
    pub(crate) anchor: Anchor,
    /// Unit shading normal; zero in media.
    pub(crate) normal: DVec3,
    /// What.
    pub(crate) scatterer: Scatterer,
}

/// A direction in which a path goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Onward {
    /// Unit direction.
    pub(crate) direction: DVec3,
    /// What the throughput is multiplied by.
    pub(crate) weight: DVec3,
    /// Density of the direction [1/sr].
    pub(crate) pdf: f64,
    /// A direction that no other strategy finds.
    pub(crate) specular: bool,
}

impl Site {
    /// Where a ray met a surface with a material.
    pub(crate) fn on_surface(world: &World, hit: &Hit) -> Self {
        Self {
            anchor: hit.anchor,
            normal: hit.shading_normal,
            scatterer: Scatterer::Surface(world.materials.at(hit)),
        }
    }

    /// A real collision.
    pub(crate) fn in_medium(point: DVec3, medium: usize) -> Self {
        Self {
            anchor: Anchor::in_space(point),
            normal: DVec3::ZERO,
            scatterer: Scatterer::Particle { medium },
        }
    }

    /// Whether connections to it bring nothing.
    pub(crate) fn is_specular(&self) -> bool {
        match &self.scatterer {
            Scatterer::Surface(bsdf) => bsdf.is_specular(),
            Scatterer::Particle { .. } => false,
        }
    }

    /// Bound on the part of light that a surface sends on; nothing for particles, whose collision knows.
    pub(crate) fn albedo(&self) -> DVec3 {
        match &self.scatterer {
            Scatterer::Surface(bsdf) => bsdf.albedo().into(),
            Scatterer::Particle { .. } => DVec3::ZERO,
        }
    }

    /// BSDF times |cos θ| of `to`, or phase function, by colour [1/sr]. Both directions lead away from the place; the path
    /// comes from `from`.
    pub(crate) fn eval(
        &self,
        world: &World,
        from: DVec3,
        to: DVec3,
        transport: Transport,
    ) -> DVec3 {
        match &self.scatterer {
            Scatterer::Surface(bsdf) => bsdf.eval(from, to, transport).into(),
            Scatterer::Particle { medium } => DVec3::splat(phase(world, *medium, -from.dot(to))),
        }
    }

    /// Density with which [`sample`](Self::sample) chooses `to` [1/sr].
    pub(crate) fn pdf(&self, world: &World, from: DVec3, to: DVec3, transport: Transport) -> f64 {
        match &self.scatterer {
            Scatterer::Surface(bsdf) => bsdf.pdf(from, to, transport),
            Scatterer::Particle { medium } => phase(world, *medium, -from.dot(to)),
        }
    }

    /// Chooses a direction; `None` where the path ends. Three numbers on surfaces, two in media.
    pub(crate) fn sample(
        &self,
        world: &World,
        from: DVec3,
        transport: Transport,
        draws: &mut impl Draws,
    ) -> Option<Onward> {
        match &self.scatterer {
            Scatterer::Surface(bsdf) => {
                let sample = bsdf.sample(from, draws.three(), transport)?;
                Some(Onward {
                    direction: sample.direction,
                    weight: sample.weight.into(),
                    pdf: sample.pdf,
                    specular: sample.specular,
                })
            }
            Scatterer::Particle { medium } => {
                let [u, turn] = draws.two();
                let law = &world.media.get(*medium)?.phase;
                let cosine = f64::from(law.sample(u as f32)).clamp(-1.0, 1.0);
                Some(Onward {
                    direction: deflected(-from, cosine, turn),
                    weight: DVec3::ONE,
                    pdf: phase(world, *medium, cosine),
                    specular: false,
                })
            }
        }
    }
}

/// The phase function of a medium at a cosine between directions of travel [1/sr].
fn phase(world: &World, medium: usize, cosine: f64) -> f64 {
    world.media.get(medium).map_or(0.0, |medium| {
        f64::from(medium.phase.eval(cosine.clamp(-1.0, 1.0) as f32))
    })
}

/// A unit direction turned by the angle of a cosine, and about itself by a fraction of a turn: the formula that core has
/// for packets.
pub(crate) fn deflected(direction: DVec3, cosine: f64, turn: f64) -> DVec3 {
    use woodcock_core::vec3::Vec3;
    let d = Vec3::<f64>::new(direction.x, direction.y, direction.z);
    let to = d.deflected(cosine, turn);
    DVec3::new(to.x, to.y, to.z)
}
