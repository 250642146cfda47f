//! What all integrators do along rays: find surfaces and media, fly, and look for light.

use glam::DVec3;
use woodcock_core::path::Counts;
use woodcock_core::spectral::{self, Spectrum, history_aware};

use super::Draws;
use super::transmit::{Passage, Transmission, mean, transmit};
use super::walk::{Next, Stretch, Tentative, walk};
use crate::ray::{Anchor, Ray};
use crate::surface::Hit;
use crate::world::{Local, World};

/// The tools of one thread.
#[derive(Debug)]
pub(crate) struct Tracer<'a> {
    pub(crate) world: &'a World,
    pub(crate) counts: Counts,
    /// Stretches of the present flight.
    pub(super) stretches: Vec<Stretch>,
    /// Stretches of shadow rays.
    shadow: Vec<Stretch>,
    /// Where the last of them ended.
    shadow_end: f64,
    open: Vec<Stretch>,
}

/// How a flight ends.
#[derive(Clone, Copy, Debug)]
pub(crate) enum End {
    /// At a real collision.
    Collision {
        /// Distance along the ray.
        t: f64,
        /// Which medium.
        medium: usize,
        /// What it is there.
        local: Local,
    },
    /// On a surface that has a material.
    Surface(Hit),
    /// Nowhere: nothing is in the way.
    Escape,
}

/// A flight, ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flight {
    pub(crate) end: End,
    /// Its passage up to the end ([`Passage`]), if the witness wanted it.
    pub(crate) passage: f64,
}

/// Who looks on while a flight passes things that do not end it.
pub(crate) trait Witness {
    /// Whether anyone asks for the passage of the whole flight.
    fn wants_passage(&self) -> bool {
        true
    }
    /// A tentative collision, before it is decided. `passage`: that of the flight up to there, lazily.
    fn tentative(
        &mut self,
        _world: &World,
        _tentative: &Tentative,
        _throughput: DVec3,
        _passage: &dyn Fn() -> f64,
    ) {
    }
    /// A surface that shines and lets light pass.
    fn shining(
        &mut self,
        _world: &World,
        _hit: &Hit,
        _throughput: DVec3,
        _passage: &dyn Fn() -> f64,
    ) {
    }
}

/// Nobody.
#[derive(Debug)]
pub(crate) struct Unseen;
impl Witness for Unseen {}

impl<'a> Tracer<'a> {
    pub(crate) fn new(world: &'a World) -> Self {
        Self {
            world,
            counts: Counts::default(),
            stretches: Vec::new(),
            shadow: Vec::new(),
            shadow_end: 0.0,
            open: Vec::new(),
        }
    }

    /// Flies along a ray to the first real collision or surface with a material.
    ///
    /// * `throughput`: of the path, by colour; changed where extinction is coloured, since one flight then serves all
    ///   colours ([`history_aware`]).
    pub(crate) fn fly<D: Draws>(
        &mut self,
        ray: &Ray,
        throughput: &mut DVec3,
        draws: &mut D,
        witness: &mut impl Witness,
    ) -> Flight {
        let world = self.world;
        let (shining, solid) = ahead(world, ray);
        let t_max = solid.map_or(f64::INFINITY, |hit| hit.t);
        let mut stretches = std::mem::take(&mut self.stretches);
        world.stretches(ray, t_max, &mut stretches);
        let mut passage = Passage::new();
        let mut end = None;
        let mut lit = 0;
        let counts = &mut self.counts;
        let through = stretches.is_empty()
            || walk(world, ray, &stretches, draws, counts, |draws, tentative| {
                while let Some(hit) = shining.get(lit).filter(|hit| hit.t < tentative.t) {
                    witness.shining(world, hit, *throughput, &|| {
                        passage.up_to(world, &stretches, hit.t)
                    });
                    lit += 1;
                }
                witness.tentative(world, tentative, *throughput, &|| {
                    passage.up_to(world, &stretches, tentative.t)
                });
                if is_real(tentative, throughput, draws) {
                    end = Some(End::Collision {
                        t: tentative.t,
                        medium: tentative.medium,
                        local: tentative.local,
                    });
                    return Next::Stop;
                }
                passage.pass(world, tentative);
                Next::On
            });
        let met = u64::from(!through);
        self.counts.real_collisions += met;
        for hit in shining
            .get(lit..)
            .unwrap_or_default()
            .iter()
            .filter(|_| through)
        {
            witness.shining(world, hit, *throughput, &|| {
                passage.up_to(world, &stretches, hit.t)
            });
        }
        let end = end.unwrap_or_else(|| solid.map_or(End::Escape, End::Surface));
        let length = match &end {
            End::Collision { t, .. } => *t,
            End::Surface(hit) => hit.t,
            End::Escape => f64::INFINITY,
        };
        let passage = if witness.wants_passage() {
            passage.up_to(world, &stretches, length)
        } else {
            f64::NAN
        };
        self.stretches = stretches;
        Flight { end, passage }
    }

