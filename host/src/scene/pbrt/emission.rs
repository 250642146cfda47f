//! Light that media send out: `Le`, `Lescale`, and temperatures.

use super::super::SceneError;
use super::super::medium::{Emission, MediumKind, Temperature, TemperatureValues};
use super::grids::voxels;
use super::param::{Param, Type, Values};
use super::params::Params;
use super::reader::Reader;

const COLOURS: [Type; 3] = [Type::Rgb, Type::Spectrum, Type::Blackbody];

impl Reader<'_> {
    /// What a medium of this kind sends out; `None` where that is nothing.
    ///
    /// A temperature takes the place of `Le`. In files it is read where the scene asks for it by `Lescale` or one of the
    /// temperature's own parameters.
    pub(super) fn medium_emission(
        &mut self,
        params: &Params,
        kind: &MediumKind,
    ) -> Result<Option<Emission>, SceneError> {
        let instead = "pbrt-v4 calls it \"temperatureoffset\"";
        params.unsupported("temperaturecutoff", instead, &mut self.diagnostics)?;
        let mut emission = Emission {
            scale: 1.0,
            ..Emission::default()
        };
        match kind {
            MediumKind::Cloud(_) => return Ok(None),
            MediumKind::RgbGrid(grid) => {
                // Its `Le` has been read with the grid.
                emission.scale = scalar(params)?.unwrap_or(1.0);
                return Ok((grid.le.is_some() && emission.scale > 0.0).then_some(emission));
            }
            MediumKind::Homogeneous | MediumKind::Vol(_) => {
                emission.scale = scalar(params)?.unwrap_or(1.0);
            }
            MediumKind::UniformGrid(grid) => {
                if let Some((values, param)) = params.list("Lescale", Type::Float)? {
                    if let [scale] = values {
                        emission.scale = checked(*scale, param)?;
                    } else {
                        let what = "value of Lescale";
                        let scales = voxels(values, param, grid.resolution, what)?;
                        emission.scale_grid = Some(scales);
                    }
                }
                if let Some((values, param)) = params.list("temperature", Type::Float)? {
                    let values = voxels(values, param, grid.resolution, "temperature value")?;
                    emission.temperature =
                        Some(temperature(params, TemperatureValues::Listed(values))?);
                }
            }
            MediumKind::OpenVdb(_) | MediumKind::NanoVdb(_) => {
                let scale = scalar(params)?;
                let name = params.string("temperaturename")?;
                let float = [Type::Float];
                let asked = name.is_some()
                    || params.find("temperaturescale", &float)?.is_some()
                    || params.find("temperatureoffset", &float)?.is_some()
                    || (scale.is_some() && params.find("Le", &COLOURS)?.is_none());
                emission.scale = scale.unwrap_or(1.0);
                if asked {
                    let name = name.map_or("temperature", |text| &text.text);
                    let values = TemperatureValues::Grid(name.to_owned());
                    emission.temperature = Some(temperature(params, values)?);
                }
            }
        }
        if let Some(param) = params.find("Le", &COLOURS)?.filter(|p| !dark(p)) {
            if emission.temperature.is_some() {
                let message = "a medium has either \"Le\" or a temperature";
                return Err(SceneError::at(&param.declared, message));
            }
            let colour = params.emission("Le", &mut self.diagnostics)?;
            emission.le = colour.unwrap_or([0.0; 3]);
        }
        let shines = emission.temperature.is_some() || emission.le != [0.0; 3];
        let lit = emission.scale_grid.iter().flatten().any(|s| *s > 0.0);
        let scaled = emission.scale > 0.0 && (lit || emission.scale_grid.is_none());
        let brightest = emission.le.map(|c| (c * emission.scale) as f32);
        if !brightest.iter().all(|c| c.is_finite()) {
            let message = format!("this medium is too bright: {brightest:?}");
            return Err(SceneError::at(params.place(), message));
        }
        Ok((shines && scaled).then_some(emission))
    }
}

/// `Lescale`, or `LeScale` as pbrt has it for files.
fn scalar(params: &Params) -> Result<Option<f64>, SceneError> {
    for name in ["Lescale", "LeScale"] {
        let fine = |v: f64| v >= 0.0 && (v as f32).is_finite();
        if let Some(scale) = params.float(name, "0 or more", fine)? {
            return Ok(Some(scale));
        }
    }
    Ok(None)
}

fn checked(scale: f64, param: &Param) -> Result<f64, SceneError> {
    if scale >= 0.0 && (scale as f32).is_finite() {
        return Ok(scale);
    }
    let message = format!("\"Lescale\" must be 0 or more, found {scale}");
    Err(SceneError::at(&param.nth(0), message))
}

fn temperature(params: &Params, values: TemperatureValues) -> Result<Temperature, SceneError> {
    let number = |name, default| -> Result<f64, SceneError> {
        let fine = |v: f64| (v as f32).is_finite();
        let value = params.float(name, "finite in single precision", fine)?;
        Ok(value.unwrap_or(default))
    };
    Ok(Temperature {
        values,
        offset: number("temperatureoffset", 0.0)?,
        scale: number("temperaturescale", 1.0)?,
    })
}

/// Whether a colour is given as zero everywhere.
fn dark(param: &Param) -> bool {
    match (&param.values, param.ty) {
        (Values::Numbers(numbers), Type::Rgb) => numbers.iter().all(|&v| v == 0.0),
        (Values::Numbers(numbers), Type::Spectrum) => {
            numbers.iter().skip(1).step_by(2).all(|&v| v == 0.0)
        }
        _ => false,
    }
}
