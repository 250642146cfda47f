//! Grids: bounds over the caller's samples, in the caller's memory, and what tracking makes of them.

use woodcock_core::free_flight::delta;
use woodcock_core::majorant::{
    self, GridWalk, MajorantGrid, block_counts, fill_leaps, fill_slab, majorant_depth,
};
use woodcock_core::medium::{Grid, Medium};
use woodcock_core::ray;
use woodcock_core::stream::PathStream;
use woodcock_core::transmittance::ratio;

use crate::pointer::{self, Place};
use crate::status::{Status, answer};
use crate::stream::{OpaqueStream, with};
use crate::{Flight, Ray, affordable};

/// `woodcock_grid`: memory for an opened grid. Its contents mean nothing to the caller.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OpaqueGrid(pub [u64; 24]);

/// `woodcock_walk`: memory for a walk. Its contents mean nothing to the caller.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct OpaqueWalk(pub [u64; 24]);

/// `woodcock_segment`: a piece of a ray on which one bound holds.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// No extinction on it is larger [1/length].
    pub majorant: f32,
    /// Where it begins \[length along the ray\].
    pub t0: f32,
    /// Where it ends \[length along the ray\].
    pub t1: f32,
}

/// What an opened grid's memory holds.
#[repr(C)]
#[derive(Clone, Copy)]
struct Opened {
    mark: u64,
    /// The largest bound [1/length].
    largest: f32,
    grid: Grid<'static>,
}

/// What a begun walk's memory holds.
#[repr(C)]
#[derive(Clone, Copy)]
struct Walk {
    mark: u64,
    /// Where the ray enters the grid; the others are counted from there \[length\].
    t0: f32,
    t: f32,
    t_end: f32,
    /// One once the first segment was given, else zero.
    under_way: u32,
    walk: GridWalk<f32>,
}

/// What tells memory that was opened from memory that was not: no ordinary number, and another for each kind.
const OPENED: u64 = 0x776f_6f64_6772_6964;
const BEGUN: u64 = 0x776f_6f64_7761_6c6b;

const _: () = assert!(size_of::<Opened>() <= size_of::<OpaqueGrid>());
const _: () = assert!(align_of::<Opened>() <= align_of::<OpaqueGrid>());
const _: () = assert!(size_of::<Walk>() <= size_of::<OpaqueWalk>());
const _: () = assert!(align_of::<Walk>() <= align_of::<OpaqueWalk>());

/// What the memory of a grid or a walk holds, if its mark says so.
///
/// # Safety
/// As for [`pointer::read`]; what bears the mark of a `T` is one.
unsafe fn marked<T: Copy>(memory: *const [u64; 24], mark: u64) -> Result<T, Status> {
    // SAFETY: the caller's word: the mark comes first, and alone may be read if it is another.
    let found = unsafe { pointer::read(memory.cast::<u64>()) }?;
    if found != mark {
        return Err(Status::Unopened);
    }
    // SAFETY: opened by this library, which alone writes marks.
    unsafe { pointer::read(memory.cast::<T>()) }
}

/// How many majorants a grid needs, or zero where there can be no such grid.
///
/// # Safety
/// The pointer leads to three numbers, or is null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_majorant_count(dims: *const [u32; 3], edge: u32) -> usize {
    // SAFETY: the caller's word.
    let Ok(dims) = (unsafe { pointer::read(dims) }) else {
        return 0;
    };
    let possible = majorant::EDGES.contains(&edge) && dims.iter().all(|n| *n >= 2);
    let count = majorant::majorant_count_of(dims, edge);
    count.filter(|_| possible).unwrap_or(0)
}

