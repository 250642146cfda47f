//! Lights made ready: which light to ask at a place, in which direction it lies, and where its light begins.
//!
//! Radiances are linear Rec. 709, times the film's factor on every pixel.
//!
//! | part | what it knows |
//! |---|---|
//! | [`Lights`] | all lights, by number: what integrators ask |
//! | `choice`, `tree` | which light to ask at a place [Conty Estevez, Kulla 2018] |
//! | `source`, `departure` | one light: as seen from a place, and as it sets out |
//! | `picture`, `layout` | pictures of all directions, and their sampling |
//! | `spot` | the profile of a cone |
//! | `assemble` | from a scene's description, with its errors |

mod assemble;
mod choice;
mod departure;
mod direction;
pub(crate) mod discrete;
mod layout;
mod picture;
mod source;
mod spot;
mod tree;

use glam::DVec3;

use crate::ray::Anchor;
use crate::scene::{Files, Scene, SceneError};
use crate::surface::{Hit, Surfaces};
use crate::volume::Limits;
use assemble::Assembly;
use choice::{Candidate, Chooser};
use discrete::Discrete;
use source::{Source, shines};

/// A sphere around everything that light can meet, for light from far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Its centre.
    pub centre: DVec3,
    /// Its radius \[length\], positive and finite.
    pub radius: f64,
}

/// A light seen from a place.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Index of the light.
    pub light: u32,
    /// Where the light is; `None` is infinitely far.
    pub anchor: Option<Anchor>,
    /// Unit direction to it.
    pub direction: DVec3,
    /// Radiance by colour that arrives if nothing is in between; for points and directions the irradiance on
    /// a surface that faces them.
    pub radiance: [f64; 3],
    /// Density per solid angle of the direction, *without* the choice of the light; one for points and directions [1/sr].
    pub pdf: f64,
    /// Probability of the choice of this light.
    pub choice: f64,
    /// A point or a direction: nothing but this sampling finds it.
    pub delta: bool,
}

/// Light that sets out.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// Index of the light.
    pub light: u32,
    /// Where it begins: on the light; for light from far away on a disk outside of the [`Bounds`].
    pub anchor: Anchor,
    /// Unit direction of travel.
    pub direction: DVec3,
    /// Radiance by colour (intensity for points, irradiance for directions), not divided by any density.
    pub radiance: [f64; 3],
    /// Density of the place: per area; one for points; for light from far away, per area of the disk across.
    pub pdf_position: f64,
    /// Density of the direction per solid angle; one for light in one direction [1/sr].
    pub pdf_direction: f64,
    /// Probability of the choice of this light.
    pub choice: f64,
    /// |cos| between the direction and the light's normal; one for lights without a surface.
    pub cosine: f64,
}

/// All lights of a scene but emissive media.
///
/// Memory: pictures 12.5 bytes per pixel, everything else about half a kilobyte per light.
#[derive(Debug)]
pub struct Lights {
    sources: Vec<Source>,
    first_emitter: u32,
    /// Those that fill directions.
    skies: Vec<u32>,
    chooser: Chooser,
    powers: Discrete,
    /// Those at places, and their powers.
    near: Vec<u32>,
    near_powers: Discrete,
    bounds: Bounds,
}

impl Default for Lights {
    /// No light.
    fn default() -> Self {
        Self {
            sources: Vec::new(),
            first_emitter: 0,
            skies: Vec::new(),
            chooser: Chooser::default(),
            powers: Discrete::default(),
            near: Vec::new(),
            near_powers: Discrete::default(),
            bounds: Bounds {
                centre: DVec3::ZERO,
                radius: 1.0,
            },
        }
    }
}

