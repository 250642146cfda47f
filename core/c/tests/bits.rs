//! The C interface from Rust: the bits of the core behind every function, and every error.
#![allow(
    unsafe_code,
    reason = "what callers of C do, with pointers that are what they should be or deliberately not"
)]

use core::ffi::{CStr, c_void};
use core::ptr::{null, null_mut};

use woodcock_c::*;
use woodcock_core::free_flight::{analytic, delta};
use woodcock_core::majorant::{MajorantGrid, majorant_depth};
use woodcock_core::medium::{Grid, Homogeneous, IDENTITY, Procedural, Within};
use woodcock_core::phase::{henyey_greenstein, isotropic, rayleigh};
use woodcock_core::stream::{PathStream, Stream};
use woodcock_core::transmittance::ratio;
use woodcock_core::vec3::Vec3;
use woodcock_core::{ray, stream};

const DIMS: [u32; 3] = [17, 2, 2];
const EDGE: u32 = 4;
const SCALE: f32 = 0.25;
/// What the C example checks, too: sums over its 4096 paths.
const SUMS: [u32; 2] = [0x4408_eb7e, 0x451b_b71e];

/// The grid of the C example: extinction rises from 0 to 1/4 and falls back.
struct Tables {
    samples: Vec<f32>,
    majorants: Vec<f32>,
}

impl Tables {
    fn new() -> Self {
        let samples: Vec<f32> = (0..68)
            .map(|i| 0.125 * (i % 17).min(16 - i % 17) as f32)
            .collect();
        // SAFETY: a pointer to what it should.
        let count = unsafe { woodcock_majorant_count(&DIMS, EDGE) };
        let mut tables = Self {
            samples,
            majorants: vec![0.0; count],
        };
        assert_eq!(tables.fill(), Status::Ok);
        tables
    }
    fn fill(&mut self) -> Status {
        let (samples, majorants) = (&self.samples, &mut self.majorants);
        let (n, m) = (samples.len(), majorants.len());
        // SAFETY: pointers to what they should.
        unsafe {
            woodcock_fill_majorants(samples.as_ptr(), n, &DIMS, EDGE, majorants.as_mut_ptr(), m)
        }
    }
    fn open_as(
        &self,
        dims: [u32; 3],
        edge: u32,
        map: [[f32; 4]; 3],
        scale: f32,
    ) -> Result<OpaqueGrid, Status> {
        let mut grid = OpaqueGrid([0; 24]);
        let (n, m) = (self.samples.len(), self.majorants.len());
        let (samples, majorants) = (self.samples.as_ptr(), self.majorants.as_ptr());
        // SAFETY: pointers to what they should.
        let status = unsafe {
            woodcock_open_grid(
                &mut grid, samples, n, &dims, edge, majorants, m, &map, scale,
            )
        };
        if status == Status::Ok {
            Ok(grid)
        } else {
            Err(status)
        }
    }
    fn open(&self) -> OpaqueGrid {
        self.open_as(DIMS, EDGE, IDENTITY, SCALE)
            .expect("a sound grid")
    }
    fn core(&self) -> Grid<'_> {
        let bounds = MajorantGrid::with_edge(&self.samples, DIMS, EDGE, &self.majorants);
        Grid::new(bounds.expect("bounds"), IDENTITY, SCALE).expect("a grid")
    }
}

/// A stream and its twin in the core.
fn streams(sample: u32) -> (OpaqueStream, PathStream) {
    let mut opaque = OpaqueStream([0; 2]);
    let key = Key {
        seed: 6,
        pixel: 2,
        sample,
    };
    // SAFETY: pointers to what they should.
    let status = unsafe { woodcock_stream_begin(&mut opaque, &key) };
    assert_eq!(status, Status::Ok);
    (
        opaque,
        PathStream::new(stream::Key {
            seed: 6,
            pixel: 2,
            sample,
        }),
    )
}

const RAY: Ray = Ray {
    origin: [-3.0, 0.5, 0.5],
    direction: [1.0, 0.0, 0.0],
    t_max: f32::INFINITY,
};
const WITHIN: Ray = Ray {
    origin: [0.0, 0.5, 0.5],
    t_max: 16.0,
    ..RAY
};

fn along(ray: &Ray) -> ray::Ray<f32> {
    ray::Ray {
        origin: Vec3::splat(ray.origin),
        direction: Vec3::splat(ray.direction),
    }
}

