//! The stack of files being read, and everything that lasts longer than a directive.

use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::super::{Files, MaterialKind, Options, Place, Scene, SceneError, Source, Texture};
use super::diagnostics::Diagnostics;
use super::lexer::Lexer;
use super::state::{State, Transforms};
use super::world::World;

/// Most files open at once.
const DEEPEST: usize = 64;
/// Most files read in all: a few that include each other twice would otherwise double without end.
const MOST_FILES: usize = 1 << 16;
/// Sources beyond this are not kept for the places of a finished scene.
const KEPT_SOURCE: usize = 1 << 20;

/// A file in the middle of being read.
#[derive(Debug)]
struct Open {
    lexer: Lexer,
    path: PathBuf,
    /// `Import` keeps what the file does to the state from leaking out.
    restore: Option<Restore>,
}

#[derive(Debug)]
struct Restore {
    state: Arc<State>,
    depth: usize,
}

/// A saved state with the directive that saved it.
#[derive(Debug)]
pub(super) struct Saved {
    pub(super) state: Arc<State>,
    pub(super) place: Place,
    /// By `ObjectBegin`, not by `AttributeBegin`.
    pub(super) object: bool,
}

/// Reads a scene file.
pub(super) struct Reader<'a> {
    pub(super) files: &'a dyn Files,
    pub(super) limits: Options,
    /// Directory of the main file: what all paths are relative to.
    directory: PathBuf,
    main: String,
    open: Vec<Open>,
    opened: usize,
    text: u64,
    hash: u64,
    pub(super) state: Arc<State>,
    pub(super) saved: Vec<Saved>,
    /// How many of the saved states are objects'.
    pub(super) objects: usize,
    pub(super) coordinate_systems: HashMap<String, Transforms>,
    /// Whether `WorldBegin` has been seen.
    pub(super) in_world: bool,
    pub(super) diagnostics: Diagnostics,
    pub(super) world: World,
}

impl<'a> Reader<'a> {
    pub(super) fn new(path: &Path, files: &'a dyn Files, limits: Options) -> Self {
        Self {
            files,
            limits,
            directory: path.parent().unwrap_or(Path::new("")).to_owned(),
            main: path.display().to_string(),
            open: Vec::new(),
            opened: 0,
            text: 0,
            hash: 0xcbf2_9ce4_8422_2325,
            state: Arc::default(),
            saved: Vec::new(),
            objects: 0,
            coordinate_systems: HashMap::new(),
            in_world: false,
            diagnostics: Diagnostics::new(limits.lenient),
            world: World::default(),
        }
    }

    pub(super) fn open_main(&mut self, path: &Path) -> Result<(), SceneError> {
        let bytes = self
            .load(path)
            .map_err(|reason| SceneError::of_file(&self.main, reason))?;
        let lexer = Lexer::new(Source::new(&self.main, bytes))?;
        self.open.push(Open {
            lexer,
            path: path.to_owned(),
            restore: None,
        });
        Ok(())
    }

    /// Continues in another file; `place` names it.
    pub(super) fn include(
        &mut self,
        name: &str,
        place: &Place,
        import: bool,
    ) -> Result<(), SceneError> {
        let path = self.resolve(name);
        if self.open.iter().any(|open| open.path == path) {
            let message = format!("{} includes itself", path.display());
            return Err(SceneError::at(place, message));
        }
        if self.open.len() == DEEPEST {
            let message = format!("files are included more than {DEEPEST} deep");
            return Err(SceneError::at(place, message));
        }
        self.opened += 1;
        if self.opened > MOST_FILES {
            let message = format!("more than {MOST_FILES} files are included");
            return Err(SceneError::at(place, message));
        }
        let bytes = self.load_at(&path, place)?;
        let restore = import.then(|| Restore {
            state: Arc::clone(&self.state),
            depth: self.saved.len(),
        });
        let lexer = Lexer::new(Source::new(path.display().to_string(), bytes))?;
        self.open.push(Open {
            lexer,
            path,
            restore,
        });
        Ok(())
    }

