//! Colour parameters: `rgb`, `spectrum` and `blackbody`, all brought to linear Rec. 709.

use super::super::color::{self, Piecewise};
use super::super::{Place, SceneError};
use super::diagnostics::Diagnostics;
use super::param::{Param, Type, Values};
use super::params::Params;

impl Params {
    /// A coefficient per channel, not negative \[as given\].
    pub(super) fn coefficient(
        &self,
        name: &'static str,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<[f64; 3]>, SceneError> {
        let Some(param) = self.find(name, &[Type::Rgb, Type::Spectrum])? else {
            return Ok(None);
        };
        if param.ty == Type::Rgb {
            return triple(param).map(Some);
        }
        let pairs = pairs(param)?;
        let spectrum = Piecewise(&pairs);
        if spectrum.constant().is_none() {
            diagnostics.warn(projected(&param.valued));
        }
        Ok(Some(clamped(
            color::coefficient(&spectrum),
            param,
            diagnostics,
        )))
    }

    /// The colour of emitted light. pbrt takes the level of an `rgb` as it is, and brings any other
    /// spectrum to luminance 1.
    pub(super) fn emission(
        &self,
        name: &'static str,
        diagnostics: &mut Diagnostics,
    ) -> Result<Option<[f64; 3]>, SceneError> {
        let types = [Type::Rgb, Type::Spectrum, Type::Blackbody];
        let Some(param) = self.find(name, &types)? else {
            return Ok(None);
        };
        let colour = match param.ty {
            Type::Rgb => return triple(param).map(Some),
            Type::Blackbody => {
                let temperature = single(param)?;
                if temperature <= 0.0 {
                    let message = format!("a temperature must be positive, found {temperature}");
                    return Err(SceneError::at(&param.nth(0), message).help("it is in kelvin"));
                }
                color::blackbody(temperature)
            }
            _ if is_d65(param) => return Ok(Some([1.0; 3])),
            _ => color::light(&Piecewise(&pairs(param)?)),
        };
        let Some(colour) = colour else {
            let message = "this light is invisible, so it cannot be brought to luminance 1";
            return Err(SceneError::at(&param.valued, message)
                .help("pbrt scales every spectrum but rgb to luminance 1 before `scale`"));
        };
        diagnostics.warn(projected(&param.valued));
        Ok(Some(clamped(colour, param, diagnostics)))
    }
}

fn projected(place: &Place) -> SceneError {
    SceneError::at(place, "this spectrum is projected to linear Rec. 709 (RGB)")
        .help("rendering is not spectral; give \"rgb\" to choose the values")
}

fn clamped(colour: [f64; 3], param: &Param, diagnostics: &mut Diagnostics) -> [f64; 3] {
    if colour.iter().any(|c| *c < 0.0) {
        let message =
            format!("outside of Rec. 709's gamut: {colour:?}; negative channels become 0");
        diagnostics.warn(SceneError::at(&param.valued, message));
    }
    colour.map(|c| c.max(0.0))
}

fn numbers(param: &Param) -> &[f64] {
    match &param.values {
        Values::Numbers(numbers) => numbers,
        _ => &[],
    }
}

fn single(param: &Param) -> Result<f64, SceneError> {
    match numbers(param) {
        [value] => Ok(*value),
        other => {
            let message = format!("\"{}\" takes one value, found {}", param.name, other.len());
            Err(SceneError::at(&param.valued, message))
        }
    }
}

fn triple(param: &Param) -> Result<[f64; 3], SceneError> {
    let values = numbers(param);
    let Ok(rgb) = <[f64; 3]>::try_from(values) else {
        let message = format!(
            "\"{}\" takes one rgb, found {}",
            param.name,
            values.len() / 3
        );
        return Err(SceneError::at(&param.valued, message));
    };
    not_negative(param, &rgb)?;
    Ok(rgb)
}

fn not_negative(param: &Param, values: &[f64]) -> Result<(), SceneError> {
    match values.iter().position(|v| *v < 0.0) {
        Some(i) => {
            let message = format!(
                "\"{}\" must not be negative, found {}",
                param.name, values[i]
            );
            Err(SceneError::at(&param.nth(i), message))
        }
        None => Ok(()),
    }
}

fn is_d65(param: &Param) -> bool {
    matches!(&param.values, Values::Strings(s) if s.iter().all(|t| t.text == "stdillum-D65"))
}

/// Wavelengths and values.
pub(super) fn pairs(param: &Param) -> Result<Vec<(f64, f64)>, SceneError> {
    if let Values::Strings(strings) = &param.values
        && let Some(text) = strings.first()
    {
        let message = format!("named spectrum \"{}\" is not yet supported", text.text);
        return Err(SceneError::at(&text.place, message).help(
            "supported are pairs of wavelength and value, rgb, and stdillum-D65 for lights",
        ));
    }
    let values = numbers(param);
    if values.is_empty() {
        return Err(SceneError::at(&param.valued, "this spectrum is empty"));
    }
    let (pairs, _) = values.as_chunks::<2>();
    for (i, window) in pairs.windows(2).enumerate() {
        if window[1][0] <= window[0][0] {
            let message = "the wavelengths of a spectrum must increase";
            return Err(SceneError::at(&param.nth(2 * i + 2), message)
                .help("a spectrum is a list of pairs: wavelength in nanometres, value"));
        }
    }
    if let Some(i) = pairs.iter().position(|pair| pair[1] < 0.0) {
        let message = format!(
            "\"{}\" must not be negative, found {}",
            param.name, pairs[i][1]
        );
        return Err(SceneError::at(&param.nth(2 * i + 1), message));
    }
    Ok(pairs.iter().map(|&[at, value]| (at, value)).collect())
}
