//! Lanes against scalars, bit by bit: operations, bundles of rays, whole paths.
//!
//! The strongest and steadiest test of all: no tolerance, no statistics. Modules hold the operations, the formulas
//! made of them, and the bundles. Beside them stand a few exact numbers, pinned ([`stability`]).
#![forbid(unsafe_code)]

use woodcock_core::path::{Counts, PathSample};
use woodcock_core::stream::Key;
use woodcock_packet::trace::PathRequest;
use woodcock_tests::scenes::{self, SIDE, Traced};

mod bundles;
mod formulas;
mod operations;
mod stability;

/// Some paths of each pixel.
fn requests(samples: u32) -> Vec<PathRequest> {
    let pixels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y)));
    pixels
        .flat_map(|(x, y)| {
            (0..samples).map(move |sample| PathRequest {
                x,
                y,
                key: Key {
                    seed: 5,
                    pixel: y * SIDE + x,
                    sample,
                },
            })
        })
        .collect()
}

/// Counts that do not depend on how lanes were filled.
fn events(counts: &Counts) -> [u64; 7] {
    [
        counts.paths,
        counts.tentative_collisions,
        counts.real_collisions,
        counts.null_collisions,
        counts.lookups,
        counts.majorant_cells,
        counts.majorant_violations,
    ]
}

fn bits(sample: &PathSample) -> [u32; 4] {
    let [r, g, b] = sample.radiance;
    [r, g, b, sample.alpha].map(f32::to_bits)
}

fn equal(name: &str, scene: &dyn Traced) {
    let requests = requests(8);
    let mut scalar_counts = Counts::default();
    let scalar: Vec<PathSample> = requests
        .iter()
        .map(|&r| scene.in_scalars(r, &mut scalar_counts))
        .collect();
    let packet = |requests: &[PathRequest]| {
        let mut landed = vec![None; requests.len()];
        let counts = scene.in_packets(requests, &mut |i, sample| {
            assert!(
                landed[i].replace(sample).is_none(),
                "{name}: {i} lands twice"
            )
        });
        let landed: Vec<PathSample> = landed
            .into_iter()
            .map(|s| s.expect("every path lands"))
            .collect();
        (landed, counts)
    };
    let (wide, wide_counts) = packet(&requests);
    for (i, (one, other)) in scalar.iter().zip(&wide).enumerate() {
        assert_eq!(
            bits(one),
            bits(other),
            "{name}, path {i}: {one:?} and {other:?}"
        );
    }
    assert_eq!(events(&scalar_counts), events(&wide_counts), "{name}");
    assert_eq!(scalar_counts.majorant_violations, 0, "{name}");
    for counts in [&scalar_counts, &wide_counts] {
        assert!(counts.busy_lanes <= counts.lanes, "{name}: {counts:?}");
    }
    // Whatever else is requested: few paths, in another order, give the same.
    for count in [0, 1, 7, 8, 9, 100] {
        let picked: Vec<usize> = (0..count)
            .map(|i| (i * 733 + 91) % requests.len())
            .collect();
        let few: Vec<PathRequest> = picked.iter().map(|&i| requests[i]).collect();
        for (sample, &i) in packet(&few).0.iter().zip(&picked) {
            assert_eq!(
                bits(sample),
                bits(&scalar[i]),
                "{name}, path {i} among {count}"
            );
        }
    }
    // Something happened: paths that met the medium, finite light, differing values.
    let touched = scalar.iter().filter(|s| s.alpha > 0.0).count();
    assert!(
        touched > scalar.len() / 10,
        "{name}: {touched} paths met anything"
    );
    let finite = scalar
        .iter()
        .flat_map(|s| s.radiance)
        .all(|r| r.is_finite() && r >= 0.0);
    assert!(finite, "{name}: radiance that is none");
    let lit = scalar.iter().filter(|s| s.radiance[1] > 0.0).count();
    let endless = name == "fog without an end";
    assert!(
        if endless {
            lit == 0
        } else {
            // Faint shadow rays are traced by chance.
            lit > scalar.len() / 50
        },
        "{name}: {lit} paths brought light"
    );
}

#[test]
fn whole_paths_have_the_bits_of_scalar_ones() {
    let mut compared = 0;
    scenes::each(&mut |name, scene| {
        equal(name, scene);
        compared += 1;
    });
    assert_eq!(compared, 17);
}

/// The comparison can fail: another key is another path.
#[test]
fn other_keys_are_other_paths() {
    scenes::each(&mut |name, scene| {
        let mut counts = Counts::default();
        let mut different = 0;
        for request in requests(1) {
            let moved = PathRequest {
                key: Key {
                    seed: 6,
                    ..request.key
                },
                ..request
            };
            let mut run = |r| bits(&scene.in_scalars(r, &mut counts));
            different += u32::from(run(request) != run(moved));
        }
        // Where every path brings the same, keys cannot tell.
        let constant = ["white furnace ball", "fog without an end"].contains(&name);
        assert!(
            different > 25 || constant,
            "{name}: {different} paths differ"
        );
    });
}

/// In the white furnace every path brings exactly the sky: albedo one, analog flights, no roulette.
#[test]
fn every_path_of_the_furnace_is_white() {
    let mut landed = 0;
    scenes::each(&mut |name, scene| {
        if name != "white furnace ball" {
            return;
        }
        scene.in_packets(&requests(16), &mut |_, sample| {
            assert_eq!(sample.radiance, scene.environment());
            landed += 1;
        });
    });
    assert_eq!(landed, SIDE * SIDE * 16);
}

/// Where a cloud is known to be alone, rays set out from where the last one ended instead of being placed anew: the same
/// paths but for roundings, which now and then turn a decision.
#[test]
fn a_cloud_alone_has_the_same_paths() {
    const ALONE: &str = ", known to be alone";
    let mut found = std::collections::BTreeMap::new();
    scenes::each(&mut |name, scene| {
        let requests = requests(8);
        let mut samples = vec![PathSample::default(); requests.len()];
        scene.in_packets(&requests, &mut |i, sample| samples[i] = sample);
        found.insert(name.to_owned(), samples);
    });
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-3 * a.abs();
    let same = |(a, b): &(&PathSample, &PathSample)| {
        near(a.alpha, b.alpha) && a.radiance.iter().zip(b.radiance).all(|(a, b)| near(*a, b))
    };
    let mut compared = 0;
    for (name, marked) in &found {
        let Some(placed) = name.strip_suffix(ALONE).and_then(|name| found.get(name)) else {
            continue;
        };
        let alike = placed.iter().zip(marked).filter(same).count();
        let share = alike as f64 / placed.len() as f64;
        assert!(share > 0.98, "{name}: {share} of the paths are alike");
        compared += 1;
    }
    assert_eq!(compared, 3);
}