    /// A path as the scene means it.
    pub(super) fn resolve(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    /// Reads a file that the scene names at `place`.
    pub(super) fn load_at(&mut self, path: &Path, place: &Place) -> Result<Vec<u8>, SceneError> {
        self.load(path).map_err(|reason| {
            let message = format!("cannot read {}: {reason}", path.display());
            SceneError::at(place, message)
                .help("paths are relative to the directory of the main scene file")
        })
    }

    fn load(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let left = self.limits.max_memory.saturating_sub(self.text);
        let too_much = || {
            let most = self.limits.max_memory;
            format!("the scene's files exceed the limit of {most} bytes")
        };
        let mut bytes = self.files.read(path).map_err(|e| e.to_string())?;
        if path.extension().is_some_and(|e| e == "gz") {
            let mut text = Vec::new();
            flate2::read::MultiGzDecoder::new(bytes.as_slice())
                .take(left.saturating_add(1))
                .read_to_end(&mut text)
                .map_err(|e| format!("damaged gzip data: {e}"))?;
            bytes = text;
        }
        if bytes.len() as u64 > left {
            return Err(too_much());
        }
        self.text += bytes.len() as u64;
        for &byte in &bytes {
            self.hash = (self.hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
        Ok(bytes)
    }

    /// Takes directives from the innermost file until all are read.
    pub(super) fn run(&mut self) -> Result<(), SceneError> {
        while let Some(mut open) = self.open.pop() {
            match open.lexer.next()? {
                Some(token) => {
                    // An `Include` pushes its file above this one, so that goes back first.
                    let below = self.open.len();
                    self.open.push(open);
                    self.directive(below, &token)?;
                }
                None => self.close(open)?,
            }
        }
        Ok(())
    }

    /// The lexer of the file that a directive stands in.
    pub(super) fn lexer(&mut self, file: usize) -> &mut Lexer {
        &mut self.open[file].lexer
    }

    /// The lexer of the file that a directive stands in, with the diagnostics beside it.
    pub(super) fn lexer_and_diagnostics(&mut self, file: usize) -> (&mut Lexer, &mut Diagnostics) {
        (&mut self.open[file].lexer, &mut self.diagnostics)
    }

    /// States saved outside of the innermost imported file, which it may not restore.
    pub(super) fn protected(&self) -> usize {
        let imports = self.open.iter().rev();
        imports
            .filter_map(|open| open.restore.as_ref())
            .map(|restore| restore.depth)
            .next()
            .unwrap_or(0)
    }

    fn close(&mut self, open: Open) -> Result<(), SceneError> {
        let Some(restore) = open.restore else {
            return Ok(());
        };
        if self.saved.len() > restore.depth {
            return Err(self.unclosed());
        }
        self.state = restore.state;
        Ok(())
    }

    /// The innermost saved state is never restored.
    fn unclosed(&self) -> SceneError {
        match self.saved.last() {
            Some(saved) => {
                let name = if saved.object { "Object" } else { "Attribute" };
                let message = format!("this {name}Begin has no {name}End");
                SceneError::at(&saved.place, message)
            }
            None => SceneError::of_file(&self.main, "the scene ends within a block"),
        }
    }

    pub(super) fn finish(mut self) -> Result<Scene, SceneError> {
        if !self.saved.is_empty() {
            return Err(self.unclosed());
        }
        if !self.in_world {
            let message = "the scene has no WorldBegin";
            return Err(SceneError::of_file(&self.main, message));
        }
        let mut scene = self
            .world
            .finish(&mut self.diagnostics, self.limits.max_memory)?;
        scene.warnings = self.diagnostics.finish(&self.main);
        scene.source_hash = self.hash;
        scene.each_place(|place| {
            if place.source().bytes().len() > KEPT_SOURCE {
                *place = place.detached();
            }
        });
        Ok(scene)
    }
}

impl Scene {
    fn each_place(&mut self, mut change: impl FnMut(&mut Place)) {
        self.film.place.iter_mut().for_each(&mut change);
        self.camera.place.iter_mut().for_each(&mut change);
        self.media.iter_mut().for_each(|m| change(&mut m.place));
        self.boundaries
            .iter_mut()
            .for_each(|b| change(&mut b.place));
        let objects = self.objects.iter_mut().flat_map(|o| &mut o.surfaces);
        for surface in self.surfaces.iter_mut().chain(objects) {
            change(&mut surface.place);
        }
        for instance in &mut self.instances {
            change(&mut instance.place);
        }
        for material in &mut self.materials {
            change(&mut material.place);
            if let MaterialKind::Diffuse { reflectance } = &mut material.kind {
                each_image(reflectance, &mut change);
            }
        }
        for light in &mut self.lights {
            change(light.place_mut());
        }
    }
}

fn each_image(texture: &mut Texture, change: &mut impl FnMut(&mut Place)) {
    match texture {
        Texture::Constant(_) => {}
        Texture::Scale(a, b) => {
            each_image(a, change);
            each_image(b, change);
        }
        Texture::Image(image) => change(&mut image.place),
    }
}