impl Lights {
    /// Reads pictures, and builds what choices are made by. Lights number: those of the scene first, in file order,
    /// then the emitters of `surfaces`.
    ///
    /// * `bounds`: around everything that light can meet, in the world as rendered.
    /// * `origin`: the place of the world that becomes the origin of rendering.
    ///
    /// # Errors
    /// Files that cannot be read, pictures that are no map of all directions, values out of range, at the light's
    /// place; more lights than memory holds.
    pub fn new(
        scene: &Scene,
        surfaces: &Surfaces,
        bounds: Bounds,
        origin: DVec3,
        files: &dyn Files,
        limits: &Limits,
    ) -> Result<Self, SceneError> {
        let whole = |message: String| SceneError::of_file("the scene", message);
        let reach = bounds.centre.abs() + bounds.radius;
        if !(bounds.radius as f32 > 0.0 && reach.as_vec3().is_finite()) {
            let Bounds { centre, radius } = bounds;
            return Err(whole(format!(
                "the sphere around everything, of radius {radius} about {centre}, is beyond the range of 32-bit numbers"
            )));
        }
        let count = scene.lights.len() as u64 + u64::from(surfaces.emitters());
        let needed = count.saturating_mul(BYTES_PER_LIGHT);
        if needed > limits.max_memory || count > u64::from(u32::MAX) {
            return Err(whole(format!(
                "{count} lights need {needed} bytes, the limit is {}",
                limits.max_memory
            )));
        }
        let assembly = Assembly {
            factor: scene.film.imaging_ratio,
            origin,
            files,
            limits,
        };
        let mut sources = Vec::with_capacity(count as usize);
        for light in &scene.lights {
            sources.push(assembly.source(light)?);
        }
        assembly.check_surfaces(scene)?;
        sources.extend((0..surfaces.emitters()).map(|index| assembly.emitter(surfaces, index)));

        let powers = Discrete::new(sources.iter().map(|source| source.power(&bounds)));
        if !powers.total().is_finite() {
            return Err(whole("the power of all lights is beyond all range".into()));
        }
        let candidates = sources.iter().map(|source| Candidate {
            power: source.power(&bounds),
            extent: source.extent(surfaces),
        });
        let chooser = Chooser::new(candidates, bounds.radius);
        let at_places = (0_u32..).zip(&sources);
        let at_places = at_places.filter(|(_, source)| source.extent(surfaces).is_some());
        let near: Vec<u32> = at_places.map(|(light, _)| light).collect();
        let power = |light: &u32| {
            sources
                .get(*light as usize)
                .map_or(0.0, |s| s.power(&bounds))
        };
        let near_powers = Discrete::new(near.iter().map(power));
        let fills = |source: &Source| matches!(source, Source::Constant { .. } | Source::Image(_));
        let skies = (0_u32..).zip(&sources);
        let skies = skies.filter(|(_, source)| fills(source) && source.power(&bounds) > 0.0);
        Ok(Self {
            first_emitter: scene.lights.len() as u32,
            skies: skies.map(|(light, _)| light).collect(),
            chooser,
            powers,
            near,
            near_powers,
            bounds,
            sources,
        })
    }

    /// Whether no light can be sampled.
    pub fn is_empty(&self) -> bool {
        self.chooser.is_empty()
    }

    /// Index of the first emitter's light.
    pub fn first_emitter(&self) -> u32 {
        self.first_emitter
    }

    /// Chooses a light by `u[0]` and a direction to it by the rest. The choice depends on the place (and, on
    /// surfaces, the shading normal; zero in space).
    ///
    /// `None` if there is no light, or the one chosen is dark from here. With a single light `u[0]` is not used; for
    /// lights in one direction or at a point `u[1]` and `u[2]` are not.
    ///
    /// * `u`: uniform in [0, 1), of 53 bits: each choice among many things, lights or pixels, takes its bits from one
    ///   number. On a grid of 2⁻²⁴ a thing of probability 2⁻²² would be chosen up to a quarter too often or too seldom.
    pub fn sample(
        &self,
        surfaces: &Surfaces,
        from: DVec3,
        normal: DVec3,
        u: [f64; 3],
    ) -> Option<LightSample> {
        let (light, choice) = self.chooser.choose(from, normal, u[0])?;
        let source = self.sources.get(light as usize)?;
        let arrival = source.arrive(surfaces, from, [u[1], u[2]])?;
        Some(LightSample {
            light,
            choice,
            ..arrival
        })
    }

    /// Probability with which [`sample`](Self::sample) chooses a light at a place: the same bits.
    pub fn choice(&self, light: u32, from: DVec3, normal: DVec3) -> f64 {
        self.chooser.probability(light, from, normal)
    }

    /// Density, choice included, with which [`sample`](Self::sample) at `from` finds an emitter where it was hit [1/sr].
    pub fn hit_pdf(&self, surfaces: &Surfaces, from: DVec3, normal: DVec3, hit: &Hit) -> f64 {
        let Some(emitter) = hit.emitter else {
            return 0.0;
        };
        let choice = self.choice(self.first_emitter.saturating_add(emitter), from, normal);
        if choice > 0.0 {
            choice * surfaces.emitter_pdf(emitter, from, &hit.anchor)
        } else {
            0.0
        }
    }

    /// Radiance that a ray in a unit direction meets where it hit a surface: zero if none shines there, and on the dark
    /// side of those that have one.
    pub fn hit_radiance(&self, hit: &Hit, direction: DVec3) -> [f64; 3] {
        let light = hit
            .emitter
            .map(|emitter| self.first_emitter.saturating_add(emitter));
        match light.and_then(|light| self.sources.get(light as usize)) {
            Some(Source::Emitter {
                radiance,
                two_sided,
                ..
            }) if shines(hit.anchor.normal, -direction, *two_sided) => *radiance,
            _ => [0.0; 3],
        }
    }

