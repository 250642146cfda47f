//! `AreaLightSource`: what makes shapes shine.

use std::sync::Arc;

use super::super::SceneError;
use super::directive::At;
use super::lights::{emitted, positive};
use super::param::Type;
use super::reader::Reader;
use super::state::AreaLight;

impl Reader<'_> {
    pub(super) fn area_light_source(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "AreaLightSource")?;
        let inherited = self.state.inherited.light.clone();
        let (ty, place, params) = self.typed(at, "AreaLightSource", inherited)?;
        if !self.known("area light", &ty, &place, &["diffuse"])? {
            return Ok(());
        }
        if let Some(param) = params.find("filename", &[Type::String])? {
            let instead = "give one radiance: \"rgb L\" [ r g b ]";
            self.diagnostics.refuse(params.not_yet(param, instead))?;
        }
        let light = AreaLight {
            radiance: emitted(&params, "L", 1.0, &mut self.diagnostics)?,
            two_sided: params.boolean("twosided")?.unwrap_or(false),
            power: positive(&params, "power")?,
            place: at.place.clone(),
        };
        params.finish(&mut self.diagnostics)?;
        self.state_mut().light = Some(Arc::new(light));
        Ok(())
    }
}
