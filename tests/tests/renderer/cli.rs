//! The command line as a user meets it: the program is run, and its files, words and exit codes are looked at.
//!
//! The program is built from the host's `main.rs` as a binary of this package, whose path Cargo tells.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;
use woodcock_host::image::{Image, exr};

mod bench;
mod compare;
mod failures;
mod info;
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
mod levels;
mod renders;
#[cfg(unix)]
mod signals;
mod stopping;

fn data() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("data")
}

/// A folder of its own for one run, removed afterwards.
struct Folder(TempDir);

/// What a run left behind.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl Folder {
    fn new() -> Self {
        Self(TempDir::new().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).expect("written");
    }

    /// Everything in it, sorted: also what begins with a dot.
    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("listable");
        let mut names: Vec<_> = entries
            .map(|e| {
                e.expect("an entry")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        names
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_woodcock-under-test"));
        command.args(args).current_dir(self.0.path());
        command
    }

    fn run(&self, args: &[&str]) -> Run {
        let Output {
            status,
            stdout,
            stderr,
        } = self.command(args).output().expect("the program runs");
        let text = |bytes| String::from_utf8(bytes).expect("the program speaks UTF-8");
        let run = Run {
            code: status.code(),
            stdout: text(stdout),
            stderr: text(stderr),
        };
        let said = [run.stdout.as_str(), &run.stderr].concat();
        assert!(!said.contains("panicked"), "{args:?}: {said}");
        run
    }

    /// Runs what must succeed.
    #[track_caller]
    fn done(&self, args: &[&str]) -> Run {
        let run = self.run(args);
        assert_eq!(run.code, Some(0), "{args:?}: {}", run.stderr);
        run
    }

    fn image(&self, name: &str) -> Image {
        let bytes = std::fs::read(self.path(name)).expect("an image");
        exr::read_image(std::io::Cursor::new(bytes), 1 << 30).expect("a readable image")
    }
}

/// The bits of every channel, by name.
fn bits(image: &Image) -> Vec<(String, Vec<u32>)> {
    let mut channels: Vec<_> = image
        .channels
        .iter()
        .map(|c| {
            (
                c.name.clone(),
                c.values.iter().map(|v| v.to_bits()).collect(),
            )
        })
        .collect();
    channels.sort();
    channels
}

/// A scene with a volume file of the tests' data.
fn cloud_scene(file: &Path) -> String {
    format!(
        "LookAt 0 0.7 -5  0 0.7 0  0 1 0\nCamera \"perspective\" \"float fov\" 35\n\
         Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 30 \"string filename\" \"cloud.exr\"\n\
         Sampler \"independent\" \"integer pixelsamples\" 4\nWorldBegin\n\
         LightSource \"infinite\" \"rgb L\" [ 0.4 0.5 0.8 ]\n\
         LightSource \"distant\" \"point3 from\" [ 1 2 -1 ] \"rgb L\" [ 3 3 3 ]\n\
         MakeNamedMedium \"m\" \"string type\" \"openvdb\" \"string filename\" \"{}\"\n\
         \"rgb sigma_a\" [ 0.1 0.1 0.1 ] \"rgb sigma_s\" [ 9 9 9 ] \"float g\" 0.7\n\
         Material \"interface\"\nMediumInterface \"m\" \"\"\nShape \"sphere\" \"float radius\" 5\n",
        file.display()
    )
}

/// A small scene without files.
const FOG: &str = "LookAt 0 0 -3  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 45\n\
    Film \"rgb\" \"integer xresolution\" 32 \"integer yresolution\" 24 \"string filename\" \"fog.exr\"\n\
    Sampler \"independent\" \"integer pixelsamples\" 4\nWorldBegin\n\
    LightSource \"infinite\" \"rgb L\" [ 0.4 0.5 0.8 ]\n\
    MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [ 0.1 0.2 0.3 ] \"rgb sigma_s\" [ 2 2 2 ]\n\
    Material \"interface\"\nMediumInterface \"m\" \"\"\nShape \"sphere\" \"float radius\" 1\n";
