//! The light of a medium as packet kernels read it: tables in single precision, with a rim of what lies beyond.

use woodcock_core::path::{self, RecordKind};

use super::Medium;
use super::blackbody::DARK;
use super::emission::Radiance;
use super::field::Field;
use super::rows;
use glam::{DAffine3, DVec3};

/// Samples of a field and a rim of one sample around them, beyond which it is constant.
#[derive(Clone, Debug)]
struct Rimmed {
    values: Vec<f32>,
    dims: [u32; 3],
    world_to_grid: DAffine3,
}

impl Rimmed {
    /// `None` where it has more samples than kernels can index.
    fn new<const N: usize>(field: &Field<N>) -> Option<Self> {
        let [nx, ny, nz] = field.dims.map(|n| n as i64);
        let dims = [nx + 2, ny + 2, nz + 2];
        let count = dims.iter().try_fold(N as i64, |c, n| c.checked_mul(*n))?;
        if count > i64::from(i32::MAX) {
            return None;
        }
        let mut values = Vec::with_capacity(usize::try_from(count).ok()?);
        for z in -1..=nz {
            for y in -1..=ny {
                for x in -1..=nx {
                    values.extend(field.sample([x, y, z]));
                }
            }
        }
        Some(Self {
            values,
            dims: dims.map(|n| n as u32),
            world_to_grid: DAffine3::from_translation(DVec3::ONE) * field.world_to_grid,
        })
    }

    fn as_field(&self) -> path::Field<'_> {
        path::Field {
            values: &self.values,
            dims: self.dims,
            world_to_grid: rows(&self.world_to_grid),
        }
    }
}

/// L_e but for a factor by place.
#[derive(Clone, Debug)]
enum Light {
    Constant([f32; 3]),
    Field(Rimmed),
    Temperature {
        values: Rimmed,
        scale: f32,
        offset: f32,
        colours: Vec<f32>,
        first: f32,
        density: f32,
    },
}

/// The light of a medium, in tables for packets.
#[derive(Clone, Debug)]
pub(crate) struct PacketSource {
    absorbed: [f32; 3],
    factor: Option<Rimmed>,
    light: Light,
}

impl Medium {
    /// Whether all that packet kernels cannot do of it, with a [`PacketSource`] beside them, is nothing.
    pub(in crate::world) fn is_plain_but_for_light(&self) -> bool {
        self.phase.is_plain()
            && matches!(self.record.kind, RecordKind::Grid { .. })
            && self
                .details
                .as_deref()
                .is_none_or(super::Details::is_light_alone)
    }

    /// Its light for packets; `None` where there is none, or where packets cannot render the medium otherwise.
    pub(in crate::world) fn packet_source(&self) -> Option<PacketSource> {
        let emission = self.emission()?;
        if !self.is_plain_but_for_light() {
            return None;
        }
        let scale = emission.scale;
        let light = match &emission.radiance {
            Radiance::Constant(colour) => Light::Constant(colour.map(|c| (c * scale) as f32)),
            Radiance::Field(field) => {
                let mut rimmed = Rimmed::new(field)?;
                for value in &mut rimmed.values {
                    *value = (f64::from(*value) * scale) as f32;
                }
                Light::Field(rimmed)
            }
            Radiance::Temperature(temperatures) => {
                let (colours, first, density) = temperatures.colours.table(scale);
                Light::Temperature {
                    values: Rimmed::new(&temperatures.field)?,
                    scale: temperatures.scale as f32,
                    offset: (-temperatures.offset * temperatures.scale) as f32,
                    colours,
                    first,
                    density,
                }
            }
        };
        let factor = match &emission.factor {
            Some(field) => Some(Rimmed::new(field)?),
            None => None,
        };
        let extinction = f64::from(self.record.scale);
        let source = PacketSource {
            absorbed: self.absorption.map(|s| (s / extinction) as f32),
            factor,
            light,
        };
        source.is_finite().then_some(source)
    }
}

impl PacketSource {
    /// Single precision may not hold a scale that double precision does.
    fn is_finite(&self) -> bool {
        let light = match &self.light {
            Light::Constant(colour) => colour.as_slice(),
            Light::Field(field) => &field.values,
            Light::Temperature { colours, .. } => colours,
        };
        light.iter().chain(&self.absorbed).all(|v| v.is_finite())
    }

    /// As kernels borrow it.
    pub(crate) fn as_source(&self) -> path::Source<'_> {
        path::Source {
            absorbed: self.absorbed,
            factor: self.factor.as_ref().map(Rimmed::as_field),
            radiance: match &self.light {
                Light::Constant(colour) => path::Radiance::Constant(*colour),
                Light::Field(field) => path::Radiance::Field(field.as_field()),
                Light::Temperature {
                    values,
                    scale,
                    offset,
                    colours,
                    first,
                    density,
                } => path::Radiance::Temperature {
                    values: values.as_field(),
                    scale: *scale,
                    offset: *offset,
                    colours: path::BlackBodies {
                        colours,
                        first: *first,
                        density: *density,
                        dark: DARK as f32,
                    },
                },
            },
        }
    }
}
