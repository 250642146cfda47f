//! Directives that change the current transformation.

use glam::{DMat4, DVec3};

use super::super::SceneError;
use super::directive::At;
use super::lexer::Kind;
use super::reader::Reader;
use super::state::{look_at, rotation};
use super::suggest::nearest;

impl Reader<'_> {
    pub(super) fn transformation(&mut self, at: &At, name: &str) -> Result<(), SceneError> {
        let place = &at.place;
        match name {
            "Identity" => self.state_mut().change(place, |_| DMat4::IDENTITY),
            "Translate" => {
                let by = DMat4::from_translation(self.numbers::<3>(at)?.into());
                self.state_mut().change(place, |m| m * by)
            }
            "Scale" => {
                let by = DMat4::from_cols_array(&{
                    let [x, y, z] = self.numbers::<3>(at)?;
                    [x, 0., 0., 0., 0., y, 0., 0., 0., 0., z, 0., 0., 0., 0., 1.]
                });
                self.state_mut().change(place, |m| m * by)
            }
            "Rotate" => {
                let [degrees, x, y, z] = self.numbers::<4>(at)?;
                let axis = DVec3::new(x, y, z);
                if !(axis.length() > 0.0 && axis.length().is_finite()) {
                    return Err(SceneError::at(
                        place,
                        "the axis of a rotation must not be zero",
                    ));
                }
                let by = rotation(degrees, axis);
                self.state_mut().change(place, |m| m * by)
            }
            "LookAt" => {
                let n = self.numbers::<9>(at)?;
                let v = |i: usize| DVec3::new(n[i], n[i + 1], n[i + 2]);
                let Some(by) = look_at(v(0), v(3), v(6)) else {
                    let message = "LookAt defines no direction";
                    return Err(SceneError::at(place, message).help(
                        "the eye must differ from the point looked at, and up from the line of sight",
                    ));
                };
                self.state_mut().change(place, |m| m * by)
            }
            _ => {
                self.bracket(at, Kind::Open)?;
                let by = DMat4::from_cols_array(&self.numbers::<16>(at)?);
                self.bracket(at, Kind::Close)?;
                let replace = name == "Transform";
                self.state_mut()
                    .change(place, |m| if replace { by } else { m * by })
            }
        }
    }

    pub(super) fn coordinate_system(&mut self, at: &At, name: &str) -> Result<(), SceneError> {
        let (system, place) = self.string(at, "a coordinate system")?;
        if name == "CoordinateSystem" {
            let transforms = self.state.transforms;
            self.coordinate_systems.insert(system, transforms);
            return Ok(());
        }
        match self.coordinate_systems.get(&system).copied() {
            Some(transforms) => self.state_mut().transforms = transforms,
            None => {
                let error = SceneError::at(&place, format!("no coordinate system \"{system}\""));
                let names = self.coordinate_systems.keys().map(String::as_str);
                let error = match nearest(&system, names) {
                    Some(near) => error.help(format!("did you mean \"{near}\"?")),
                    None => error.help("CoordinateSystem defines one"),
                };
                self.diagnostics.refuse(error)?;
            }
        }
        Ok(())
    }

    pub(super) fn active_transform(&mut self, at: &At) -> Result<(), SceneError> {
        let lexer = self.lexer(at.file);
        let token = lexer.next()?;
        let word = token.map(|token| lexer.bytes(&token).to_vec());
        let place = token.map_or_else(|| lexer.end(), |token| lexer.place(&token));
        self.state_mut().active = match word.as_deref() {
            Some(b"All") => [true, true],
            Some(b"StartTime") => [true, false],
            Some(b"EndTime") => [false, true],
            _ => {
                let message = "expected All, StartTime or EndTime";
                return Err(SceneError::at(&place, message));
            }
        };
        Ok(())
    }
}
