//! `MakeNamedMedium`.

use super::super::medium::{MediumId, MediumKind, NamedMedium};
use super::super::{Place, SceneError};
use super::diagnostics::Diagnostics;
use super::directive::At;
use super::grids::cloud;
use super::param::Type;
use super::params::Params;
use super::phase::phase;
use super::presets::preset;
use super::reader::Reader;
use super::state::affine;

const MEDIA: [&str; 7] = [
    "cloud",
    "homogeneous",
    "nanovdb",
    "openvdb",
    "rgbgrid",
    "uniformgrid",
    "vol",
];

impl Reader<'_> {
    pub(super) fn make_named_medium(&mut self, at: &At) -> Result<(), SceneError> {
        let (name, place) = self.string(at, "a medium's name")?;
        let inherited = self.state.inherited.medium.clone();
        let mut params = self.params(at, format!("medium \"{name}\""), inherited)?;
        if name.is_empty() {
            return Err(SceneError::at(
                &place,
                "a medium needs a name; \"\" means vacuum",
            ));
        }
        if let Some((_, older)) = self.world.medium_names.get(&name) {
            let message = format!("medium \"{name}\" is defined twice");
            return Err(SceneError::at(&place, message).note(older, "first here"));
        }
        let medium = self.medium(at, &name, &place, &mut params)?;
        let id = medium.map(|medium| {
            self.world.media.push(medium);
            MediumId(self.world.media.len() - 1)
        });
        self.world.medium_names.insert(name, (id, place));
        Ok(())
    }

    /// The medium; `None` if it was refused and we are lenient, so that it stays vacuum.
    fn medium(
        &mut self,
        at: &At,
        name: &str,
        place: &Place,
        params: &mut Params,
    ) -> Result<Option<NamedMedium>, SceneError> {
        let Some(ty) = params.string("type")?.cloned() else {
            let message = format!("medium \"{name}\" has no \"string type\"");
            let help = format!("supported are {}", MEDIA.join(", "));
            return Err(SceneError::at(place, message).help(help));
        };
        params.rename(format!("medium \"{name}\" ({})", ty.text));
        let kind = match ty.text.as_str() {
            "homogeneous" => MediumKind::Homogeneous,
            "uniformgrid" => self.uniform_grid(params)?,
            "rgbgrid" => self.rgb_grid(params)?,
            "cloud" => cloud(params)?,
            "openvdb" => self.openvdb(params)?,
            "nanovdb" => self.nanovdb(params)?,
            "vol" => self.vol(params)?,
            _ => {
                self.known("medium type", &ty.text, &ty.place, &MEDIA)?;
                return Ok(None);
            }
        };
        let measured = match &kind {
            MediumKind::RgbGrid(_) => None,
            _ => preset(params, &mut self.diagnostics)?,
        };
        let scale = params
            .float("scale", "0 or more", |v| v >= 0.0)?
            .unwrap_or(1.0);
        let emission = self.medium_emission(params, &kind)?;
        let diagnostics = &mut self.diagnostics;
        let mut sigma = |name, measured: Option<[f64; 3]>| match (&kind, measured) {
            // Its coefficients by place are in the grid.
            (MediumKind::RgbGrid(_), _) => scaled([1.0; 3], scale, name, params),
            (_, Some(measured)) => {
                let types = [Type::Rgb, Type::Spectrum];
                if let Some(param) = params.find(name, &types)? {
                    let message = format!("give either \"preset\" or \"{name}\"");
                    return Err(SceneError::at(&param.declared, message));
                }
                scaled(measured, scale, name, params)
            }
            _ => coefficient(params, name, scale, diagnostics),
        };
        let sigma_a = sigma("sigma_a", measured.map(|[a, _]| a))?;
        let sigma_s = sigma("sigma_s", measured.map(|[_, s]| s))?;
        if emission.is_some() && sigma_a == [0.0; 3] {
            let message = format!("medium \"{name}\" shines only where it absorbs: nowhere");
            diagnostics.warn(SceneError::at(place, message));
        }
        if sigma_a.iter().chain(&sigma_s).all(|&c| c == 0.0) {
            let message = format!("medium \"{name}\" neither absorbs nor scatters");
            diagnostics.warn(SceneError::at(place, message));
        }
        let phase = phase(params, diagnostics)?;
        self.charge(params.copied(), &at.place)?;
        let diagnostics = &mut self.diagnostics;
        params.finish(diagnostics)?;
        self.not_moving(&at.place)?;
        let [medium_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        Ok(Some(NamedMedium {
            name: name.to_owned(),
            kind,
            sigma_a,
            sigma_s,
            phase,
            emission,
            medium_to_world,
            place: place.clone(),
        }))
    }
}

/// A coefficient times `scale`; 1 by default, as in pbrt.
fn coefficient(
    params: &Params,
    name: &'static str,
    scale: f64,
    diagnostics: &mut Diagnostics,
) -> Result<[f64; 3], SceneError> {
    let sigma = params.coefficient(name, diagnostics)?.unwrap_or([1.0; 3]);
    scaled(sigma, scale, name, params)
}

fn scaled(
    sigma: [f64; 3],
    scale: f64,
    name: &str,
    params: &Params,
) -> Result<[f64; 3], SceneError> {
    let sigma = sigma.map(|c| c * scale);
    // Rendering is in f32.
    if sigma.iter().all(|c| (*c as f32).is_finite()) {
        return Ok(sigma);
    }
    let message = format!("{name} times scale is too large: {sigma:?}");
    Err(SceneError::at(params.place(), message))
}
