//! `MakeNamedMedium`.

use glam::DVec3;

use super::super::medium::{MediumId, MediumKind, NamedMedium, OpenVdb, Phase, UniformGrid};
use super::super::{Place, SceneError};
use super::diagnostics::Diagnostics;
use super::directive::At;
use super::param::{Type, Values};
use super::params::Params;
use super::reader::Reader;
use super::state::affine;
use super::suggest::nearest;

const SUPPORTED: &str = "supported are homogeneous, uniformgrid and openvdb";

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
            return Err(SceneError::at(place, message).help(SUPPORTED));
        };
        params.rename(format!("medium \"{name}\" ({})", ty.text));
        let kind = match ty.text.as_str() {
            "homogeneous" => homogeneous(params, &mut self.diagnostics)?,
            "uniformgrid" => self.uniform_grid(params)?,
            "openvdb" => self.openvdb(params)?,
            other => {
                let later = ["cloud", "nanovdb", "rgbgrid", "vol"];
                let what = if later.contains(&other) {
                    "is not yet supported"
                } else {
                    "is unknown"
                };
                let error = SceneError::at(&ty.place, format!("medium type \"{other}\" {what}"));
                let near = nearest(other, ["homogeneous", "uniformgrid", "openvdb"]);
                let error = match near.filter(|_| !later.contains(&other)) {
                    Some(near) => error.help(format!("did you mean \"{near}\"?")),
                    None => error.help(SUPPORTED),
                };
                self.diagnostics.refuse(error)?;
                return Ok(None);
            }
        };
        let scale = params
            .float("scale", "0 or more", |v| v >= 0.0)?
            .unwrap_or(1.0);
        let diagnostics = &mut self.diagnostics;
        let sigma_a = coefficient(params, "sigma_a", scale, diagnostics)?;
        let sigma_s = coefficient(params, "sigma_s", scale, diagnostics)?;
        if sigma_a.iter().chain(&sigma_s).all(|&c| c == 0.0) {
            let message = format!("medium \"{name}\" neither absorbs nor scatters");
            diagnostics.warn(SceneError::at(place, message));
        }
        let phase = phase(params, diagnostics)?;
        not_emissive(params, diagnostics)?;
        params.finish(diagnostics)?;
        self.not_moving(&at.place)?;
        let [medium_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        Ok(Some(NamedMedium {
            emission: None,
            name: name.to_owned(),
            kind,
            sigma_a,
            sigma_s,
            phase,
            medium_to_world,
            place: place.clone(),
        }))
    }

    fn uniform_grid(&mut self, params: &Params) -> Result<MediumKind, SceneError> {
        let size = |name| -> Result<usize, SceneError> {
            let size = params.integer(name, "at least 1", |n| n >= 1)?;
            Ok(size.unwrap_or(1) as usize)
        };
        let resolution = [size("nx")?, size("ny")?, size("nz")?];
        let [nx, ny, nz] = resolution;
        let Some((values, param)) = params.list("density", Type::Float)? else {
            let message = "this uniformgrid has no \"float density\"";
            return Err(SceneError::at(params.place(), message));
        };
        let expected = nx as u128 * ny as u128 * nz as u128;
        if expected * 4 > u128::from(self.limits.max_memory) {
            let message = format!(
                "a grid of {nx} x {ny} x {nz} voxels takes {} bytes",
                expected * 4
            );
            let limit = format!("the limit is {} bytes", self.limits.max_memory);
            return Err(SceneError::at(params.place(), message).help(limit));
        }
        if values.len() as u128 != expected {
            let message = format!(
                "{} density values, but nx * ny * nz = {nx} * {ny} * {nz} = {expected}",
                values.len()
            );
            return Err(SceneError::at(&param.valued, message));
        }
        let mut density = Vec::with_capacity(values.len());
        for (i, &value) in values.iter().enumerate() {
            let rounded = value as f32;
            if !(rounded.is_finite() && value >= 0.0) {
                let (x, y, z) = (i % nx, i / nx % ny, i / nx / ny);
                let fault = if value < 0.0 {
                    "negative"
                } else {
                    "too large for f32"
                };
                let message =
                    format!("density value {i} is {fault}: {value} at voxel ({x}, {y}, {z})");
                return Err(SceneError::at(&param.nth(i), message));
            }
            density.push(rounded);
        }
        if let Some((scales, param)) = params.list("Lescale", Type::Float)?
            && scales.len() as u128 != expected
        {
            let message = format!("{} values of Lescale, but {expected} voxels", scales.len());
            return Err(SceneError::at(&param.valued, message));
        }
        let (p0, p1) = (params.point("p0")?, params.point("p1")?);
        let (a, b) = (p0.unwrap_or(DVec3::ZERO), p1.unwrap_or(DVec3::ONE));
        let (p0, p1) = (a.min(b), a.max(b));
        if !(p1 - p0).is_finite() || (p1 - p0).min_element() <= 0.0 {
            let message = "the box from p0 to p1 has no volume";
            return Err(SceneError::at(params.place(), message));
        }
        for name in [
            "temperature",
            "temperaturescale",
            "temperatureoffset",
            "temperaturecutoff",
        ] {
            params.unsupported(name, "media do not emit light yet", &mut self.diagnostics)?;
        }
        Ok(MediumKind::UniformGrid(UniformGrid {
            resolution,
            density,
            p0,
            p1,
        }))
    }

    fn openvdb(&mut self, params: &Params) -> Result<MediumKind, SceneError> {
        let Some(filename) = params.string("filename")? else {
            let message = "this openvdb medium has no \"string filename\"";
            return Err(SceneError::at(params.place(), message));
        };
        let path = self.resolve(&filename.text);
        if !self.files.exists(&path) {
            let message = format!("there is no file {}", path.display());
            return Err(SceneError::at(&filename.place, message)
                .help("paths are relative to the directory of the main scene file"));
        }
        let gridname = params.string("gridname")?;
        let gridname = gridname.map_or("density", |text| &text.text).to_owned();
        for name in [
            "temperaturename",
            "temperaturescale",
            "temperatureoffset",
            "temperaturecutoff",
        ] {
            params.unsupported(name, "media do not emit light yet", &mut self.diagnostics)?;
        }
        params.ignore("Lescale", &[Type::Float])?;
        Ok(MediumKind::OpenVdb(OpenVdb {
            filename: path,
            gridname,
        }))
    }
}