fn tent(x: f32) -> f32 {
    0.25 * (1.0 - (x - 8.0).abs() / 8.0)
}

unsafe extern "C" fn field(factor: *mut c_void, place: *const [f32; 3]) -> f32 {
    // SAFETY: the library gives a place, and back what it was given.
    unsafe { tent((*place)[0]) * *factor.cast::<f32>() }
}

const NO_FLIGHT: Flight = Flight {
    t: -1.0,
    collided: 7,
};

#[test]
fn every_function_has_the_bits_of_the_core() {
    let tables = Tables::new();
    let (grid, core) = (tables.open(), tables.core());
    let medium = Procedural::new(|p: Vec3<f32>| tent(p.x), 0.25);
    let (mut sum, mut cosines) = (0.0_f32, 0.0_f32);
    for sample in 0..4096 {
        let (mut stream, mut rng) = streams(sample);
        let (mut weight, mut flight, mut one) = (-1.0, NO_FLIGHT, 1.0_f32);
        let data = (&raw mut one).cast::<c_void>();
        let mut scattered = Scattered {
            direction: [0.0; 3],
            density: 0.0,
        };
        // SAFETY: pointers to what they should, here and below.
        unsafe {
            let s = &raw mut stream;
            assert_eq!(
                woodcock_grid_transmittance(&grid, &RAY, s, &mut weight),
                Status::Ok
            );
            assert_eq!(
                weight,
                ratio::estimate(&core, &along(&WITHIN), 16.0, &mut rng, true)
            );
            sum += weight;
            assert_eq!(
                woodcock_field_transmittance(Some(field), data, 0.25, &WITHIN, s, &mut weight),
                Status::Ok
            );
            assert_eq!(
                weight,
                ratio::estimate(&medium, &along(&WITHIN), 16.0, &mut rng, true)
            );
            assert_eq!(
                woodcock_grid_flight(&grid, &RAY, s, &mut flight),
                Status::Ok
            );
            let expected = delta::sample(&core, &along(&WITHIN), 16.0, &mut rng, true);
            let t = if expected.collided {
                expected.t + 3.0
            } else {
                f32::INFINITY
            };
            assert_eq!((flight.t, flight.collided == 1), (t, expected.collided));
            let phases = [(1, 0.6_f32), (0, f32::NAN), (2, f32::NAN)];
            for (kind, g) in phases {
                assert_eq!(
                    woodcock_phase_sample(kind, g, &RAY.direction, s, &mut scattered),
                    Status::Ok
                );
                let u: f32 = rng.uniform(true);
                let (cosine, value) = match kind {
                    0 => (isotropic::sample(u), isotropic::eval(0.0_f32)),
                    1 => {
                        let cosine = henyey_greenstein::sample(u, g);
                        (cosine, henyey_greenstein::eval(cosine, g))
                    }
                    _ => (rayleigh::sample(u), rayleigh::eval(rayleigh::sample(u))),
                };
                let direction = along(&RAY).direction.deflected(cosine, rng.uniform(true));
                assert_eq!(
                    scattered,
                    Scattered {
                        direction: direction.lane(0),
                        density: value
                    }
                );
                let mut density = 0.0;
                assert_eq!(
                    woodcock_phase_eval(kind, g, cosine, &mut density),
                    Status::Ok
                );
                assert_eq!(density, value);
                cosines += if kind == 1 {
                    scattered.direction[0]
                } else {
                    0.0
                };
            }
            assert_eq!(
                woodcock_field_flight(Some(field), data, 0.25, &WITHIN, s, &mut flight),
                Status::Ok
            );
            let expected = delta::sample(&medium, &along(&WITHIN), 16.0, &mut rng, true);
            assert_eq!(
                (flight.t, flight.collided == 1),
                (expected.t, expected.collided)
            );
            assert_eq!(woodcock_fog_flight(0.25, 4.0, s, &mut flight), Status::Ok);
            let fog = Homogeneous::new(0.25).expect("a medium");
            let expected = analytic::sample(&fog, &along(&WITHIN), 4.0, &mut rng, true);
            assert_eq!(
                (flight.t, flight.collided == 1),
                (expected.t, expected.collided)
            );
            assert_eq!(
                (woodcock_uniform(s, &mut weight), weight),
                (Status::Ok, rng.uniform(true))
            );
            assert_eq!(
                (woodcock_exponential(s, &mut weight), weight),
                (Status::Ok, rng.exponential(true))
            );
        }
    }
    assert_eq!([sum, cosines].map(f32::to_bits), SUMS);
}

