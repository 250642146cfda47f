//! Pictures and textures: where a picture lies on a surface, and what its values are.

use glam::DVec2;
use std::path::PathBuf;
use woodcock_host::bsdf::Materials;
use woodcock_host::scene::{
    self, Encoding, Files, Filter, ImageMap, Material, MaterialKind, MemoryFiles, Place,
    SceneError, Source, Wrap,
};
use woodcock_host::texture::{Pictures, Texture};
use woodcock_host::volume::Limits;
use woodcock_tests::refs::quadrature::close;

/// Three columns, two rows; 16 bits, so linear. Red tells the column, green the row from the top, blue is full.
const LEVELS: [[[u16; 3]; 3]; 2] = [
    [[0, 0, 65535], [13107, 0, 65535], [26214, 0, 65535]],
    [
        [0, 32768, 65535],
        [13107, 32768, 65535],
        [26214, 32768, 65535],
    ],
];

fn picture(levels: &[u16], width: u32, height: u32) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Sixteen);
    let bytes: Vec<u8> = levels
        .iter()
        .flat_map(|level| level.to_be_bytes())
        .collect();
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&bytes).expect("pixels");
    writer.finish().expect("written to memory");
    out
}

fn files() -> MemoryFiles {
    let levels: Vec<u16> = LEVELS.iter().flatten().flatten().copied().collect();
    MemoryFiles::new()
        .with("small.png", picture(&levels, 3, 2))
        .with("large.png", picture(&[40_000; 3 * 64 * 64], 64, 64))
        .with("text.png", "not a picture")
}

fn place() -> Place {
    let source = Source::new(
        "scene.pbrt",
        b"Texture \"t\" \"spectrum\" \"imagemap\"".to_vec(),
    );
    Place::new(&source, 8, 11)
}

fn map() -> ImageMap {
    ImageMap {
        filename: PathBuf::from("small.png"),
        filter: Filter::Point,
        wrap: Wrap::Repeat,
        encoding: None,
        scale: 1.0,
        invert: false,
        mapping: [1.0, 1.0, 0.0, 0.0],
        place: place(),
    }
}

fn ready(texture: &scene::Texture) -> Result<Texture, SceneError> {
    let files = files();
    Texture::new(
        texture,
        &mut Pictures::new(&files, Limits::default()),
        &place(),
    )
}

fn image(map: ImageMap) -> Texture {
    ready(&scene::Texture::Image(map)).expect("a readable picture")
}

fn at(texture: &Texture, u: f64, v: f64) -> [f64; 3] {
    texture.at(DVec2::new(u, v))
}

/// The value of a pixel, column and row from the top.
fn pixel(x: usize, y: usize) -> [f64; 3] {
    LEVELS[y][x].map(|level| f64::from(f32::from(level) / 65535.0))
}

#[track_caller]
fn same(got: [f64; 3], expected: [f64; 3]) {
    for (got, expected) in got.into_iter().zip(expected) {
        close("value", got, expected, 1e-7);
    }
}

#[test]
fn v_runs_upwards_and_u_to_the_right() {
    let texture = image(map());
    same(at(&texture, 0.1, 0.1), pixel(0, 1));
    same(at(&texture, 0.5, 0.1), pixel(1, 1));
    same(at(&texture, 0.9, 0.9), pixel(2, 0));
    // Edges belong to the pixel that begins there.
    same(at(&texture, 0.0, 0.0), pixel(0, 1));
    same(at(&texture, 0.0, 0.5), pixel(0, 0));
}

#[test]
fn bilinear_values_are_exact_at_centres_and_linear_between() {
    let mut described = map();
    described.filter = Filter::Bilinear;
    described.wrap = Wrap::Clamp;
    let texture = image(described);
    for (x, y) in [(0, 0), (1, 0), (2, 1)] {
        let (u, v) = ((x as f64 + 0.5) / 3.0, 1.0 - (y as f64 + 0.5) / 2.0);
        same(at(&texture, u, v), pixel(x, y));
    }
    // Red is 0.2 per column, green falls by a half from the bottom to the top row.
    for i in 0..=20 {
        let t = f64::from(i) / 20.0;
        let expected = [0.2 + 0.2 * t, 32768.0 / 65535.0 * (1.0 - t), 1.0];
        same(at(&texture, (1.5 + t) / 3.0, (0.5 + t) / 2.0), expected);
    }
}

