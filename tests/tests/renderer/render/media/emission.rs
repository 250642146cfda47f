//! Light from within: its law at a place, and the voxels that hold it.

use super::*;

#[test]
fn a_homogeneous_medium_shines_everywhere_alike() {
    let world = world_of(|m| {
        m.emission = Some(Emission {
            scale: 3.0,
            le: [1.0, 2.0, 0.0],
            ..Emission::default()
        });
    });
    let medium = &world.media[0];
    assert!(!medium.is_plain() && medium.is_emissive());
    let local = medium.local(&world.tables, None, DVec3::ONE);
    // σ_a is 0.5, 1.5, 0.75.
    near(
        "source",
        local.emission,
        [0.5 * 6.0, 1.5 * 12.0, 0.0],
        1e-12,
    );
    assert!(medium.emissive_voxels(&world.tables).is_empty());
}

#[test]
fn what_does_not_absorb_sends_out_no_light() {
    let grid = rgb(true);
    let world = world_of(|m| {
        m.kind = MediumKind::RgbGrid(grid);
        m.sigma_a = [0.0; 3];
        m.medium_to_world = turned();
    });
    for p in places(P0, P1, 100) {
        let local = world.media[0].local(&world.tables, None, rendered(p));
        assert_eq!(local.emission, [0.0; 3]);
    }
    assert!(world.media[0].emissive_voxels(&world.tables).is_empty());
}

fn fire() -> (Vec<f32>, Vec<f32>, Emission) {
    let temperatures: Vec<f32> = (0..120)
        .map(|n| 300.0 + 2000.0 * scramble(n + 500))
        .collect();
    let scales: Vec<f32> = (0..120).map(|n| scramble(n + 900)).collect();
    let emission = Emission {
        scale: 1.5,
        le: [7.0; 3],
        scale_grid: Some(scales.clone()),
        temperature: Some(Temperature {
            values: TemperatureValues::Listed(temperatures.clone()),
            offset: 100.0,
            scale: 1.25,
        }),
    };
    (temperatures, scales, emission)
}

#[test]
fn fire_has_the_colour_of_its_interpolated_temperature() {
    let (temperatures, scales, emission) = fire();
    let world = world_of(|m| {
        m.kind = uniform(scramble);
        m.emission = Some(emission);
        m.medium_to_world = turned();
    });
    let medium = &world.media[0];
    let (mut lit, mut blackest) = (0, f64::INFINITY);
    for p in places(P0, P1, 300) {
        let cells = in_cells(p);
        let of = |list: &dyn Fn(usize) -> f32| hats(SIZE, |i| f64::from(list(at(i))), cells);
        let density = of(&scramble);
        let kelvin = (of(&|n| temperatures[n]) - 100.0) * 1.25;
        let le = blackbody_peak_one(kelvin);
        let factor = of(&|n| scales[n]) * 1.5 * EXPOSURE;
        let source = std::array::from_fn(|c| [0.5, 1.5, 0.75][c] * density * factor * le[c]);
        let local = medium.local(&world.tables, None, rendered(p));
        near("source", local.emission, source, 3e-5);
        lit += u32::from(kelvin > 900.0);
        blackest = blackest.min(kelvin);
    }
    assert!(lit > 100 && blackest < 700.0, "{lit} {blackest}");
}

/// The places of the medium's space that shine and lie in no voxel of a list.
fn missed(medium: &Medium, world: &World, voxels: &[EmissiveVoxel]) -> usize {
    let to_grid = medium.world_to_grid().expect("a grid");
    places(P0, P1, 4000)
        .filter(|p| {
            let place = rendered(*p);
            let shines = medium.local(&world.tables, None, place).emission != [0.0; 3];
            let grid = to_grid.transform_point3(place);
            let within = |v: &EmissiveVoxel| {
                let slack = 1e-4;
                grid.cmpge(v.low - slack).all()
                    && grid.cmple(v.high + slack).all()
                    && v.source.iter().any(|s| *s > 0.0)
            };
            shines && !voxels.iter().any(within)
        })
        .count()
}

#[test]
fn voxels_that_shine_hold_all_light() {
    // A few voxels with matter, in a corner too, and fire that is dark at most samples.
    let density = |n: usize| {
        if [0, 33, 34, 77, 119].contains(&n) {
            1.0
        } else {
            0.0
        }
    };
    let (_, _, emission) = fire();
    let constant = Emission {
        scale: 2.0,
        le: [1.0, 0.5, 0.25],
        ..Emission::default()
    };
    for (name, emission) in [("constant", constant), ("fire", emission)] {
        let world = world_of(|m| {
            m.kind = uniform(density);
            m.emission = Some(emission);
            m.medium_to_world = turned();
        });
        let medium = &world.media[0];
        let voxels = medium.emissive_voxels(&world.tables);
        assert_eq!(missed(medium, &world, &voxels), 0, "{name}");
        // Without the voxels whose own sample is empty some light would have no voxel.
        let RecordKind::Grid { samples, .. } = medium.record.kind else {
            panic!("a grid");
        };
        let own = |v: &&EmissiveVoxel| world.tables.samples[(samples + v.index) as usize] > 0.0;
        let fewer: Vec<_> = voxels.iter().filter(own).copied().collect();
        assert!(missed(medium, &world, &fewer) > 50, "{name}");
        // Boxes do not overlap, and lie within the medium.
        for (i, a) in voxels.iter().enumerate() {
            for b in &voxels[..i] {
                let apart = a.low.cmpge(b.high).any() || b.low.cmpge(a.high).any();
                assert!(apart, "{name}: {a:?} {b:?}");
            }
        }
        // Their light together is that of the medium: of the box, by midpoints.
        const N: u32 = 40;
        let mut whole = [0.0; 3];
        let volume = turned().matrix3.determinant().abs() * (P1 - P0).element_product();
        for i in 0..N * N * N {
            let u = [i % N, i / N % N, i / N / N].map(|i| (f64::from(i) + 0.5) / f64::from(N));
            let p = P0 + (P1 - P0) * DVec3::from_array(u);
            let source = medium.local(&world.tables, None, rendered(p)).emission;
            for c in 0..3 {
                whole[c] += source[c] * volume / f64::from(N * N * N);
            }
        }
        let voxel = medium
            .grid_to_world()
            .expect("a grid")
            .matrix3
            .determinant()
            .abs();
        let of = |c: usize| -> f64 {
            let light =
                |v: &EmissiveVoxel| v.source[c] * (v.high - v.low).element_product() * voxel;
            voxels.iter().map(light).sum()
        };
        // Exact for densities; a black body is no linear function, and this fire changes by half from voxel to voxel.
        let bound = if name == "constant" { 2e-3 } else { 0.3 };
        near(name, [of(0), of(1), of(2)], whole, bound);
    }
}