    /// How much light passes along the part [0, `t_max`) of a ray, if no surface with a material is in the way; then `None`.
    pub(crate) fn transmit(
        &mut self,
        ray: &Ray,
        t_max: f64,
        draws: &mut impl Draws,
    ) -> Option<Transmission> {
        if self.world.surfaces.occluded(ray, t_max) {
            return None;
        }
        Some(self.transmit_open(ray, t_max, draws))
    }

    /// The same where it is known that no surface is in the way.
    pub(crate) fn transmit_open(
        &mut self,
        ray: &Ray,
        t_max: f64,
        draws: &mut impl Draws,
    ) -> Transmission {
        let world = self.world;
        world.stretches(ray, t_max, &mut self.shadow);
        self.shadow_end = t_max;
        transmit(
            world,
            ray,
            &self.shadow,
            &mut self.open,
            draws,
            &mut self.counts,
        )
    }

    /// Whether the ray that [`transmit`](Self::transmit) last followed ended within a medium.
    pub(crate) fn reached(&self, medium: usize) -> bool {
        let end = self.shadow_end;
        let at_end = |stretch: &&Stretch| stretch.1 >= end;
        self.shadow.iter().filter(at_end).any(|s| s.2 == medium)
    }

    /// The stretches of a ray within media, up to `t_max`.
    pub(crate) fn stretches(&mut self, ray: &Ray, t_max: f64) -> Vec<Stretch> {
        let mut stretches = Vec::new();
        self.world.stretches(ray, t_max, &mut stretches);
        stretches
    }

    /// How much light passes between two places: `None` if nothing.
    pub(crate) fn between(
        &mut self,
        a: &Anchor,
        b: &Anchor,
        draws: &mut impl Draws,
    ) -> Option<Transmission> {
        let (ray, length) = a.ray_to(b)?;
        self.transmit(&ray, length, draws)
    }
}

/// The surfaces without a material that shine on a ray's way, and the first that has one.
pub(crate) fn ahead(world: &World, ray: &Ray) -> (Vec<Hit>, Option<Hit>) {
    let mut shining = Vec::new();
    let mut from = *ray;
    let mut behind = 0.0;
    while let Some(mut hit) = world.surfaces.intersect(&from, f64::INFINITY) {
        hit.t += behind;
        if hit.material.is_some() {
            return (shining, Some(hit));
        }
        behind = hit.t;
        from.origin = hit.anchor.leave(ray.direction);
        shining.push(hit);
    }
    (shining, None)
}

/// Decides a tentative collision. With coloured extinction the throughput shares the decision and is changed by it.
fn is_real<D: Draws>(tentative: &Tentative, throughput: &mut DVec3, draws: &mut D) -> bool {
    let [r, g, b] = tentative.local.sigma_t;
    if r == g && g == b {
        // Compares ξ σ̄ < σ: never where σ = 0, always where it is the bound.
        return woodcock_core::stream::Stream::<f64>::uniform_fine(draws, true)
            * tentative.majorant
            < r;
    }
    let largest = r.max(g).max(b);
    let event = spectral::Tentative {
        sigma_t: largest,
        majorant: tentative.majorant,
        colour: Spectrum([r, g, b].map(|s| s / largest)),
    };
    let weight = Spectrum(throughput.to_array());
    let (real, weight) = history_aware::decide(&event, weight, draws, true);
    *throughput = DVec3::from(weight.0);
    real
}

/// What an analog flight's density has at its end over a connection's: the extinction in a medium, one on a surface.
pub(crate) fn end_density(end: &End) -> f64 {
    match end {
        End::Collision { local, .. } => mean(local.sigma_t),
        End::Surface(_) | End::Escape => 1.0,
    }
}