    /// Radiance that arrives from far away in a direction: of all lights that fill it (not those in one direction only).
    pub fn escape_radiance(&self, direction: DVec3) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (_, radiance, _) in self.escapes(direction) {
            for (sum, c) in sum.iter_mut().zip(radiance) {
                *sum += c;
            }
        }
        sum
    }

    /// For every light that contributes to [`escape_radiance`](Self::escape_radiance): its index, radiance and
    /// density without the choice [1/sr].
    pub fn escapes(
        &self,
        direction: DVec3,
    ) -> impl Iterator<Item = (u32, [f64; 3], f64)> + use<'_> {
        self.skies.iter().filter_map(move |&light| {
            let (radiance, pdf) = match self.sources.get(light as usize)? {
                Source::Constant { radiance } => (*radiance, direction::UNIFORM),
                Source::Image(painted) => {
                    let (_, radiance, pdf) = painted.look(direction);
                    (radiance, pdf)
                }
                _ => return None,
            };
            Some((light, radiance, pdf))
        })
    }

    /// Chooses a light that is at a place by its power, whatever asks.
    pub fn choose_near(&self, u: f64) -> Option<u32> {
        let (index, _) = self.near_powers.choose(u)?;
        self.near.get(index).copied()
    }

    /// Probability with which [`choose_near`](Self::choose_near) chooses a light.
    pub fn near_choice(&self, light: u32) -> f64 {
        // They are in order.
        let index = self.near.binary_search(&light);
        index.map_or(0.0, |index| self.near_powers.probability(index))
    }

    /// The middle of a light that is at a place.
    pub fn centre(&self, light: u32) -> Option<DVec3> {
        self.sources.get(light as usize)?.centre()
    }

    /// Samples a given light as [`sample`](Self::sample) does; its `choice` is one.
    pub fn sample_lamp(
        &self,
        light: u32,
        surfaces: &Surfaces,
        from: DVec3,
        u: [f64; 2],
    ) -> Option<LightSample> {
        let arrival = self
            .sources
            .get(light as usize)?
            .arrive(surfaces, from, u)?;
        Some(LightSample { light, ..arrival })
    }

    /// Whether a light is a point or lies in one direction: nothing but sampling finds it.
    pub fn is_delta(&self, light: u32) -> bool {
        matches!(
            self.sources.get(light as usize),
            Some(
                Source::Distant { .. }
                    | Source::Point { .. }
                    | Source::Spot { .. }
                    | Source::Goniometric { .. }
            )
        )
    }

    /// Whether a light is infinitely far.
    pub fn is_infinite(&self, light: u32) -> bool {
        matches!(
            self.sources.get(light as usize),
            Some(Source::Distant { .. } | Source::Constant { .. } | Source::Image(_))
        )
    }

    /// Chooses a light by its power, a place and a direction for light to set out: for paths from lights.
    ///
    /// The first number chooses, the next two are for the place, the others for the direction. Radiance times cosine
    /// over all densities is bounded: surfaces send in proportion to the cosine, cones and pictures to their profile. Numbers
    /// are of 53 bits, as those of [`sample`](Self::sample).
    pub fn emit(&self, surfaces: &Surfaces, u: [f64; 5]) -> Option<Departure> {
        let (light, _) = self.powers.choose(u[0])?;
        let source = self.sources.get(light)?;
        let departure = source.depart(surfaces, &self.bounds, [u[1], u[2], u[3], u[4]])?;
        Some(Departure {
            light: light as u32,
            choice: self.powers.probability(light),
            ..departure
        })
    }

    /// Probability with which [`emit`](Self::emit) chooses a light.
    pub fn emission_choice(&self, light: u32) -> f64 {
        self.powers.probability(light as usize)
    }

    /// Densities of the place and of the direction with which [`emit`](Self::emit) sends light of this light from
    /// `anchor` (anywhere for light from far away) in a direction of travel; without the choice.
    pub fn emission_pdf(
        &self,
        surfaces: &Surfaces,
        light: u32,
        anchor: &Anchor,
        direction: DVec3,
    ) -> (f64, f64) {
        let source = self.sources.get(light as usize);
        source.map_or((0.0, 0.0), |source| {
            source.departure_pdf(surfaces, &self.bounds, anchor, direction)
        })
    }
}

/// Bytes that a light and its part in all choices may take, while they are built.
const BYTES_PER_LIGHT: u64 = size_of::<Source>() as u64 + tree::BYTES_PER_LIGHT;
