//! Nothing that a file contains breaks the pbrt reader: every directive, a million blocks, mutations.

use std::path::Path;
use std::time::{Duration, Instant};

use woodcock_host::scene::{MemoryFiles, Options, Scene, SceneError, read};

fn read_with(files: MemoryFiles, lenient: bool) -> Result<Scene, SceneError> {
    let options = Options {
        lenient,
        max_memory: 1 << 26,
    };
    read(Path::new("s.pbrt"), &files, &options)
}

fn files(text: impl Into<Vec<u8>>) -> MemoryFiles {
    MemoryFiles::new().with("s.pbrt", text)
}

/// Mentions every directive, most parameter types and most kinds of values.
const SEED: &str = r#"Option "seed" 3 Option "disablepixeljitter" false ColorSpace "srgb"
Identity Translate 1 2 3 Scale 1 2 1 Rotate 30 1 2 3 LookAt 0 0 -5 0 0 0 0 1 0
CoordinateSystem "here" CoordSysTransform "here" ActiveTransform All TransformTimes 0 1
Transform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1] ConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1]
Camera "perspective" "float fov" [45] Film "rgb" "integer xresolution" 64 "string filename" "a\"b"
Sampler "zsobol" "integer pixelsamples" [16] PixelFilter "box" Integrator "volpath" "integer maxdepth" 9
Accelerator "bvh" "integer maxnodeprims" 4 WorldBegin # comment
MakeNamedMedium "g" "string type" "uniformgrid" "integer nx" 2 "float density" [0 .5]
    "point3 p0" [0 0 0] "spectrum sigma_s" [400 1 500 2 700 1.5] "float g" -0.3
MakeNamedMedium "v" "string type" "openvdb" "string filename" "a.vdb" "string phase" "rayleigh"
AttributeBegin Attribute "light" "float scale" 2 LightSource "distant" "point3 from" [1 2 3]
    LightSource "infinite" "blackbody L" 5000 MediumInterface "g" "v" Material "interface"
    ReverseOrientation Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2]
    Shape "plymesh" "string filename" "t.ply" AttributeEnd TransformBegin TransformEnd
MakeNamedMaterial "i" "string type" "interface" NamedMaterial "i" MediumInterface "v" Shape "sphere"
Include "b.pbrt" Import "b.pbrt"
MakeNamedMedium "r" "string type" "rgbgrid" "rgb sigma_a" [1 2 3] "rgb Le" [1 1 1] "float Lescale" 2
MakeNamedMedium "c" "string type" "cloud" "float density" 2 "string phase" "twolobe" "float g" .5 "float g2" -.5 "float share" 1
MakeNamedMedium "n" "string type" "nanovdb" "string filename" "a.vdb" "float Lescale" 3 "float temperaturescale" 4
MakeNamedMedium "w" "string type" "vol" "string filename" "a.vdb" "string phase" "droplets" "float diameter" 9
Texture "f" "float" "constant" "float value" .3 Texture "a" "spectrum" "imagemap" "string filename" "x.png" "string wrap" "clamp"
Texture "b" "spectrum" "scale" "texture tex" "a" "texture scale" "f" Material "diffuse" "texture reflectance" "b"
AttributeBegin AreaLightSource "diffuse" "rgb L" [1 2 3] "bool twosided" "true" "float power" 3
    Shape "disk" "float innerradius" .5 AttributeEnd
Scale -1 1 1 Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0] "normal N" [0 0 1 0 0 1 0 0 1 0 0 1]
MakeNamedMaterial "g" "string type" "dielectric" "spectrum eta" "glass-BK7" "texture roughness" "f" NamedMaterial "g"
Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "point2 uv" [0 0 1 0 1 1] Material "conductor" "rgb reflectance" [.5 .6 .7]
AttributeBegin ObjectBegin "o" Translate 1 0 0 NamedMaterial "i" MediumInterface "g" "" Shape "plymesh" "string filename" "t.ply"
ObjectEnd AttributeEnd ObjectInstance "o" Scale 1 2 3 ObjectInstance "o" Material "thindielectric" "float eta" 1.3
LightSource "point" "float power" 3 LightSource "spot" "float coneangle" 40 "point3 to" [1 2 3]
LightSource "infinite" "string filename" "x.png" "float illuminance" 3 LightSource "goniometric" "string filename" "x.png"
"#;

/// Those that are refused as a whole.
const REFUSED: &str = r#"Texture "d" "spectrum" "dots" Material "mix" "texture amount" "t" Shape "cylinder" "float zmin" 1
LightSource "projection" "string filename" "x.png" Shape "curve" "point2 uv" [1 2]
"#;

