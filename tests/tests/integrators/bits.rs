//! What must not change a bit of what scalar integrators do: threads, passes, and what else is rendered.
//!
//! Of a crop window, path tracing and the rungs below it make the bits of the whole picture. Bidirectional paths begin in
//! the window alone, and so does the light that lands there: the part has its own noise, and the same mean.

use std::ops::Range;

use super::pairwise::depth;
use woodcock_host::film::{Film, Window};
use woodcock_host::integrator::Integrator;
use woodcock_host::world;
use woodcock_tests::gallery::{self, Exhibit, SIDE, replan};
use woodcock_tests::pictures::{Studio, try_stage};
use woodcock_tests::replicates::Replicates;

/// The exhibits that reach most of the code between them.
fn some() -> Vec<Exhibit> {
    let names = [
        "a caustic of glass in fog",
        "metals under a picture",
        "media that overlap",
        "a lens before fog",
    ];
    let all = gallery::all();
    let found: Vec<_> = all
        .into_iter()
        .filter(|e| names.contains(&e.name))
        .collect();
    assert_eq!(found.len(), names.len());
    found
}

fn film(studio: &Studio, threads: usize, passes: &[Range<u32>]) -> Film {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("threads");
    let picture = pool.install(|| studio.shoot_passes(passes));
    picture.assert_sound("bits").film.clone()
}

#[test]
fn threads_and_passes_do_not_matter() {
    for exhibit in some() {
        for integrator in Integrator::ALL {
            let studio = exhibit.stage(integrator, 5000);
            let name = format!("{}, {}", exhibit.name, integrator.name());
            let whole = film(&studio, 1, std::slice::from_ref(&(0..5)));
            let lit = whole.pixels().any(|(.., p)| p.mean()[1] > 0.0);
            let direct = integrator == Integrator::Transmittance;
            assert!(lit || direct, "{name} is black");
            assert!(
                whole == film(&studio, 2, std::slice::from_ref(&(0..5))),
                "{name}: two threads"
            );
            let singles: Vec<_> = (0..5).map(|i| i..i + 1).collect();
            assert!(whole == film(&studio, 2, &singles), "{name}: five passes");
            assert!(
                whole == film(&studio, 3, &[3..5, 0..1, 1..3]),
                "{name}: other passes"
            );
            let other = film(&studio, 1, std::slice::from_ref(&(5..10)));
            assert!(whole != other || !lit, "{name}: other samples are others");
        }
    }
}

fn cropped(exhibit: &Exhibit, integrator: Integrator, seed: u64) -> Studio {
    let options = world::Options {
        crop: Some([0.25, 0.75, 0.5, 1.0]),
        ..world::Options::default()
    };
    let studio = try_stage(&exhibit.text(), exhibit.files.clone(), &options).expect("a crop");
    replan(studio, integrator, seed, exhibit.max_depth)
}

#[test]
fn a_crop_is_part_of_the_whole() {
    for exhibit in some() {
        for integrator in [
            Integrator::Path,
            Integrator::Single,
            Integrator::Transmittance,
        ] {
            let whole = exhibit.stage(integrator, 5010).shoot_range(0..3).film;
            let part = cropped(&exhibit, integrator, 5010).shoot_range(0..3).film;
            let window = part.window();
            assert_eq!(window.pixels(), u64::from(SIDE / 2).pow(2));
            let inside = whole.pixels().filter(|(x, y, _)| window.contains(*x, *y));
            let of_whole: std::collections::BTreeMap<_, _> =
                inside.map(|(x, y, pixel)| ((x, y), pixel)).collect();
            for (x, y, pixel) in part.pixels() {
                let name = format!("{}, {}: ({x}, {y})", exhibit.name, integrator.name());
                assert!(of_whole.get(&(x, y)) == Some(&pixel), "{name}");
            }
        }
    }
}

#[test]
fn a_crop_of_light_paths_has_the_mean_of_the_whole() {
    // Caustics are left out: path tracing is too noisy there.
    for exhibit in &some()[1..] {
        let window = Window::crop([SIDE; 2], [0.25, 0.75, 0.5, 1.0]);
        let path = exhibit.stage(Integrator::Path, 5020);
        let path = Replicates::of_part(exhibit.name, &path, 2 * depth(Integrator::Path), window);
        for (integrator, seed) in [(Integrator::Bdpt, 5021), (Integrator::Mlt, 5022)] {
            let part = cropped(exhibit, integrator, seed);
            let part = Replicates::of(exhibit.name, &part, depth(integrator));
            let name = format!("{}, a crop by {}", exhibit.name, integrator.name());
            part.assert_same(&name, &path, 0.015);
        }
    }
}
