//! What stands before `WorldBegin`: film, sampler, filter, integrator, and the options that
//! change nothing here.

use super::super::film::{Film, PixelBounds};
use super::super::{Integrator, Place, SceneError};
use super::directive::At;
use super::lexer::Kind;
use super::param::Type;
use super::params::Params;
use super::reader::Reader;
use super::suggest::nearest;
use crate::film::Window;

/// Bytes that a pixel takes while rendering: two moments per channel in f64, and a count.
const BYTES_PER_PIXEL: u64 = 56;

impl Reader<'_> {
    pub(super) fn rendering_option(
        &mut self,
        at: &At,
        name: &str,
        (ty, place, params): (String, Place, Params),
    ) -> Result<(), SceneError> {
        match name {
            "Camera" => return self.camera(at, ty, &place, params),
            "Film" => return self.film(&ty, &place, &params),
            "Sampler" => self.sampler(&ty, &place, &params)?,
            "PixelFilter" => self.pixel_filter(&ty, &place, &params)?,
            "Integrator" => self.integrator(&ty, &place, &params)?,
            _ => self.accelerator(&ty, &place, &params)?,
        }
        Ok(())
    }

    /// Whether `ty` is among the names that pbrt knows; if not, that is refused.
    pub(super) fn known(
        &mut self,
        what: &str,
        ty: &str,
        place: &Place,
        names: &[&str],
    ) -> Result<bool, SceneError> {
        if names.contains(&ty) {
            return Ok(true);
        }
        let error = SceneError::at(place, format!("unknown {what} \"{ty}\""));
        self.diagnostics
            .refuse(match nearest(ty, names.iter().copied()) {
                Some(near) => error.help(format!("did you mean \"{near}\"?")),
                None => error.help(format!("there are {}", names.join(", "))),
            })?;
        Ok(false)
    }

    fn film(&mut self, ty: &str, place: &Place, params: &Params) -> Result<(), SceneError> {
        if self.known("film", ty, place, &["rgb", "gbuffer", "spectral"])? && ty != "rgb" {
            let message = format!("film \"{ty}\" is not yet supported");
            self.diagnostics
                .refuse(SceneError::at(place, message).help("supported is \"rgb\""))?;
        }
        let size = |name| params.integer(name, "at least 1", |n| n >= 1);
        let width = size("xresolution")?.unwrap_or(1280) as u32;
        let height = size("yresolution")?.unwrap_or(720) as u32;
        let bytes = u64::from(width) * u64::from(height) * BYTES_PER_PIXEL;
        if bytes > self.limits.max_memory {
            let message = format!("a film of {width} x {height} pixels takes {bytes} bytes");
            let limit = format!("the limit is {} bytes", self.limits.max_memory);
            return Err(SceneError::at(params.place(), message).help(limit));
        }
        let crop = crop(params, width, height)?;
        let filename = params
            .string("filename")?
            .map_or_else(|| "pbrt.exr".to_owned(), |text| text.text.clone());
        let iso = params
            .float("iso", "positive", |v| v > 0.0)?
            .unwrap_or(100.0);
        for (name, types) in [("diagonal", [Type::Float]), ("savefp16", [Type::Bool])] {
            params.ignore(name, &types)?;
        }
        let sensor = params.string("sensor")?;
        if let Some(sensor) = sensor.filter(|s| s.text != "cie1931") {
            let message = format!("sensor \"{}\" is not yet supported", sensor.text);
            self.diagnostics
                .refuse(SceneError::at(&sensor.place, message).help("supported is \"cie1931\""))?;
        }
        if params
            .float("whitebalance", "a temperature", |_| true)?
            .unwrap_or(0.0)
            != 0.0
        {
            let instead = "the image is linear Rec. 709 as rendered";
            params.unsupported("whitebalance", instead, &mut self.diagnostics)?;
        }
        if let Some(param) = params.find("maxcomponentvalue", &[Type::Float])? {
            let message = "\"maxcomponentvalue\" is ignored: clamping samples would bias the image";
            self.diagnostics
                .warn(SceneError::at(&param.declared, message));
        }
        if ty == "rgb" {
            params.finish(&mut self.diagnostics)?;
        }
        self.world.film = Some(Film {
            width,
            height,
            crop,
            filename,
            imaging_ratio: iso / 100.0,
            place: Some(params.place().clone()),
        });
        Ok(())
    }

    fn sampler(&mut self, ty: &str, place: &Place, params: &Params) -> Result<(), SceneError> {
        let names = [
            "halton",
            "independent",
            "paddedsobol",
            "pmj02bn",
            "sobol",
            "stratified",
            "zsobol",
        ];
        self.known("sampler", ty, place, &names)?;
        let count = |name| params.integer(name, "at least 1", |n| n >= 1);
        self.world.samples_per_pixel =
            if ty == "stratified" {
                params.ignore("jitter", &[Type::Bool])?;
                let x = count("xsamples")?.unwrap_or(4);
                let samples = x * count("ysamples")?.unwrap_or(4);
                Some(u32::try_from(samples).map_err(|_| {
                    SceneError::at(params.place(), "more than 2^32 samples per pixel")
                })?)
            } else {
                params.ignore("randomization", &[Type::String])?;
                count("pixelsamples")?.map(|n| n as u32)
            };
        if let Some(seed) = params.integer("seed", "an integer", |_| true)? {
            self.world.seed = Some(seed as u64);
        }
        params.finish(&mut self.diagnostics)
    }

    fn pixel_filter(&mut self, ty: &str, place: &Place, params: &Params) -> Result<(), SceneError> {
        let names = ["box", "gaussian", "mitchell", "sinc", "triangle"];
        self.known("pixel filter", ty, place, &names)?;
        for name in ["xradius", "yradius", "B", "C", "sigma", "tau"] {
            params.ignore(name, &[Type::Float])?;
        }
        let wide = |name| {
            Ok(params
                .float(name, "positive", |v| v > 0.0)?
                .is_some_and(|r| r != 0.5))
        };
        if ty != "box" || wide("xradius")? || wide("yradius")? {
            let message =
                format!("the \"{ty}\" pixel filter asked for is replaced by a box of one pixel");
            self.diagnostics.warn(SceneError::at(place, message));
        }
        params.finish(&mut self.diagnostics)
    }

    fn integrator(&mut self, ty: &str, place: &Place, params: &Params) -> Result<(), SceneError> {
        let names = [
            "ambientocclusion",
            "bdpt",
            "function",
            "lightpath",
            "mlt",
            "path",
            "randomwalk",
            "simplepath",
            "simplevolpath",
            "sppm",
            "volpath",
        ];
        let name = match ty {
            "volpath" | "simplevolpath" | "path" | "simplepath" => Some("path"),
            "bdpt" | "mlt" | "single" | "transmittance" => Some(ty),
            _ => None,
        };
        let names: Vec<&str> = names
            .into_iter()
            .chain(["single", "transmittance"])
            .collect();
        if self.known("integrator", ty, place, &names)? && name.is_none() {
            let message = format!("integrator \"{ty}\" is not yet supported");
            let help = "supported are volpath, simplevolpath, path, simplepath, bdpt, mlt, single and transmittance";
            self.diagnostics
                .refuse(SceneError::at(place, message).help(help))?;
        }
        if ty == "path" || ty == "simplepath" {
            let message =
                format!("pbrt's \"{ty}\" ignores media; here they are rendered, as by \"volpath\"");
            self.diagnostics.warn(SceneError::at(place, message));
        }
        let depth = params.integer("maxdepth", "0 or more", |n| n >= 0)?;
        params.ignore("lightsampler", &[Type::String])?;
        if params.boolean("regularize")? == Some(true) {
            let instead = "it would bias the image";
            params.unsupported("regularize", instead, &mut self.diagnostics)?;
        }
        match ty {
            "simplepath" => {
                params.ignore("samplebsdf", &[Type::Bool])?;
                params.ignore("samplelights", &[Type::Bool])?;
            }
            "bdpt" => {
                for name in ["visualizestrategies", "visualizeweights"] {
                    if params.boolean(name)? == Some(true) {
                        let instead = "it is for the study of an algorithm";
                        params.unsupported(name, instead, &mut self.diagnostics)?;
                    }
                }
            }
            "mlt" => self.metropolis(params)?,
            _ => {}
        }
        self.world.integrator = Some(Integrator {
            name: name.unwrap_or("path").to_owned(),
            max_depth: depth.map(|n| n as u32),
        });
        if name.is_some() {
            params.finish(&mut self.diagnostics)?;
        }
        Ok(())
    }

    /// What pbrt lets one tune and the program chooses itself.
    fn metropolis(&mut self, params: &Params) -> Result<(), SceneError> {
        let counts = ["bootstrapsamples", "chains", "mutationsperpixel"];
        let given = counts.map(|name| (name, Type::Integer));
        let rates = ["largestepprobability", "sigma"].map(|name| (name, Type::Float));
        for (name, ty) in given.into_iter().chain(rates) {
            if let Some(param) = params.find(name, &[ty])? {
                let message = format!("\"{name}\" is ignored: the program chooses it");
                self.diagnostics
                    .warn(SceneError::at(&param.declared, message));
            }
        }
        Ok(())
    }

    fn accelerator(&mut self, ty: &str, place: &Place, params: &Params) -> Result<(), SceneError> {
        self.known("accelerator", ty, place, &["bvh", "kdtree"])?;
        params.ignore("splitmethod", &[Type::String])?;
        params.ignore("emptybonus", &[Type::Float])?;
        for name in [
            "maxnodeprims",
            "intersectcost",
            "traversalcost",
            "maxprims",
            "maxdepth",
        ] {
            params.ignore(name, &[Type::Integer])?;
        }
        params.finish(&mut self.diagnostics)
    }

    /// `Option "name" value`.
    pub(super) fn option(&mut self, at: &At) -> Result<(), SceneError> {
        const NAMES: [&str; 12] = [
            "disablepixeljitter",
            "disabletexturefiltering",
            "disablewavelengthjitter",
            "displacementedgescale",
            "forcediffuse",
            "msereferenceimage",
            "msereferenceout",
            "pixelstats",
            "rendercoordsys",
            "seed",
            "wavefront",
            "quiet",
        ];
        let (written, place) = self.string(at, "an option's name")?;
        // As pbrt compares them.
        let name = written.replace(['-', '_'], "").to_ascii_lowercase();
        let lexer = self.lexer(at.file);
        let value = lexer.next()?;
        let value = value.filter(|t| matches!(t.kind, Kind::Word | Kind::String));
        let Some(value) = value else {
            let message = format!("option \"{written}\" has no value");
            return Err(SceneError::at(&place, message));
        };
        let number = lexer.number(&value);
        let on = lexer.bytes(&value) == b"true";
        if !self.known("option", &name, &place, &NAMES)? {
            return Ok(());
        }
        match name.as_str() {
            "seed" => {
                let seed = number?;
                self.world.seed = Some(seed as i64 as u64);
            }
            "disablepixeljitter" | "forcediffuse" if on => {
                let message = format!("option \"{written}\" is ignored");
                self.diagnostics.warn(SceneError::at(&place, message));
            }
            _ => {}
        }
        Ok(())
    }

    /// Moving transforms are refused; leniently the start counts, as for pbrt's media.
    pub(super) fn not_moving(&mut self, place: &Place) -> Result<(), SceneError> {
        let [start, end] = self.state.transforms;
        if start == end {
            return Ok(());
        }
        let message = "transformations that change with time are not yet supported";
        self.diagnostics.refuse(
            SceneError::at(place, message).help("remove ActiveTransform, or give both the same"),
        )
    }
}

