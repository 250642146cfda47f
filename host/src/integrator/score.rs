//! What a path brings, and which part of the picture it belongs to.

use glam::DVec3;
use woodcock_core::path::PathSample;

use super::scatter::Site;
use crate::film::LayerSample;

/// What light meets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Matter {
    /// Nothing: it comes from far away.
    #[default]
    Nothing,
    /// A surface.
    Surface,
    /// A medium.
    Medium,
}

/// What is seen first along a camera ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Seen {
    /// The part of light that it sends on, by colour.
    pub(crate) albedo: DVec3,
    /// Unit shading normal; zero in media and where nothing is seen.
    pub(crate) normal: DVec3,
    /// Distance from the camera; zero where nothing is seen.
    pub(crate) distance: f64,
}

/// What a path brings to its pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sample {
    /// Radiance, by colour.
    pub(crate) radiance: DVec3,
    /// The part of it that a medium sent or scattered towards the camera, as the last thing on its way.
    pub(crate) volume: DVec3,
    /// The part of it that was scattered at most once.
    pub(crate) direct: DVec3,
    /// One if anything but the sky was met.
    pub(crate) alpha: f64,
    /// What was met.
    pub(crate) seen: Seen,
}

impl Sample {
    /// Adds another, times a factor; of what is seen, the nearest counts.
    pub(crate) fn add(&mut self, other: &Self, factor: f64) {
        self.radiance += other.radiance * factor;
        self.volume += other.volume * factor;
        self.direct += other.direct * factor;
        self.alpha += other.alpha * factor;
        let nearer = other.seen.distance > 0.0
            && (self.seen.distance == 0.0 || other.seen.distance < self.seen.distance);
        if nearer {
            self.seen = other.seen;
        }
    }
}

impl From<Sample> for PathSample {
    fn from(sample: Sample) -> Self {
        Self {
            radiance: sample.radiance.as_vec3().to_array(),
            alpha: sample.alpha as f32,
        }
    }
}

impl From<&Sample> for LayerSample {
    fn from(sample: &Sample) -> Self {
        let seen = &sample.seen;
        Self {
            albedo: seen.albedo.as_vec3().to_array(),
            normal: seen.normal.as_vec3().to_array(),
            depth: (seen.distance > 0.0).then_some(seen.distance as f32),
            volume: sample.volume.as_vec3().to_array(),
            direct: sample.direct.as_vec3().to_array(),
        }
    }
}

/// A sample in the making.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Score {
    sample: Sample,
    first: Option<Matter>,
    scatterings: u32,
}

impl Score {
    /// Adds what `matter` sends along the present ray.
    pub(crate) fn add(&mut self, radiance: DVec3, matter: Matter) {
        self.add_scattered(radiance, matter, self.scatterings);
    }

    /// Adds what `matter` sends along a ray after so many scatterings.
    pub(crate) fn add_scattered(&mut self, radiance: DVec3, matter: Matter, scatterings: u32) {
        self.sample.radiance += radiance;
        if self.first.unwrap_or(matter) == Matter::Medium {
            self.sample.volume += radiance;
        }
        if scatterings <= 1 {
            self.sample.direct += radiance;
        }
    }

    /// The path meets something that would scatter it, `distance` along its present ray.
    pub(crate) fn meet(&mut self, matter: Matter, site: &Site, distance: f64, albedo: DVec3) {
        if self.first.is_none() {
            self.first = Some(matter);
            self.sample.alpha = 1.0;
            self.sample.seen = Seen {
                albedo,
                normal: site.normal,
                distance,
            };
        }
    }

    /// What the path met first.
    pub(crate) fn first(&self) -> Matter {
        self.first.unwrap_or_default()
    }

    /// How often the path has been scattered.
    pub(crate) fn scatterings(&self) -> u32 {
        self.scatterings
    }

    /// The path scatters.
    pub(crate) fn scatter(&mut self) {
        self.scatterings += 1;
    }

    /// The sample, made.
    pub(crate) fn sample(&self) -> Sample {
        self.sample
    }
}