fn seed_files(scene: impl Into<Vec<u8>>, ply: impl Into<Vec<u8>>) -> MemoryFiles {
    let included = "Translate 1 0 0 Shape \"sphere\" \"float radius\" 2";
    files(scene)
        .with("a.vdb", "")
        .with("x.png", "")
        .with("b.pbrt", included)
        .with("t.ply", ply)
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
    0 0 0 1 0 0 0 1 0 3 0 1 2\n";

#[test]
fn all_directives_are_understood_or_refused_by_name() {
    let scene = match read_with(seed_files(SEED, PLY), false) {
        Ok(scene) => scene,
        Err(error) => panic!("{}", error.report()),
    };
    assert_eq!(scene.boundaries.len(), 7);
    assert_eq!(scene.surfaces.len(), 3);
    assert_eq!((scene.lights.len(), scene.instances.len()), (6, 2));
    let all = format!("{SEED}{REFUSED}");
    let lenient = read_with(seed_files(all.as_str(), PLY), true).expect("lenient");
    for warning in &lenient.warnings {
        assert!(!warning.message().contains("directive"), "{warning}");
    }
}

#[test]
fn a_million_blocks_are_only_a_loop() {
    let open = "AttributeBegin Translate 1 0 0 ".repeat(1_000_000);
    let error = read_with(files(format!("WorldBegin {open}")), false);
    let error = error.map(|_| ()).expect_err("never closed");
    assert!(error.message().contains("no AttributeEnd"), "{error}");
    let close = "AttributeEnd ".repeat(1_000_000);
    let open = "AttributeBegin ".repeat(1_000_000);
    read_with(files(format!("WorldBegin {open}{close}")), false).expect("balanced");
    let brackets = format!(
        "WorldBegin Shape \"sphere\" \"float radius\" {}",
        "[".repeat(1_000_000)
    );
    assert!(read_with(files(brackets), false).is_err());
    let parameters = "\"float x\" 1 ".repeat(1_000_000);
    let scene = format!("WorldBegin Shape \"sphere\" {parameters}");
    assert!(read_with(files(scene), true).is_err());
}

/// splitmix64: a fixed sequence, so that a failure repeats.
struct Mutator(u64);

impl Mutator {
    fn next(&mut self, below: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % below.max(1) as u64) as usize
    }

    fn mutate(&mut self, bytes: &mut Vec<u8>) {
        const PIECES: [&[u8]; 16] = [
            b"[",
            b"]",
            b"\"",
            b"\\",
            b"\n",
            b"#",
            b"nan",
            b"-1",
            b"1e308",
            b"99999999999",
            b"AttributeEnd ",
            b"Include \"s.pbrt\" ",
            b"\"float g\" ",
            b"\xff",
            b"0 ",
            b"WorldBegin ",
        ];
        for _ in 0..=self.next(4) {
            let at = self.next(bytes.len());
            match self.next(5) {
                0 => bytes.truncate(at),
                1 => drop(bytes.drain(at..(at + self.next(20)).min(bytes.len()))),
                2 => {
                    let piece = PIECES[self.next(PIECES.len())];
                    bytes.splice(at..at, piece.iter().copied());
                }
                3 => {
                    let to = self.next(bytes.len());
                    let part = bytes[at.min(to)..at.max(to)].to_vec();
                    bytes.splice(at..at, part.into_iter().take(300));
                }
                _ => {
                    if let Some(byte) = bytes.get_mut(at) {
                        *byte = self.next(256) as u8;
                    }
                }
            }
        }
    }
}

#[test]
fn mutated_scenes_neither_panic_nor_hang() {
    let mut mutator = Mutator(1);
    let seed = format!("{SEED}{REFUSED}");
    let (mut accepted, mut rejected) = (0, 0);
    for round in 0..20_000 {
        let mut scene = seed.clone().into_bytes();
        let mut ply = PLY.as_bytes().to_vec();
        if round % 4 == 0 {
            mutator.mutate(&mut ply);
        } else {
            mutator.mutate(&mut scene);
        }
        let start = Instant::now();
        match read_with(seed_files(scene, ply), round % 2 == 0) {
            Ok(scene) => {
                accepted += 1;
                scene
                    .warnings
                    .iter()
                    .for_each(|w| assert!(!w.report().is_empty()));
            }
            Err(error) => {
                rejected += 1;
                assert!(!error.report().is_empty());
            }
        }
        assert!(
            start.elapsed() < Duration::from_secs(20),
            "round {round} hangs"
        );
    }
    // Both outcomes must be common, or the mutations test only one path.
    assert!(accepted > 500 && rejected > 500, "{accepted} {rejected}");
}
