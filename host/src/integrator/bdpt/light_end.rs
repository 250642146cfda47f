//! The light end of a path: a lamp, a surface, a medium that shines, or the sky.

use glam::DVec3;

use super::subpath::Vertex;
use crate::ray::Anchor;
use crate::world::World;

/// What shines, with the densities that do not depend on the rest of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightEnd {
    pub(super) kind: LightKind,
    /// Where; of light from far away, a place on its way.
    pub(super) anchor: Anchor,
    /// Nothing but sampling finds it.
    pub(super) delta: bool,
    /// It lies infinitely far.
    pub(super) infinite: bool,
    /// What a flight that ends here has as density: the rate of tentative collisions in media, else one.
    pub(super) end: f64,
}

/// Which light.
#[derive(Clone, Copy, Debug)]
pub(super) enum LightKind {
    /// One of [`Lights`](crate::light::Lights).
    Lamp(u32),
    /// A place of a medium: its density per volume, the choice of media over lamps included.
    Glow {
        /// [1/length³].
        pdf: f64,
    },
}

/// 1/(4π).
pub(super) const INV_4PI: f64 = 0.25 * std::f64::consts::FRAC_1_PI;

impl LightEnd {
    /// A lamp.
    pub(super) fn lamp(light: u32, anchor: Option<Anchor>, delta: bool) -> Self {
        Self {
            kind: LightKind::Lamp(light),
            anchor: anchor.unwrap_or_else(|| Anchor::in_space(DVec3::ZERO)),
            delta,
            infinite: anchor.is_none(),
            end: 1.0,
        }
    }

    /// A place of a medium.
    ///
    /// * `pdf`: of the place among places of media that shine [1/length³]. `majorant`: the rate there.
    pub(super) fn glow(world: &World, place: DVec3, pdf: f64, majorant: f64) -> Self {
        Self {
            kind: LightKind::Glow {
                pdf: pdf * world.glow_choice(),
            },
            anchor: Anchor::in_space(place),
            delta: false,
            infinite: false,
            end: majorant,
        }
    }

    /// The vertex of the path, as reached from the other side with this density.
    pub(super) fn vertex(&self, own: f64) -> Vertex {
        Vertex {
            end: self.end,
            ..Vertex::end(self.anchor, own, self.infinite)
        }
    }

    /// Densities with which light sets out in `direction`: of x₀ (place; of light from far away, direction) and of what
    /// leads to x₁ (direction; of light from far away, place per area across).
    pub(super) fn emission(&self, world: &World, direction: DVec3) -> (f64, f64) {
        match self.kind {
            LightKind::Glow { pdf } => (pdf, INV_4PI),
            LightKind::Lamp(light) => {
                let lighting = &world.lighting;
                let choice = lighting.emission_choice(light) * (1.0 - world.glow_choice());
                let (place, towards) =
                    lighting.emission_pdf(&world.surfaces, light, &self.anchor, direction);
                if self.infinite {
                    (choice * towards, place)
                } else {
                    (choice * place, towards)
                }
            }
        }
    }

    /// Density of x₀ where it is sampled from x₁, in the measure of `vertex`, `direction` leading from x₁ to it.
    pub(super) fn next_event(
        &self,
        world: &World,
        vertex: &Vertex,
        from: &Vertex,
        direction: DVec3,
        distance_squared: f64,
    ) -> f64 {
        let light = match self.kind {
            LightKind::Glow { pdf } => return pdf,
            LightKind::Lamp(light) => light,
        };
        let lighting = &world.lighting;
        let place = from.anchor.point;
        let normal = from.site.as_ref().map_or(DVec3::ZERO, |site| site.normal);
        let choice = lighting.choice(light, place, normal) * (1.0 - world.glow_choice());
        if self.delta {
            return choice;
        }
        if self.infinite {
            let (_, towards) =
                lighting.emission_pdf(&world.surfaces, light, &self.anchor, -direction);
            return choice * towards;
        }
        let emitter = light - lighting.first_emitter();
        let pdf = world.surfaces.emitter_pdf(emitter, place, &self.anchor);
        choice * pdf * vertex.across(direction) / distance_squared
    }
}
