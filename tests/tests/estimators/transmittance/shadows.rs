//! Shadow rays: whichever estimator of transmittance they use, every colour has the same mean.

use woodcock_core::stream::Key;
use woodcock_packet::trace::PathRequest;
use woodcock_tests::scenes::{self, SIDE, Traced};
use woodcock_tests::stats::{Moments, assert_verdict, must_kill, samples, welch};

/// The moments of the film's mean, by colour.
fn means(scene: &dyn Traced, stream: u64) -> [Moments; 3] {
    let pixels = SIDE * SIDE;
    let requests = (0..samples(600) as u32 * pixels).map(|i| PathRequest {
        x: i % SIDE,
        y: i / SIDE % SIDE,
        // Each scene has streams of its own.
        key: Key {
            seed: 200 + stream,
            pixel: i % pixels,
            sample: i / pixels,
        },
    });
    let mut moments = [Moments::new(); 3];
    let requests: Vec<PathRequest> = requests.collect();
    scene.in_packets(&requests, &mut |_, sample| {
        for (m, r) in moments.iter_mut().zip(sample.radiance) {
            m.push(f64::from(r));
        }
    });
    moments
}

#[test]
fn shadows_agree_on_every_colour() {
    let mut found = Vec::new();
    scenes::each(&mut |name, scene| {
        if name.starts_with("coloured cloud") {
            found.push((name.to_owned(), means(scene, found.len() as u64)));
        }
    });
    let of = |name: &str| {
        let found = found.iter().find(|(scene, _)| scene == name);
        found.unwrap_or_else(|| panic!("no scene {name:?}")).1
    };
    let (ratio, delta) = (
        of("coloured cloud"),
        of("coloured cloud, shadows by delta tracking"),
    );
    for (colour, (a, b)) in ratio.iter().zip(&delta).enumerate() {
        let test = welch(a, b);
        assert_verdict(
            &format!(
                "colour {colour}: {} by ratio, {} by delta tracking, z {}",
                a.mean(),
                b.mean(),
                test.z()
            ),
            test.verdict(0.01 * a.mean()),
        );
    }
    // Colours differ from each other by far more than the check resolves: blue that dims like red is seen.
    must_kill(
        "blue for red",
        welch(&ratio[2], &delta[0]).verdict(0.01 * ratio[2].mean()),
    );
}
