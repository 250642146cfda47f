//! Media made of media: what they do to the law of flights, at every width.

use woodcock_core::free_flight::{analytic, delta};
use woodcock_core::medium::{
    Affine, Audited, Homogeneous, IDENTITY, Linear, Medium, Overlap, Placed, Within,
};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{KeyedStream, PathStream};
use woodcock_packet::bits::LaneStream;
use woodcock_packet::lanes::Lanes;
use woodcock_tests::depth::Depth;
use woodcock_tests::each_width;
use woodcock_tests::grids::{TestGrid, chord, map_point, unit};
use woodcock_tests::stats::{KolmogorovSmirnov, assert_verdict, must_kill, samples, seed};
use woodcock_tests::widths::{collect, everyone, ray, width};

/// Distances of flights, infinite where they leave.
fn fly<R: Real, S: KeyedStream<R>>(
    medium: &impl Medium<R>,
    (origin, direction): ([f64; 3], [f64; 3]),
    t_max: f64,
    n: usize,
) -> Vec<f64> {
    let along: Ray<R> = ray(origin, direction);
    let end = R::splat(t_max as f32);
    collect::<R, S>(seed(141), 0, samples(n), |rng| {
        delta::sample(medium, &along, end, rng, everyone::<R>()).or_infinite()
    })
}

fn test(flights: &[f64], t_max: f64, cdf: impl Fn(f64) -> f64) -> KolmogorovSmirnov {
    let (mut inside, outside): (Vec<f64>, Vec<f64>) = flights.iter().partition(|t| t.is_finite());
    inside
        .iter_mut()
        .for_each(|t| *t = t.min(t_max.next_down()));
    KolmogorovSmirnov::censored(&mut inside, outside.len() as u64, t_max, cdf)
}