#[test]
fn edges_repeat_end_or_go_on() {
    let wrapped = |wrap, filter| {
        let mut described = map();
        (described.wrap, described.filter) = (wrap, filter);
        image(described)
    };
    let repeat = wrapped(Wrap::Repeat, Filter::Point);
    for (u, v) in [(1.1, 0.1), (-0.9, -0.9), (1000.1, 7.1), (-3.9, 0.1)] {
        same(at(&repeat, u, v), pixel(0, 1));
    }
    let clamp = wrapped(Wrap::Clamp, Filter::Point);
    same(at(&clamp, -5.0, 0.1), pixel(0, 1));
    same(at(&clamp, 1.0, 1.0), pixel(2, 0));
    same(at(&clamp, 1e300, -1e300), pixel(2, 1));
    let black = wrapped(Wrap::Black, Filter::Point);
    same(at(&black, 0.1, 0.1), pixel(0, 1));
    same(at(&black, 1.0, 0.1), [0.0; 3]);
    same(at(&black, 0.1, -1e-9), [0.0; 3]);
    // Blue is full everywhere: between the outermost centre and half a pixel beyond the edge black fades in.
    let black = wrapped(Wrap::Black, Filter::Bilinear);
    for (u, v, expected) in [
        (0.0, 0.5, 0.5),
        (0.0, 0.0, 0.25),
        (-0.125, 0.5, 0.125),
        (-0.2, 0.5, 0.0),
    ] {
        close("fading", at(&black, u, v)[2], expected, 1e-12);
    }
    // The first and the last column are neighbours.
    let repeat = wrapped(Wrap::Repeat, Filter::Bilinear);
    for u in [0.0, 1.0, -2.0, -1e-20] {
        close("seam", at(&repeat, u, 0.25)[0], 0.2, 1e-6);
    }
    let texture = wrapped(Wrap::Repeat, Filter::Bilinear);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e308, -1e308] {
        for texture in [&texture, &black, &clamp] {
            for value in [at(texture, bad, 0.3), at(texture, 0.3, bad)] {
                assert!(
                    value.iter().all(|x| (0.0..=1.0).contains(x)),
                    "{bad}: {value:?}"
                );
            }
        }
    }
}

#[test]
fn mapping_scale_and_inversion_are_pbrts() {
    let mut described = map();
    described.mapping = [0.5, -1.0, 0.25, 1.0];
    let texture = image(described);
    // (s, t) = (0.5 · 0.9 + 0.25, 1 − 0.9)
    same(at(&texture, 0.9, 0.9), pixel(2, 1));
    let mut described = map();
    described.scale = 0.5;
    described.invert = true;
    let texture = image(described.clone());
    same(at(&texture, 0.5, 0.1), pixel(1, 1).map(|x| 1.0 - 0.5 * x));
    described.scale = 4.0;
    same(at(&image(described.clone()), 0.5, 0.1), [0.2, 0.0, 0.0]);
    described.invert = false;
    described.encoding = Some(Encoding::Gamma(2.0));
    same(
        at(&image(described), 0.5, 0.1),
        pixel(1, 1).map(|x| 4.0 * x * x),
    );
}

#[test]
fn products_multiply_colour_by_colour_however_deep() {
    let mut texture = scene::Texture::Image(map());
    for _ in 0..1000 {
        let half = scene::Texture::Constant([1.0, 0.5, 2.0]);
        let double = scene::Texture::Constant([1.0, 2.0, 0.5]);
        let one = scene::Texture::Scale(Box::new(half), Box::new(double));
        texture = scene::Texture::Scale(Box::new(texture), Box::new(one));
    }
    let tint = scene::Texture::Constant([0.5, 0.25, 1.0]);
    texture = scene::Texture::Scale(Box::new(tint), Box::new(texture));
    let texture = ready(&texture).expect("valid");
    let [r, g, b] = pixel(2, 1);
    same(at(&texture, 0.9, 0.1), [0.5 * r, 0.25 * g, b]);
}