/// A hundred rays from everywhere: segments join, add up to the core's majorant depth, and end.
#[test]
fn walks_are_those_of_the_core() {
    let tables = Tables::new();
    let (grid, core) = (tables.open(), Within::domain(tables.core()));
    let mut met = 0;
    for sample in 0..400 {
        let (_, mut rng) = streams(sample);
        let mut place = |size: f32| (Stream::<f32>::uniform(&mut rng, true) * 3.0 - 1.0) * size;
        let origin = [place(16.0), place(1.0), place(1.0)];
        let target = [place(16.0), place(1.0), place(1.0)];
        let direction: Vec3<f32> = (Vec3::splat(target) - Vec3::splat(origin)).normalised();
        let ray = Ray {
            origin,
            direction: direction.lane(0),
            t_max: 20.0,
        };
        let mut walk = OpaqueWalk([0; 24]);
        let mut segment = Segment {
            majorant: 0.0,
            t0: 0.0,
            t1: 0.0,
        };
        let (mut depth, mut last, mut count) = (0.0_f32, None, 0);
        // SAFETY: pointers to what they should, here and below.
        let status = unsafe { woodcock_walk_begin(&mut walk, &grid, &ray) };
        assert_eq!(status, Status::Ok);
        // SAFETY: as above.
        while unsafe { woodcock_walk_next(&mut walk, &grid, &mut segment) } == Status::Ok {
            assert!(last.is_none_or(|last| last == segment.t0) && segment.t1 >= segment.t0);
            depth += segment.majorant * (segment.t1 - segment.t0);
            let (middle, mut sigma_t) = (0.5 * (segment.t0 + segment.t1), -1.0);
            // SAFETY: as above.
            let status = unsafe { woodcock_walk_extinction(&walk, &grid, middle, &mut sigma_t) };
            let expected = tent(along(&ray).at(middle).x.clamp(0.0, 16.0));
            let in_rim = segment.majorant == 0.0 && segment.t1 - segment.t0 < 1e-5;
            assert_eq!(status, Status::Ok);
            assert!(
                sigma_t <= segment.majorant && ((sigma_t - expected).abs() < 1e-4 || in_rim),
                "{sigma_t} and {expected} on {segment:?}"
            );
            last = Some(segment.t1);
            count += 1;
            assert!(count < 100, "a walk without an end");
        }
        let expected = majorant_depth(&core, &along(&ray), ray.t_max, true);
        assert!(
            (depth - expected).abs() <= 1e-4,
            "ray {sample}: {depth} and {expected}"
        );
        met += u32::from(depth > 0.0);
        // SAFETY: as above.
        let status = unsafe { woodcock_walk_next(&mut walk, &grid, &mut segment) };
        assert_eq!(status, Status::End);
    }
    assert!(met > 40, "{met} rays met the grid");
}