/// Flights of a medium, by delta tracking at every width, against the law of a depth.
fn law<M>(name: &str, medium: &M, from: ([f64; 3], [f64; 3]), depth: &Depth<'_>, t_max: f64)
where
    M: Medium<f32> + Medium<f64> + Medium<Lanes>,
{
    let flights = fly::<f32, PathStream>(medium, from, t_max, 1 << 16);
    let found = test(&flights, t_max, |t| depth.collided(t));
    assert_verdict(name, found.verdict(0.012));
    // The same flights against a depth a tenth larger: the check sees such a mistake.
    let wrong = test(&flights, t_max, |t| -(-1.1 * depth.at(t)).exp_m1());
    must_kill(name, wrong.verdict(0.012));
    for (name, flights) in [
        (
            format!("{name}, f64"),
            fly::<f64, PathStream>(medium, from, t_max, 1 << 13),
        ),
        (
            format!("{name}, x8"),
            fly::<Lanes, LaneStream>(medium, from, t_max, 1 << 13),
        ),
    ] {
        let found = test(&flights, t_max, |t| depth.collided(t));
        assert_verdict(&name, found.verdict(0.03));
    }
}

fn fog(sigma_t: f32) -> Homogeneous {
    Homogeneous::new(sigma_t).expect("a valid extinction")
}

#[test]
fn a_constant_grid_is_fog() {
    let dims = [25, 17, 33];
    let grid = TestGrid::new(dims, |_| 0.5);
    let chord = chord(dims, [12.0, 8.5, 15.0], [0.5, 0.4, 0.8]);
    let scale = 0.125;
    let depth = Depth::new(chord.t_max, 1, &[], |_| 0.0625);
    let from = (chord.origin, chord.direction);
    law(
        "constant grid",
        &grid.medium(IDENTITY, scale),
        from,
        &depth,
        chord.t_max,
    );
    // In its box, seen from outside: nothing before it.
    let back = chord.direction.map(|d| -4.0 * d);
    let origin = std::array::from_fn(|a| f64::from((chord.origin[a] + back[a]) as f32));
    let t_max = chord.t_max + 8.0;
    let inside = |t: f64| {
        let place: [f64; 3] = std::array::from_fn(|a| origin[a] + t * chord.direction[a]);
        (0..3).all(|a| (0.0..=f64::from(dims[a] - 1)).contains(&place[a]))
    };
    let edges: Vec<f64> = (0..3)
        .flat_map(|a| {
            [0.0, f64::from(dims[a] - 1)].map(|face| (face - origin[a]) / chord.direction[a])
        })
        .collect();
    let depth = Depth::new(t_max, 1, &edges, |t| if inside(t) { 0.0625 } else { 0.0 });
    let boxed = Within::domain(grid.medium(IDENTITY, scale));
    law(
        "constant grid in its box",
        &boxed,
        (origin, chord.direction),
        &depth,
        t_max,
    );
    let fog_in_it =
        Within::aligned(fog(0.0625), [0.0; 3], dims.map(|n| (n - 1) as f32)).expect("a box");
    law(
        "fog in that box",
        &fog_in_it,
        (origin, chord.direction),
        &depth,
        t_max,
    );
}

/// A box turned, with a falling ramp inside: pieces of the ramp begin where the ray enters.
#[test]
fn a_ramp_in_a_box_begins_at_the_box() {
    let ramp = Linear::new(2.0, [-0.25, 0.0, 0.125]).expect("a finite ramp");
    // Turned by 30 degrees about y, half as large.
    let (c, s) = (0.866_025_4_f32, 0.5_f32);
    let turned: Affine = [
        [2.0 * c, 0.0, 2.0 * s, -3.0],
        [0.0, 2.0, 0.0, 1.5],
        [-2.0 * s, 0.0, 2.0 * c, 1.0],
    ];
    let size = [5.0, 4.0, 6.0];
    let medium = Within::new(ramp, turned, size).expect("a box");
    let direction = unit([0.9, 0.1, 0.3]).map(|d| f64::from(d as f32));
    let (origin, t_max) = ([-1.5, 0.0, 0.25], 8.0);
    let place = |t: f64| -> [f64; 3] { std::array::from_fn(|a| origin[a] + t * direction[a]) };
    let local = |t: f64| map_point(&turned, place(t));
    let (at_0, at_1) = (local(0.0), local(1.0));
    let edges: Vec<f64> = (0..3)
        .flat_map(|a| [0.0, f64::from(size[a])].map(|face| (face - at_0[a]) / (at_1[a] - at_0[a])))
        .collect();
    let sigma_t = |t: f64| {
        let (p, q) = (place(t), local(t));
        let inside = (0..3).all(|a| (0.0..=f64::from(size[a])).contains(&q[a]));
        if inside {
            (2.0 - 0.25 * p[0] + 0.125 * p[2]).max(0.0)
        } else {
            0.0
        }
    };
    let depth = Depth::new(t_max, 1, &edges, sigma_t);
    assert!(depth.at(1.0) == 0.0 && depth.total() > 1.0, "{depth:?}");
    law(
        "ramp in a turned box",
        &medium,
        (origin, direction),
        &depth,
        t_max,
    );
}

#[test]
fn what_overlaps_collides_in_both() {
    let dims = [17, 18, 19];
    let grid = TestGrid::random(dims, 142, 0.4);
    let medium = Overlap(fog(0.03), Within::domain(grid.medium(IDENTITY, 0.125)));
    let direction = unit([0.4, 0.5, -0.7]).map(|d| f64::from(d as f32));
    let (origin, t_max) = ([2.0, -2.5, 22.0], 32.0);
    let place = |t: f64| -> [f64; 3] { std::array::from_fn(|a| origin[a] + t * direction[a]) };
    let sigma_t = |t: f64| {
        let p = place(t);
        let inside = (0..3).all(|a| (0.0..=f64::from(dims[a] - 1)).contains(&p[a]));
        f64::from(0.03_f32) + if inside { 0.125 * grid.at(p) } else { 0.0 }
    };
    let planes =
        (0..3).flat_map(|a| (0..dims[a]).map(move |i| (f64::from(i) - origin[a]) / direction[a]));
    let depth = Depth::new(t_max, 1, &planes.collect::<Vec<f64>>(), sigma_t);
    law(
        "fog and a grid",
        &medium,
        (origin, direction),
        &depth,
        t_max,
    );
}

/// A ramp in a space turned and stretched: tracked, and in closed form.
#[test]
fn a_placed_ramp_keeps_lengths_of_the_world() {
    let ramp = Linear::new(0.25, [0.05, 0.1, 0.0]).expect("a finite ramp");
    let map = super::rows::PLACED;
    let medium = Placed::new(ramp, map).expect("a finite map");
    let direction = unit([0.3, 0.9, 0.1]).map(|d| f64::from(d as f32));
    let (origin, t_max) = ([0.5, -0.25, 1.0], 1.5);
    let sigma_t = |t: f64| {
        let q = map_point(&map, std::array::from_fn(|a| origin[a] + t * direction[a]));
        (0.25 + 0.05 * q[0] + 0.1 * q[1]).max(0.0)
    };
    let (a, b) = (sigma_t(0.0), sigma_t(1.0) - sigma_t(0.0));
    assert!(
        a > 0.0 && a + t_max * b > 0.0,
        "a ramp without a kink: {a} + {b} t"
    );
    let depth = Depth::new(t_max, 1, &[], sigma_t);
    law("placed ramp", &medium, (origin, direction), &depth, t_max);
    each_width!(R, S => {
        let along: Ray<R> = ray(origin, direction);
        let flights = collect::<R, S>(seed(143), 0, samples(1 << 16), |rng| {
            analytic::sample(&medium, &along, R::splat(t_max as f32), rng, everyone::<R>()).or_infinite()
        });
        let found = test(&flights, t_max, |t| depth.collided(t));
        assert_verdict(width::<R>(), found.verdict(0.012));
    });
}

/// Optical depths in closed form add; and a box that a ray misses, or that it left behind, costs no look-up.
#[test]
fn a_box_elsewhere_costs_nothing() {
    let (one, other) = (
        fog(0.5),
        Linear::new(0.25, [0.0, 0.5, 0.0]).expect("a finite ramp"),
    );
    let along: Ray<f32> = ray([0.0; 3], [0.0, 1.0, 0.0]);
    let depth = Overlap(one, other).optical_depth(&along, 2.0);
    assert_eq!(depth, 0.5 * 2.0 + (0.25 * 2.0 + 0.25 * 4.0));

    let grid = TestGrid::random([9, 9, 9], 144, 0.0);
    let boxed = Within::domain(grid.medium(IDENTITY, 100.0));
    let audited = Audited::new(boxed);
    for (name, from) in [
        ("beside it", ([-1.0, 4.0, 4.0], [0.0, 1.0, 0.0])),
        ("behind it", ([9.0, 4.0, 4.0], [1.0, 0.0, 0.0])),
        ("along its far face", ([8.0, 1.0, 4.0], [0.0, 1.0, 0.0])),
    ] {
        let flights = fly::<Lanes, LaneStream>(&audited, from, 50.0, 1024);
        assert!(flights.iter().all(|t| t.is_infinite()), "{name}");
    }
    assert_eq!(audited.lookups(), 0);
    let through =
        fly::<Lanes, LaneStream>(&audited, ([-3.0, 4.0, 4.0], [1.0, 0.0, 0.0]), 50.0, 1024);
    assert!(through.iter().all(|t| (3.0..11.0).contains(t)));
    assert!(audited.lookups() >= 1024 && audited.violations() == 0);
}
