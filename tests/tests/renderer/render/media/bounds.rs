//! Nothing exceeds the bound of its block, and formulas are what they are said to be.

use super::*;

/// Walks rays through a medium's blocks; the largest of its extinction by the bound that was given for it, in millionths,
/// and how many look-ups there were.
fn largest_share(
    world: &World,
    shrink: f32,
    sigma_t: impl Fn(&GridWalk<f32>, f32, DVec3) -> f64,
) -> (f64, u32) {
    let medium = &world.media[0];
    // What is below zero is a leap.
    let shrunk = |m: &f32| if *m > 0.0 { m * shrink } else { *m };
    let majorants: Vec<f32> = world.tables.majorants.iter().map(shrunk).collect();
    let walker = OneGrid::new(&medium.record, &world.tables.samples, &majorants);
    let support = medium.support.as_ref().expect("a box");
    let from_local = support.to_local.inverse();
    let ends: Vec<DVec3> = places(DVec3::ZERO, support.size, 400)
        .map(|p| from_local.transform_point3(p))
        .collect();
    let (mut share, mut looked_up) = (0.0_f64, 0);
    for pair in ends.windows(2) {
        let (from, to) = (pair[0].as_vec3(), pair[1].as_vec3());
        let length = (to - from).length();
        let direction = (to - from) / length;
        let ray: Ray<f32> = Ray {
            origin: Vec3::splat(from.to_array()),
            direction: Vec3::splat(direction.to_array()),
        };
        let mut walk: GridWalk<f32> = walker.idle();
        walker.begin(&mut walk, &ray, true);
        let mut t = 0.0_f32;
        while t < length {
            let segment = walk.segment();
            let end = segment.t_exit.min(length);
            for i in 0..8_u8 {
                let s = t + (end - t) * f32::from(i) / 7.0;
                let place = from.as_dvec3() + direction.as_dvec3() * f64::from(s);
                let found = sigma_t(&walk, s, place);
                looked_up += 1;
                if found > 0.0 {
                    share = share.max(found / f64::from(segment.majorant));
                }
            }
            t = segment.t_exit;
            walk.next_segment(&majorants, true);
        }
    }
    (share, looked_up)
}

#[test]
fn no_colour_of_a_voxel_exceeds_its_bound() {
    let world = world_of(|m| {
        m.kind = MediumKind::RgbGrid(rgb(true));
        m.medium_to_world = turned();
    });
    let medium = &world.media[0];
    let stream = std::cell::RefCell::new(PathStream::new(Key::default()));
    let look_up = |walk: &GridWalk<f32>, t: f32, place: DVec3| {
        let Word32(tap) = walk.tap(t, &mut *stream.borrow_mut(), true);
        let largest = |tap| {
            let local = medium.local(&world.tables, tap, place);
            local.sigma_t.into_iter().fold(0.0, f64::max)
        };
        largest(Some(tap)).max(largest(None))
    };
    let (share, looked_up) = largest_share(&world, 1.0, look_up);
    assert!(
        share <= 1.0 && share > 0.9 && looked_up > 3000,
        "{share} {looked_up}"
    );
    let (share, _) = largest_share(&world, 0.9, look_up);
    assert!(share > 1.0, "{share}");
}

#[test]
fn a_look_up_reads_the_sample_of_its_tap() {
    let world = world_of(|m| {
        m.kind = uniform(scramble);
        m.medium_to_world = turned();
    });
    let samples = &world.tables.samples;
    let scale = world.media[0].record.scale;
    let key = |sample| Key {
        sample,
        ..Key::default()
    };
    let count = std::cell::Cell::new(0);
    let mut seen = std::collections::BTreeSet::new();
    let seen = std::cell::RefCell::new(&mut seen);
    let look_up = |walk: &GridWalk<f32>, t: f32, _: DVec3| {
        count.set(count.get() + 1);
        let (mut a, mut b) = (
            PathStream::new(key(count.get())),
            PathStream::new(key(count.get())),
        );
        let Word32(tap) = walk.tap(t, &mut a, true);
        let found = walk.sigma_t(samples, t, &mut b, true);
        assert_eq!(found.to_bits(), (samples[tap as usize] * scale).to_bits());
        let next = |stream: &mut PathStream| Stream::<f32>::next_word(stream, true);
        assert_eq!(next(&mut a), next(&mut b), "the streams stand alike");
        seen.borrow_mut().insert(tap);
        f64::from(found)
    };
    largest_share(&world, 1.0, look_up);
    assert!(seen.borrow().len() > 200, "{}", seen.borrow().len());
}