#[test]
fn every_error_is_found() {
    let tables = Tables::new();
    let grid = tables.open();
    let (mut stream, _) = streams(0);
    let before = stream.0;
    let (mut flight, mut number) = (NO_FLIGHT, -1.0_f32);
    let closed = OpaqueGrid([0; 24]);
    let mut seen = vec![Status::Ok, Status::End];
    let mut expect = |expected: Status, found: Status| {
        assert_eq!(found, expected);
        seen.push(found);
    };
    let open = |dims, edge, map, scale| {
        tables
            .open_as(dims, edge, map, scale)
            .err()
            .unwrap_or(Status::Ok)
    };
    // SAFETY: pointers to what they should, null, or misaligned, none of which is followed.
    unsafe {
        let s = &raw mut stream;
        let fly = |ray: Ray| woodcock_grid_flight(&grid, &ray, s, &mut { NO_FLIGHT });
        expect(
            Status::Null,
            woodcock_grid_flight(null(), &RAY, s, &mut flight),
        );
        expect(
            Status::Null,
            woodcock_grid_flight(&grid, null(), s, &mut flight),
        );
        expect(
            Status::Null,
            woodcock_grid_flight(&grid, &RAY, null_mut(), &mut flight),
        );
        expect(
            Status::Null,
            woodcock_grid_flight(&grid, &RAY, s, null_mut()),
        );
        expect(
            Status::Null,
            woodcock_field_flight(None, null_mut(), 1.0, &WITHIN, s, &mut flight),
        );
        expect(
            Status::Null,
            woodcock_fill_majorants(null(), 68, &DIMS, EDGE, &mut number, 1),
        );
        expect(Status::Null, woodcock_stream_begin(s, null()));
        let odd = (&raw mut number).cast::<u8>().wrapping_add(1).cast::<f32>();
        expect(Status::Alignment, woodcock_uniform(s, odd));
        expect(Status::Alignment, woodcock_fog_transmittance(1.0, 1.0, odd));
        let (samples, n) = (tables.samples.as_ptr(), tables.samples.len());
        let inside = samples.cast_mut().wrapping_add(10);
        expect(
            Status::Overlap,
            woodcock_fill_majorants(samples, n, &DIMS, EDGE, inside, 54),
        );
        expect(
            Status::Ray,
            fly(Ray {
                origin: [f32::NAN, 0.0, 0.0],
                ..RAY
            }),
        );
        expect(
            Status::Ray,
            fly(Ray {
                origin: [0.0, f32::INFINITY, 0.0],
                ..RAY
            }),
        );
        expect(
            Status::Ray,
            fly(Ray {
                direction: [1.0, 0.1, 0.0],
                ..RAY
            }),
        );
        expect(
            Status::Ray,
            fly(Ray {
                direction: [f32::NAN; 3],
                ..RAY
            }),
        );
        expect(Status::Ray, fly(Ray { t_max: -1.0, ..RAY }));
        expect(
            Status::Ray,
            fly(Ray {
                t_max: f32::NAN,
                ..RAY
            }),
        );
        expect(
            Status::Ray,
            woodcock_fog_flight(1.0, f32::NAN, s, &mut flight),
        );
        expect(
            Status::Ray,
            woodcock_fog_transmittance(1.0, -1.0, &mut number),
        );
        for bad in [-1.0, f32::NAN, f32::INFINITY] {
            expect(
                Status::Extinction,
                woodcock_fog_flight(bad, 1.0, s, &mut flight),
            );
            expect(
                Status::Extinction,
                woodcock_fog_transmittance(bad, 1.0, &mut number),
            );
            expect(
                Status::Extinction,
                woodcock_field_flight(Some(field), null_mut(), bad, &WITHIN, s, &mut flight),
            );
        }
        // A function that exceeds its bound, is negative, or is no number.
        for mut factor in [1e3_f32, -1e3, f32::NAN] {
            let data = (&raw mut factor).cast();
            let found =
                woodcock_field_transmittance(Some(field), data, 4.0, &WITHIN, s, &mut number);
            expect(Status::Extinction, found);
        }
        expect(
            Status::Work,
            woodcock_field_flight(Some(field), null_mut(), 1e6, &WITHIN, s, &mut flight),
        );
        let dense = tables
            .open_as(DIMS, EDGE, IDENTITY, 1e7)
            .expect("a dense grid");
        expect(
            Status::Work,
            woodcock_grid_transmittance(&dense, &RAY, s, &mut number),
        );
        expect(
            Status::Work,
            woodcock_grid_flight(&dense, &RAY, s, &mut flight),
        );
        expect(Status::Phase, woodcock_phase_eval(3, 0.0, 0.0, &mut number));
        expect(
            Status::Phase,
            woodcock_phase_eval(-1, 0.0, 0.0, &mut number),
        );
        expect(
            Status::MeanCosine,
            woodcock_phase_eval(1, 1.0, 0.0, &mut number),
        );
        expect(
            Status::MeanCosine,
            woodcock_phase_eval(1, f32::NAN, 0.0, &mut number),
        );
        expect(
            Status::Cosine,
            woodcock_phase_eval(1, 0.0, 1.1, &mut number),
        );
        expect(
            Status::Cosine,
            woodcock_phase_eval(1, 0.0, f32::NAN, &mut number),
        );
        expect(
            Status::Unopened,
            woodcock_grid_flight(&closed, &RAY, s, &mut flight),
        );
        let (mut walk, mut segment) = (
            OpaqueWalk([0; 24]),
            Segment {
                majorant: 0.0,
                t0: 0.0,
                t1: 0.0,
            },
        );
        expect(
            Status::Unopened,
            woodcock_walk_next(&mut walk, &grid, &mut segment),
        );
        expect(
            Status::Unopened,
            woodcock_walk_begin(&mut walk, &closed, &RAY),
        );
        expect(Status::Ok, woodcock_walk_begin(&mut walk, &grid, &RAY));
        expect(
            Status::Ray,
            woodcock_walk_extinction(&walk, &grid, f32::NAN, &mut number),
        );
    }
    expect(Status::Dimensions, open([1, 2, 34], EDGE, IDENTITY, 1.0));
    expect(Status::Edge, open(DIMS, 5, IDENTITY, 1.0));
    expect(Status::Edge, open(DIMS, 0, IDENTITY, 1.0));
    expect(Status::Length, open([2, 17, 3], EDGE, IDENTITY, 1.0));
    expect(Status::Length, open(DIMS, 8, IDENTITY, 1.0));
    expect(Status::Placement, open(DIMS, EDGE, IDENTITY, -1.0));
    expect(
        Status::Placement,
        open(DIMS, EDGE, IDENTITY, 1e39_f64 as f32),
    );
    expect(Status::Placement, open(DIMS, EDGE, [[f32::NAN; 4]; 3], 1.0));
    for (place, value, expected) in [
        (25, 0.1, Status::Bound),
        (0, 1.0, Status::Rim),
        (25, -9.0, Status::Bound),
    ] {
        let mut wrong = Tables::new();
        wrong.majorants[place] = value;
        let found = wrong.open_as(DIMS, EDGE, IDENTITY, 1.0);
        expect(expected, found.err().unwrap_or(Status::Ok));
    }
    // A leap that is too long, in a grid with an empty block.
    let mut wrong = Tables::new();
    wrong.samples.fill(0.0);
    assert_eq!(wrong.fill(), Status::Ok);
    wrong.samples[16] = 0.0;
    wrong.majorants[25] = -16_777_215.0;
    expect(
        Status::Leap,
        wrong
            .open_as(DIMS, EDGE, IDENTITY, 1.0)
            .err()
            .unwrap_or(Status::Ok),
    );
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        let mut wrong = Tables::new();
        wrong.samples[3] = bad;
        expect(Status::Sample, wrong.fill());
        expect(
            Status::Sample,
            wrong
                .open_as(DIMS, EDGE, IDENTITY, 1.0)
                .err()
                .unwrap_or(Status::Ok),
        );
    }
    // What fails draws nothing and writes nothing, but for numbers drawn before a function broke its word.
    assert_eq!((flight, number), (NO_FLIGHT, -1.0));
    assert_eq!(stream.0, before);
    // Every status was seen but the one that stands for none.
    for status in 0..20 {
        assert!(
            seen.iter().any(|seen| *seen as i32 == status),
            "status {status}"
        );
    }
}