/// Computes the majorants of a grid of samples, and leaps where blocks are empty.
///
/// # Safety
/// Pointers lead to what their types and counts say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_fill_majorants(
    samples: *const f32,
    sample_count: usize,
    dims: *const [u32; 3],
    edge: u32,
    majorants: *mut f32,
    majorant_count: usize,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word, for all three.
        let (dims, samples, majorants) = unsafe {
            let samples = pointer::table(samples, sample_count)?;
            let majorants = pointer::table_mut(majorants, majorant_count, samples)?;
            (pointer::read(dims)?, samples, majorants)
        };
        if !majorant::EDGES.contains(&edge) {
            return Err(Status::Edge);
        }
        let count = majorant::majorant_count_of(dims, edge).ok_or(Status::Dimensions)?;
        if majorants.len() != count {
            return Err(Status::Length);
        }
        let blocks = block_counts(dims, edge);
        let [across, down, _] = blocks.map(|n| n as usize + 2);
        let slabs = majorants.chunks_exact_mut((across * down).max(1));
        for (slab, entries) in slabs.enumerate() {
            fill_slab(samples, dims, edge, slab, entries)?;
        }
        Ok(fill_leaps(majorants, blocks)?)
    })())
}

/// Proves the majorants of a grid and places it.
///
/// # Safety
/// Pointers lead to what their types and counts say, or are null; samples and majorants stay as they are as long as the grid is used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_open_grid(
    grid: *mut OpaqueGrid,
    samples: *const f32,
    sample_count: usize,
    dims: *const [u32; 3],
    edge: u32,
    majorants: *const f32,
    majorant_count: usize,
    world_to_grid: *const [[f32; 4]; 3],
    scale: f32,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word, for all.
        let (place, dims, samples, majorants, world_to_grid) = unsafe {
            (
                Place::new(grid.cast::<Opened>())?,
                pointer::read(dims)?,
                pointer::table(samples, sample_count)?,
                pointer::table(majorants, majorant_count)?,
                pointer::read(world_to_grid)?,
            )
        };
        let bounds = MajorantGrid::with_edge(samples, dims, edge, majorants)?;
        let grid = Grid::new(bounds, world_to_grid, scale).ok_or(Status::Placement)?;
        place.put(Opened {
            mark: OPENED,
            largest: majorants.iter().fold(0.0_f32, |a, b| a.max(*b)) * scale,
            grid,
        });
        Ok(())
    })())
}

/// The part of a ray in a grid: where it begins, from there on, and how long it is.
struct Part {
    t0: f32,
    along: ray::Ray<f32>,
    length: f32,
}

impl Opened {
    fn part(&self, ray: &Ray) -> Result<Part, Status> {
        let along = ray.checked()?;
        let inside = self.grid.clip(&along);
        let (t0, t1) = (inside.t0, inside.t1.min(ray.t_max));
        // Nothing where the ray misses the grid.
        let (t0, length) = if t0 < t1 { (t0, t1 - t0) } else { (0.0, 0.0) };
        let along = ray::Ray {
            origin: along.at(t0),
            ..along
        };
        Ok(Part { t0, along, length })
    }
}

/// What an estimator makes of the part of a ray in a grid, if that can be waited for.
///
/// # Safety
/// As for the functions that call it.
unsafe fn in_grid<T>(
    grid: *const OpaqueGrid,
    (ray, stream, out): (*const Ray, *mut OpaqueStream, *mut T),
    estimate: impl FnOnce(&Grid<'_>, &Part, f32, &mut PathStream) -> T,
) -> Result<(), Status> {
    // SAFETY: the caller's word, for all three.
    let (place, opened, ray) = unsafe {
        let opened: Opened = marked(grid.cast(), OPENED)?;
        (Place::new(out)?, opened, pointer::read(ray)?)
    };
    let part = opened.part(&ray)?;
    // Seldom in doubt, and then counted.
    if affordable(opened.largest * part.length).is_err() {
        affordable(majorant_depth(&opened.grid, &part.along, part.length, true))?;
    }
    let fly = |rng: &mut PathStream| Ok(estimate(&opened.grid, &part, ray.t_max, rng));
    // SAFETY: the caller's word.
    place.put(unsafe { with(stream, fly) }?);
    Ok(())
}

/// A free flight through a grid, by delta tracking.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_grid_flight(
    grid: *const OpaqueGrid,
    ray: *const Ray,
    stream: *mut OpaqueStream,
    flight: *mut Flight,
) -> Status {
    let fly = |grid: &Grid<'_>, part: &Part, t_max, rng: &mut PathStream| {
        let mut flight = delta::sample(grid, &part.along, part.length, rng, true);
        flight.t = if flight.collided {
            part.t0 + flight.t
        } else {
            t_max
        };
        Flight::new(flight)
    };
    // SAFETY: the caller's word.
    answer(unsafe { in_grid(grid, (ray, stream, flight), fly) })
}