fn crop(params: &Params, width: u32, height: u32) -> Result<PixelBounds, SceneError> {
    let window = params.four("cropwindow", Type::Float)?;
    let pixels = params.four("pixelbounds", Type::Integer)?;
    let full = PixelBounds {
        x0: 0,
        x1: width,
        y0: 0,
        y1: height,
    };
    let (bounds, place) = match (window, pixels) {
        (None, None) => return Ok(full),
        (Some((_, place)), Some(_)) => {
            let message = "give either \"cropwindow\" or \"pixelbounds\"";
            return Err(SceneError::at(&place, message));
        }
        (Some(([x0, x1, y0, y1], place)), None) => {
            if [x0, x1, y0, y1].iter().any(|v| !(0.0..=1.0).contains(v)) {
                let message = "a crop window lies within 0 and 1";
                return Err(SceneError::at(&place, message));
            }
            let Window { x0, y0, x1, y1 } = Window::crop([width, height], [x0, x1, y0, y1]);
            (PixelBounds { x0, x1, y0, y1 }, place)
        }
        (None, Some(([x0, x1, y0, y1], place))) => {
            let edge = |at: f64, size: u32| at.clamp(0.0, f64::from(size)) as u32;
            let bounds = PixelBounds {
                x0: edge(x0, width),
                x1: edge(x1, width),
                y0: edge(y0, height),
                y1: edge(y1, height),
            };
            (bounds, place)
        }
    };
    if bounds.x0 >= bounds.x1 || bounds.y0 >= bounds.y1 {
        let message = "no pixel is left";
        return Err(SceneError::at(&place, message).help("the order is x0 x1 y0 y1"));
    }
    Ok(bounds)
}