/// The density of pbrt's cloud at places, by a program of its own in another language, from pbrt's description: place,
/// (density, wispiness, frequency), value.
const CLOUDS: [([f64; 3], [f64; 3], f64); 14] = [
    (
        [0.651593, 0.952106, -0.087368],
        [1.0, 1.0, 5.0],
        0.000000000000000,
    ),
    (
        [0.762280, 0.401474, 0.334465],
        [1.0, 1.0, 5.0],
        0.277096220764104,
    ),
    (
        [0.762280, 0.401474, 0.334465],
        [0.4, 0.0, 7.5],
        0.360215225864899,
    ),
    (
        [0.762280, 0.401474, 0.334465],
        [2.0, 0.5, 3.0],
        0.355909458182979,
    ),
    (
        [0.721540, 0.560134, 0.934325],
        [1.0, 1.0, 5.0],
        0.415257587680951,
    ),
    (
        [0.721540, 0.560134, 0.934325],
        [0.4, 0.0, 7.5],
        0.133310374192572,
    ),
    (
        [0.721540, 0.560134, 0.934325],
        [2.0, 0.5, 3.0],
        0.313923869550941,
    ),
    (
        [0.901427, 0.421413, -0.169465],
        [1.0, 1.0, 5.0],
        0.157174000000000,
    ),
    (
        [0.901427, 0.421413, -0.169465],
        [0.4, 0.0, 7.5],
        0.266594646154478,
    ),
    (
        [0.901427, 0.421413, -0.169465],
        [2.0, 0.5, 3.0],
        0.352127968809232,
    ),
    (
        [0.541412, 1.057404, 0.257445],
        [2.0, 0.5, 3.0],
        0.000000000000000,
    ),
    (
        [0.221692, 0.706521, 0.394975],
        [1.0, 1.0, 5.0],
        0.393630210390610,
    ),
    (
        [0.221692, 0.706521, 0.394975],
        [0.4, 0.0, 7.5],
        0.101541915898365,
    ),
    (
        [0.221692, 0.706521, 0.394975],
        [2.0, 0.5, 3.0],
        0.465306140254330,
    ),
];

fn cloud([density, wispiness, frequency]: [f64; 3]) -> World {
    world_of(|m| {
        m.kind = MediumKind::Cloud(Cloud {
            density,
            wispiness,
            frequency,
            p0: DVec3::splat(-0.25),
            p1: DVec3::splat(1.125),
        });
        m.medium_to_world = turned();
    })
}

#[test]
fn clouds_are_pbrts() {
    for (p, parameters, expected) in CLOUDS {
        let world = cloud(parameters);
        let medium = &world.media[0];
        assert!(!medium.is_plain() && !medium.has_samples());
        let local = medium.local(&world.tables, None, rendered(DVec3::from_array(p)));
        near(
            "cloud",
            local.sigma_t,
            [expected, 2.0 * expected, 3.0 * expected],
            1e-6,
        );
        near("albedo", local.albedo, [0.5, 0.25, 0.75], 1e-6);
    }
}

#[test]
fn clouds_stay_within_their_bounds() {
    let mut saved = false;
    for parameters in [[1.0, 1.0, 5.0], [0.4, 0.0, 7.5], [0.1, 0.3, 11.0]] {
        let world = cloud(parameters);
        let medium = &world.media[0];
        let field = medium.cloud_field(&world.tables).expect("a cloud");
        let look_up = |walk: &GridWalk<f32>, t: f32, place: DVec3| {
            let mut none = PathStream::new(Key::default());
            let walked = f64::from(field.sigma_t(walk, t, &mut none, true));
            let [.., local] = medium.local(&world.tables, None, place).sigma_t;
            // Both are the density of about one place.
            assert!((walked - local).abs() < 2e-3, "{walked} {local}");
            walked.max(local)
        };
        let (share, looked_up) = largest_share(&world, 1.0, look_up);
        assert!(
            share <= 1.0 && looked_up > 10_000,
            "{parameters:?}: {share}, {looked_up}"
        );
        assert!(share > 0.5, "the bounds are far too high: {share}");
        // Bounds half as high are exceeded: the check sees.
        let (share, _) = largest_share(&world, 0.5, look_up);
        assert!(share > 1.0, "{share}");
        let RecordKind::Grid {
            dims, majorants, ..
        } = medium.record.kind
        else {
            panic!("a grid of layers");
        };
        let first = majorants as usize;
        let bounds = &world.tables.majorants[first..first + majorant_count(dims).expect("few")];
        assert!(bounds.iter().all(|b| (0.0..=1.0).contains(b)));
        saved |= bounds.iter().any(|b| 0.0 < *b && *b < 0.5);
    }
    assert!(saved, "no layer is thinner than another");
}