/// An estimate of the transmittance of a ray through a grid, by ratio tracking.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_grid_transmittance(
    grid: *const OpaqueGrid,
    ray: *const Ray,
    stream: *mut OpaqueStream,
    weight: *mut f32,
) -> Status {
    let track = |grid: &Grid<'_>, part: &Part, _, rng: &mut PathStream| {
        ratio::estimate(grid, &part.along, part.length, rng, true)
    };
    // SAFETY: the caller's word.
    answer(unsafe { in_grid(grid, (ray, stream, weight), track) })
}

/// Puts a walk where a ray enters a grid.
///
/// # Safety
/// Pointers lead to what their types say, or are null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_walk_begin(
    walk: *mut OpaqueWalk,
    grid: *const OpaqueGrid,
    ray: *const Ray,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word, for all three.
        let (place, opened, ray) = unsafe {
            let opened: Opened = marked(grid.cast(), OPENED)?;
            (
                Place::new(walk.cast::<Walk>())?,
                opened,
                pointer::read(ray)?,
            )
        };
        let part = opened.part(&ray)?;
        let mut walk: GridWalk<f32> = opened.grid.idle();
        opened.grid.begin(&mut walk, &part.along, true);
        place.put(Walk {
            mark: BEGUN,
            t0: part.t0,
            t: 0.0,
            t_end: part.length,
            under_way: 0,
            walk,
        });
        Ok(())
    })())
}

/// The next segment of a walk, or [`Status::End`].
///
/// # Safety
/// Pointers lead to what their types say, or are null; the grid is the one that the walk was begun in.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_walk_next(
    walk: *mut OpaqueWalk,
    grid: *const OpaqueGrid,
    segment: *mut Segment,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word, for all.
        let (place, grid, mut begun, back) = unsafe {
            let opened: Opened = marked(grid.cast(), OPENED)?;
            let begun: Walk = marked(walk.cast(), BEGUN)?;
            let back = Place::new(walk.cast::<Walk>())?;
            (Place::new(segment)?, opened.grid, begun, back)
        };
        let on = begun.t < begun.t_end;
        if !on {
            return Err(Status::End);
        }
        // Before the first segment the walk stands in it.
        if begun.under_way == 1 {
            grid.next_segment(&mut begun.walk, true);
        }
        begun.under_way = 1;
        let found = grid.segment(&begun.walk);
        let from = begun.t;
        begun.t = found.t_exit.min(begun.t_end).max(from);
        place.put(Segment {
            majorant: found.majorant,
            t0: begun.t0 + from,
            t1: begun.t0 + begun.t,
        });
        back.put(begun);
        Ok(())
    })())
}

/// The extinction at a distance within the present segment of a walk: the interpolant of eight samples.
///
/// # Safety
/// As for [`woodcock_walk_next`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn woodcock_walk_extinction(
    walk: *const OpaqueWalk,
    grid: *const OpaqueGrid,
    t: f32,
    sigma_t: *mut f32,
) -> Status {
    answer((|| {
        // SAFETY: the caller's word, for all.
        let (place, grid, begun) = unsafe {
            let opened: Opened = marked(grid.cast(), OPENED)?;
            let begun: Walk = marked(walk.cast(), BEGUN)?;
            (Place::new(sigma_t)?, opened.grid, begun)
        };
        if !t.is_finite() {
            return Err(Status::Ray);
        }
        // By rounding a walk may end in the rim, where nothing is and the bound is zero.
        let segment = grid.segment(&begun.walk);
        let interpolant: f32 = grid.trilinear(&begun.walk, t - begun.t0);
        place.put(interpolant.min(segment.majorant));
        Ok(())
    })())
}
