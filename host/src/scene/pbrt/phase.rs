//! The phase functions of media.

use super::super::SceneError;
use super::super::medium::Phase;
use super::diagnostics::Diagnostics;
use super::params::Params;
use super::suggest::nearest;

const PHASES: [&str; 6] = [
    "draine",
    "droplets",
    "hg",
    "isotropic",
    "rayleigh",
    "twolobe",
];
/// Largest droplets that the fit knows \[µm\].
const LARGEST: f64 = 50.0;

/// Henyey–Greenstein's with `g`, as in pbrt, unless `phase` names another.
pub(super) fn phase(params: &Params, diagnostics: &mut Diagnostics) -> Result<Phase, SceneError> {
    let g = mean_cosine(params, "g")?;
    let hg = match g {
        Some(g) if g != 0.0 => Phase::HenyeyGreenstein { g },
        _ => Phase::Isotropic,
    };
    let Some(text) = params.string("phase")? else {
        return Ok(hg);
    };
    let needs = |name: &str| {
        let message = format!("phase \"{}\" needs \"float {name}\"", text.text);
        SceneError::at(&text.place, message)
    };
    let phase = match text.text.as_str() {
        "hg" => return Ok(hg),
        "draine" => {
            let finite = |alpha: f64| alpha >= 0.0 && (alpha as f32).is_finite();
            let alpha = params.float("alpha", "0 or more", finite)?;
            return Ok(Phase::Draine {
                g: g.unwrap_or(0.0),
                alpha: alpha.ok_or_else(|| needs("alpha"))?,
            });
        }
        "twolobe" => {
            let share = params.float("share", "from 0 to 1", |v| (0.0..=1.0).contains(&v))?;
            return Ok(Phase::TwoLobe {
                forward: g.ok_or_else(|| needs("g"))?,
                backward: mean_cosine(params, "g2")?.ok_or_else(|| needs("g2"))?,
                share: share.ok_or_else(|| needs("share"))?,
            });
        }
        "isotropic" => Phase::Isotropic,
        "rayleigh" => Phase::Rayleigh,
        "droplets" => {
            let range = "above 0 and at most 50 micrometres";
            let diameter = params.float("diameter", range, |d| d > 0.0 && d <= LARGEST)?;
            Phase::Droplets {
                diameter: diameter.ok_or_else(|| needs("diameter"))?,
            }
        }
        other => {
            let later = ["mie", "tabulated"].contains(&other);
            let what = if later {
                "is not yet supported"
            } else {
                "is unknown"
            };
            let error = SceneError::at(&text.place, format!("phase function \"{other}\" {what}"));
            diagnostics.refuse(match nearest(other, PHASES).filter(|_| !later) {
                Some(near) => error.help(format!("did you mean \"{near}\"?")),
                None => error.help(format!("supported are {}", PHASES.join(", "))),
            })?;
            return Ok(hg);
        }
    };
    if let Some(g) = g.filter(|g| *g != 0.0) {
        let message = format!("phase \"{}\" has no \"g\", but g is {g}", text.text);
        return Err(SceneError::at(&text.place, message));
    }
    Ok(phase)
}

/// Strictly between the ends, in single precision, too.
fn mean_cosine(params: &Params, name: &'static str) -> Result<Option<f64>, SceneError> {
    params.float(name, "between -1 and 1", |g| g.abs() < 1.0)
}