#[test]
fn every_status_has_a_text_of_its_own() {
    let text = |status| {
        // SAFETY: texts are static and end with zero.
        unsafe { CStr::from_ptr(woodcock_error_text(status)) }
            .to_str()
            .expect("ASCII")
    };
    let mut texts: Vec<&str> = (0..=20).map(text).collect();
    for strange in [-1, 21, i32::MIN, i32::MAX] {
        assert_eq!(text(strange), "no such status");
        assert!(!texts.contains(&text(strange)));
    }
    texts.sort_unstable();
    texts.dedup();
    assert_eq!(texts.len(), 21);
}

#[test]
fn counts_are_those_of_the_core_or_none() {
    // SAFETY: pointers to what they should, or null.
    let count = |dims: [u32; 3], edge| unsafe { woodcock_majorant_count(&dims, edge) };
    assert_eq!(count(DIMS, 4), 6 * 3 * 3);
    assert_eq!(count([65, 65, 65], 8), 1000);
    for (dims, edge) in [
        ([1, 9, 9], 8),
        ([9, 9, 9], 7),
        ([u32::MAX; 3], 4),
        ([0; 3], 0),
    ] {
        assert_eq!(count(dims, edge), 0);
    }
    // SAFETY: null is not followed.
    assert_eq!(unsafe { woodcock_majorant_count(null(), 8) }, 0);
}
