//! Light that a medium sends out by itself.
//!
//! ```text
//! source = σ_a · L_e  [W/(m³ sr)],   L_e = scale · factor(p) · (colour, colour(p), or a black body's at T(p))
//! ```
//!
//! Factors, colours and temperatures are interpolated at the place itself, each on its own grid; only σ_a comes from
//! the sample that a look-up picked. The product of an expectation and a number is the expectation of the product, and
//! a black body's colour is no linear function of its temperature, which therefore must be interpolated first.

use glam::DVec3;

use super::blackbody::BlackBodies;
use super::field::Field;

/// Where a medium shines, and how.
#[derive(Clone, Debug)]
pub struct Emission {
    /// Factor on all radiance; the film's is in it.
    pub(super) scale: f64,
    /// A further factor by place.
    pub(super) factor: Option<Field<1>>,
    /// The rest.
    pub(super) radiance: Radiance,
}

/// Radiance before factors.
#[derive(Clone, Debug)]
pub(super) enum Radiance {
    /// The same everywhere.
    Constant([f64; 3]),
    /// By place.
    Field(Field<3>),
    /// Of black bodies.
    Temperature(Box<Temperatures>),
}

/// Temperatures by place.
#[derive(Clone, Debug)]
pub(super) struct Temperatures {
    pub(super) field: Field<1>,
    pub(super) offset: f64,
    pub(super) scale: f64,
    pub(super) colours: BlackBodies,
}

impl Temperatures {
    /// kelvin = (value − offset) · scale.
    pub(super) fn new(field: Field<1>, offset: f64, scale: f64) -> Self {
        let ([low], [high]) = field.range();
        let kelvin = |value: f32| (f64::from(value) - offset) * scale;
        let (a, b) = (kelvin(low), kelvin(high));
        Self {
            field,
            offset,
            scale,
            colours: BlackBodies::new(a.min(b), a.max(b)),
        }
    }

    /// The highest temperature of any place \[K\].
    pub(super) fn hottest(&self) -> f64 {
        let ([low], [high]) = self.field.range();
        self.kelvin(f64::from(low))
            .max(self.kelvin(f64::from(high)))
    }

    fn kelvin(&self, value: f64) -> f64 {
        (value - self.offset) * self.scale
    }
}

impl Emission {
    /// L_e at a place of the rendered world, by colour \[W/(m² sr)\]; not negative.
    pub fn radiance(&self, place: DVec3) -> [f64; 3] {
        let factor = match &self.factor {
            Some(field) => {
                let [factor] = field.value(place);
                self.scale * factor
            }
            None => self.scale,
        };
        if factor == 0.0 {
            return [0.0; 3];
        }
        let colour = match &self.radiance {
            Radiance::Constant(colour) => *colour,
            Radiance::Field(field) => field.value(place),
            Radiance::Temperature(t) => {
                let [value] = t.field.value(place);
                t.colours.colour(t.kelvin(value))
            }
        };
        colour.map(|c| c * factor)
    }

    /// What is positive wherever L_e is, for some place in the box around these places of the world.
    pub(super) fn trace(&self, corners: &[DVec3; 8]) -> [f64; 3] {
        let factor = match &self.factor {
            Some(field) => f64::from(field.largest(*corners)[0]) * self.scale,
            None => self.scale,
        };
        let colour = match &self.radiance {
            Radiance::Constant(colour) => *colour,
            Radiance::Field(field) => field.largest(*corners).map(f64::from),
            Radiance::Temperature(t) => {
                let [value] = t.field.largest(*corners);
                t.colours.colour(t.kelvin(f64::from(value)))
            }
        };
        colour.map(|c| c * factor)
    }
}