fn reflectance(
    texture: scene::Texture,
    files: &dyn Files,
    memory: u64,
) -> Result<Materials, SceneError> {
    let material = Material {
        kind: MaterialKind::Diffuse {
            reflectance: texture,
        },
        place: place(),
    };
    Materials::new(&[material], files, &Limits { max_memory: memory })
}

#[test]
fn reflectances_beyond_one_are_refused_with_their_pixel() {
    let files = files();
    let tinted = |map: ImageMap, tint: [f64; 3]| {
        let tint = scene::Texture::Constant(tint);
        scene::Texture::Scale(Box::new(scene::Texture::Image(map)), Box::new(tint))
    };
    let refused = |texture: scene::Texture, says: &str| {
        let error = reflectance(texture, &files, 1 << 20).expect_err("refused");
        assert!(error.to_string().starts_with("scene.pbrt:1:9: "), "{error}");
        assert!(error.to_string().contains(says), "{error}");
    };
    let allowed = |texture| assert!(reflectance(texture, &files, 1 << 20).is_ok());
    allowed(scene::Texture::Image(map()));
    // Blue is 1 already, red at most 0.4 in column 2: each colour has its own bound.
    refused(tinted(map(), [1.0, 1.0, 1.01]), "small.png: pixel (0, 0)");
    refused(tinted(map(), [2.6, 1.0, 1.0]), "small.png: pixel (2, 0)");
    refused(tinted(map(), [1.0, 2.1, 1.0]), "small.png: pixel (0, 1)");
    refused(tinted(map(), [-0.1, 1.0, 1.0]), "small.png: pixel (2, 0)");
    allowed(tinted(map(), [2.4, 1.9, 1.0]));
    let mut scaled = map();
    scaled.scale = 1.1;
    refused(scene::Texture::Image(scaled.clone()), "1.1");
    allowed(tinted(scaled.clone(), [0.9; 3]));
    scaled.invert = true;
    allowed(scene::Texture::Image(scaled.clone()));
    scaled.scale = -0.5;
    refused(scene::Texture::Image(scaled), "1.2");
    let mut broken = map();
    broken.mapping[2] = f64::NAN;
    refused(scene::Texture::Image(broken), "not finite");
}

#[test]
fn files_are_refused_at_the_texture_and_held_once() {
    let files = files();
    let of = |name: &str| {
        let mut described = map();
        described.filename = PathBuf::from(name);
        scene::Texture::Image(described)
    };
    for (name, says) in [("text.png", "neither"), ("missing.png", "cannot be read")] {
        let error = reflectance(of(name), &files, 1 << 20).expect_err("refused");
        assert!(error.to_string().starts_with("scene.pbrt:1:9: "), "{error}");
        assert!(
            error.to_string().contains(name) && error.to_string().contains(says),
            "{error}"
        );
    }
    // 64 × 64 pixels take 48 KiB, and 32 KiB more while they are decoded.
    let product = |a, b| scene::Texture::Scale(Box::new(a), Box::new(b));
    assert!(reflectance(of("large.png"), &files, 79 << 10).is_err());
    assert!(reflectance(of("large.png"), &files, 80 << 10).is_ok());
    let twice = product(of("large.png"), of("large.png"));
    assert!(reflectance(twice.clone(), &files, 80 << 10).is_ok());
    // With another encoding it is another picture.
    let mut other = map();
    other.filename = PathBuf::from("large.png");
    other.encoding = Some(Encoding::Srgb);
    let other = scene::Texture::Image(other);
    assert!(reflectance(product(twice.clone(), other.clone()), &files, 127 << 10).is_err());
    assert!(reflectance(product(twice, other), &files, 128 << 10).is_ok());
}
