//! `ObjectBegin`, `ObjectEnd`, `ObjectInstance`: surfaces defined once and placed often.

use super::super::{Place, SceneError, surface};
use super::directive::At;
use super::reader::Reader;
use super::shapes::ShapeDraft;
use super::state::affine;
use super::suggest::undefined;
use super::world::Placed;

/// An object whose shapes' names are not yet looked up.
#[derive(Debug)]
pub(super) struct ObjectDraft {
    pub(super) name: String,
    pub(super) shapes: Vec<ShapeDraft>,
}

impl Reader<'_> {
    pub(super) fn object_begin(&mut self, at: &At) -> Result<(), SceneError> {
        let (name, place) = self.string(at, "an object's name")?;
        if self.objects > 0 {
            let message = "objects cannot be defined within objects";
            return Err(SceneError::at(&at.place, message));
        }
        self.attribute_begin(at, true)?;
        if let Some((_, older)) = self.world.object_names.get(&name) {
            let message = format!("object \"{name}\" is defined twice");
            return Err(SceneError::at(&place, message).note(older, "first here"));
        }
        let index = self.world.objects.len();
        self.world.object_names.insert(name.clone(), (index, place));
        self.world.objects.push(ObjectDraft {
            name,
            shapes: Vec::new(),
        });
        Ok(())
    }

    pub(super) fn object_end(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "ObjectEnd")?;
        self.restore(at, true)
    }

    /// What an object holds is in the world already, as the transformation at its definition had it; the one at the
    /// instance comes on top.
    pub(super) fn object_instance(&mut self, at: &At) -> Result<(), SceneError> {
        self.world_only(at, "ObjectInstance")?;
        let (name, place) = self.string(at, "an object's name")?;
        if self.objects > 0 {
            let message = "objects cannot be placed within objects";
            return Err(SceneError::at(&at.place, message));
        }
        let Some(&(object, _)) = self.world.object_names.get(&name) else {
            let names = self.world.object_names.keys().map(String::as_str);
            let error = undefined("object", &name, &place, names);
            return self
                .diagnostics
                .refuse(error.help("objects are defined before they are placed"));
        };
        self.not_moving(&at.place)?;
        let [object_to_world, _] = affine(&self.state.transforms[0], &at.place)?;
        self.world.placed.push(Placed::Instance(surface::Instance {
            object,
            object_to_world,
            place: at.place.clone(),
        }));
        Ok(())
    }

    /// Counts memory that a few words of a scene ask for again and again.
    pub(super) fn charge(&mut self, bytes: u64, place: &Place) -> Result<(), SceneError> {
        self.world.copied = self.world.copied.saturating_add(bytes);
        super::world::within(self.world.copied, self.limits.max_memory, place)
    }
}
