//! Lights that a volume path can meet or sample.
//!
//! Radiances are linear Rec. 709 colours. Each file has one kind of light; a scene's are gathered in
//! [`Lights`].

pub mod constant;
pub mod distant;

pub use distant::Distant;

use crate::real::{Mask, Real, Word};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// All lights of a scene, as borrowed tables.
#[derive(Clone, Copy, Debug)]
pub struct Lights<'a> {
    /// Lights at infinity in one direction each.
    pub distant: &'a [Distant],
    /// Radiance that arrives from every direction [W/(m² sr)].
    pub environment: [f32; 3],
    /// Whether next-event estimation samples the environment too, combined with phase sampling by the
    /// balance heuristic. Without it an escaping path alone meets the environment, which under a
    /// constant sky costs no shadow ray and is seldom noisier.
    pub sample_environment: bool,
}

/// A direction to look for light in, per lane.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<R> {
    /// Unit direction towards the light.
    pub direction: Vec3<R>,
    /// Radiance over the density of the choice of light and direction; for a light in a single
    /// direction, its irradiance over the probability of the choice.
    pub radiance: Vec3<R>,
    /// Density of `direction` that competes with phase sampling [1/sr]; zero for a single direction,
    /// which no phase function finds.
    pub pdf: R,
}

impl Lights<'_> {
    /// How many lights next-event estimation chooses between, with equal probability.
    #[inline(always)]
    pub fn count(&self) -> u32 {
        self.distant.len() as u32 + u32::from(self.sample_environment)
    }

    /// Samples one light. One draw to choose if there are several, two for a direction of the
    /// environment.
    #[inline(always)]
    pub fn sample<R: Real>(&self, rng: &mut impl Stream<R>, active: R::Mask) -> LightSample<R> {
        let count = self.count();
        let number = R::splat(count as f32);
        let choice = if count > 1 {
            (rng.uniform(active) * number).to_word()
        } else {
            R::Word::splat(0)
        };
        let mut sample = LightSample {
            direction: Vec3::splat([0.0, 0.0, 1.0]),
            radiance: Vec3::uniform(0.0),
            pdf: R::zero(),
        };
        for (index, light) in self.distant.iter().enumerate() {
            let chosen = choice.eq(R::Word::splat(index as u32));
            sample.direction =
                Vec3::select(chosen, Vec3::splat(light.direction()), sample.direction);
            sample.radiance = Vec3::select(
                chosen,
                Vec3::splat(light.radiance()) * number,
                sample.radiance,
            );
        }
        if self.sample_environment {
            let chosen = choice.eq(R::Word::splat(self.distant.len() as u32)) & active;
            if chosen.any() {
                let (u, v) = (rng.uniform(chosen), rng.uniform(chosen));
                let weight = R::splat(1.0 / constant::PDF) * number;
                sample.direction = Vec3::select(chosen, constant::sample(u, v), sample.direction);
                sample.radiance = Vec3::select(
                    chosen,
                    Vec3::splat(self.environment) * weight,
                    sample.radiance,
                );
                sample.pdf = self.environment_pdf::<R>().or_zero(chosen);
            }
        }
        sample
    }

    /// Density with which [`sample`](Self::sample) picks any direction of the environment [1/sr].
    #[inline(always)]
    pub fn environment_pdf<R: Real>(&self) -> R {
        if self.sample_environment {
            R::splat(constant::PDF) / R::splat(self.count() as f32)
        } else {
            R::zero()
        }
    }
}
