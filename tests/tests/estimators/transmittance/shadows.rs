//! Shadow rays: whichever estimator of transmittance they use, every colour has the same mean.

use woodcock_core::path::{Geometry, Scene, Tapped};
use woodcock_core::stream::Key;
use woodcock_packet::both::Wide;
use woodcock_packet::lanes::Lanes;
use woodcock_packet::trace::PathRequest;
use woodcock_tests::scenes::{self, SIDE, Visitor, traced};
use woodcock_tests::stats::{Moments, assert_verdict, must_kill, samples, welch};

/// The moments of the film's mean, by scene and colour.
struct Means(Vec<(String, [Moments; 3])>);

impl Visitor for Means {
    fn visit<M, G, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>(
        &mut self,
        name: &str,
        scene: &Scene<'_, M, G>,
    ) where
        M: Tapped<f32> + Tapped<Lanes> + Tapped<Wide>,
        G: Geometry<f32> + Geometry<Lanes> + Geometry<Wide>,
    {
        if !name.starts_with("coloured cloud") {
            return;
        }
        let pixels = SIDE * SIDE;
        let requests = (0..samples(600) as u32 * pixels).map(|i| PathRequest {
            x: i % SIDE,
            y: i / SIDE % SIDE,
            // Each scene has streams of its own.
            key: Key {
                seed: 200 + self.0.len() as u64,
                pixel: i % pixels,
                sample: i / pixels,
            },
        });
        let mut moments = [Moments::new(); 3];
        let requests: Vec<PathRequest> = requests.collect();
        traced::<M, G, CHROMATIC, ANY_RAYLEIGH>(scene, &requests, &mut |_, sample| {
            for (m, r) in moments.iter_mut().zip(sample.radiance) {
                m.push(f64::from(r));
            }
        });
        self.0.push((name.to_owned(), moments));
    }
}

#[test]
fn shadows_agree_on_every_colour() {
    let mut means = Means(Vec::new());
    scenes::each(&mut means);
    let of = |name: &str| {
        let found = means.0.iter().find(|(scene, _)| scene == name);
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
