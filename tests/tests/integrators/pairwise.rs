//! Path tracing, bidirectional path tracing and Metropolis light transport make the same picture, scene by scene; and so do
//! the lower rungs of the ladder where a limit on scatterings leaves them everything.

use woodcock_host::integrator::Integrator;
use woodcock_tests::gallery::{self, Exhibit};
use woodcock_tests::replicates::Replicates;

/// Samples of a picture, by what one costs and how noisy it is.
pub(super) const fn depth(integrator: Integrator) -> u32 {
    match integrator {
        Integrator::Path | Integrator::Single | Integrator::Transmittance => 640,
        Integrator::Bdpt => 256,
        Integrator::Mlt => 192,
    }
}

/// Relative standard error of the difference of two pictures' means that a comparison must reach.
const RESOLUTION: f64 = 0.01;

fn replicates(exhibit: &Exhibit, integrator: Integrator, seed: u64) -> Replicates {
    let studio = exhibit.stage(integrator, seed);
    assert!(
        !studio.plan.in_packets(&studio.world),
        "{}: packets render this",
        exhibit.name
    );
    Replicates::of(exhibit.name, &studio, depth(integrator))
}

#[track_caller]
fn all_agree(name: &str) {
    let exhibits = gallery::all();
    let (index, exhibit) = exhibits
        .iter()
        .enumerate()
        .find(|(_, exhibit)| exhibit.name == name)
        .expect("an exhibit of this name");
    let seed = 1000 + 10 * index as u64;
    let path = replicates(exhibit, Integrator::Path, seed);
    for (integrator, seed) in [(Integrator::Bdpt, seed + 1), (Integrator::Mlt, seed + 2)] {
        let other = replicates(exhibit, integrator, seed);
        other.assert_same(
            &format!("{name}, {} against path", integrator.name()),
            &path,
            RESOLUTION,
        );
    }
}

/// A test for each exhibit, of its name.
macro_rules! exhibits {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                all_agree(&stringify!($name).replace('_', " "));
            }
        )*

        #[test]
        fn every_exhibit_is_tested() {
            let tested = [$(stringify!($name)),*].map(|name| name.replace('_', " "));
            let all: Vec<_> = gallery::all().iter().map(|exhibit| exhibit.name).collect();
            assert_eq!(all, tested);
        }
    };
}

exhibits! {
    a_ball_of_fog_by_a_point
    a_grid_by_a_spot_and_the_sun
    an_rgb_grid_under_a_triangle
    a_cloud_on_parallel_rays
    a_caustic_of_glass_in_fog
    metals_under_a_picture
    a_texture_under_a_patch
    fog_that_shines
    a_fire_over_a_floor
    a_fire_by_its_temperature_and_a_lamp
    coloured_smoke_under_a_disk
    media_that_overlap
    instances
    a_lens_before_fog
    a_lens_on_parallel_rays
    a_camera_in_fog
    milk_in_a_glass_ball
    a_thin_pane_by_a_lamp_with_a_picture
}

/// Lamps of all kinds, a fire and fog, so that every number of scatterings brings light.
fn mixed() -> Exhibit {
    use woodcock_tests::gallery::*;
    use woodcock_tests::pictures::*;
    Exhibit::new(
        "everything at once",
        front(),
        disk_above([4.0, 5.0, 6.0])
            + &point([-1.5, 2.0, -1.5], 5.0)
            + &sky(0.2)
            + &floor(&diffuse([0.6, 0.5, 0.4]))
            + &fire(0.6)
            + &homogeneous("fog", &coloured([0.1, 0.2, 0.3], [0.6, 0.5, 0.4], 0.3))
            + &block("fire", "", [[-1.0; 3], [0.2, 1.0, 1.0]])
            + &ball("fog", "", [0.0; 3], 1.3)
            + &sphere(&diffuse([0.7, 0.6, 0.2]), [0.8, -0.5, -0.6], 0.4),
    )
}

#[test]
fn limits_mean_the_same_to_all() {
    let mut means = Vec::new();
    for (seed, limit) in (2000..).step_by(10).zip([0, 1, 2, 5]) {
        let exhibit = mixed().limited(limit);
        let path = replicates(&exhibit, Integrator::Path, seed);
        let lower = match limit {
            0 => Some(Integrator::Transmittance),
            1 => Some(Integrator::Single),
            _ => None,
        };
        let others = [Integrator::Bdpt, Integrator::Mlt].into_iter().chain(lower);
        for (seed, integrator) in (seed + 1..).zip(others) {
            let other = replicates(&exhibit, integrator, seed);
            let name = format!("{} at most {limit} times", integrator.name());
            other.assert_same(&name, &path, RESOLUTION);
        }
        means.push(path.whole(1).mean());
    }
    assert!(
        means.is_sorted_by(|a, b| 1.01 * a < *b),
        "each limit shows more: {means:?}"
    );
}