fn homogeneous(params: &Params, diagnostics: &mut Diagnostics) -> Result<MediumKind, SceneError> {
    params.unsupported("preset", "give sigma_a and sigma_s", diagnostics)?;
    params.ignore("Lescale", &[Type::Float])?;
    Ok(MediumKind::Homogeneous)
}

/// A coefficient times `scale`; 1 by default, as in pbrt.
fn coefficient(
    params: &Params,
    name: &'static str,
    scale: f64,
    diagnostics: &mut Diagnostics,
) -> Result<[f64; 3], SceneError> {
    let sigma = params.coefficient(name, diagnostics)?.unwrap_or([1.0; 3]);
    let sigma = sigma.map(|c| c * scale);
    // Rendering is in f32.
    if sigma.iter().all(|c| (*c as f32).is_finite()) {
        return Ok(sigma);
    }
    let message = format!("{name} times scale is too large: {sigma:?}");
    Err(SceneError::at(params.place(), message))
}

fn phase(params: &Params, diagnostics: &mut Diagnostics) -> Result<Phase, SceneError> {
    let g = params
        .float("g", "between -1 and 1", |g| g.abs() < 1.0)?
        .unwrap_or(0.0);
    let hg = if g == 0.0 {
        Phase::Isotropic
    } else {
        Phase::HenyeyGreenstein { g }
    };
    let Some(text) = params.string("phase")? else {
        return Ok(hg);
    };
    let phase = match text.text.as_str() {
        "hg" => return Ok(hg),
        "isotropic" => Phase::Isotropic,
        "rayleigh" => Phase::Rayleigh,
        other => {
            let names = ["hg", "isotropic", "rayleigh"];
            let later = ["draine", "mie", "tabulated"].contains(&other);
            let what = if later {
                "is not yet supported"
            } else {
                "is unknown"
            };
            let error = SceneError::at(&text.place, format!("phase function \"{other}\" {what}"));
            diagnostics.refuse(match nearest(other, names).filter(|_| !later) {
                Some(near) => error.help(format!("did you mean \"{near}\"?")),
                None => error.help("supported are hg, isotropic and rayleigh"),
            })?;
            return Ok(hg);
        }
    };
    if g != 0.0 {
        let message = format!("phase \"{}\" has no \"g\", but g is {g}", text.text);
        return Err(SceneError::at(&text.place, message));
    }
    Ok(phase)
}

/// Refuses emission unless it is zero.
fn not_emissive(params: &Params, diagnostics: &mut Diagnostics) -> Result<(), SceneError> {
    let types = [Type::Rgb, Type::Spectrum, Type::Blackbody];
    let Some(param) = params.find("Le", &types)? else {
        return Ok(());
    };
    let dark = match (&param.values, param.ty) {
        (Values::Numbers(numbers), Type::Rgb) => numbers.iter().all(|&v| v == 0.0),
        (Values::Numbers(numbers), Type::Spectrum) => {
            numbers.iter().skip(1).step_by(2).all(|&v| v == 0.0)
        }
        _ => false,
    };
    if dark {
        return Ok(());
    }
    diagnostics.refuse(params.not_yet(param, "media do not emit light yet; remove it or give 0"))
}
