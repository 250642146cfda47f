//! The one walk of scalar code: tentative collisions along a ray, in order, whatever media it meets.
//!
//! Each medium on the ray is a Poisson process of rate σ̄ of its own. Where media overlap their processes are
//! merged by distance, which is the process of the summed bound: so coefficients add, in colour too, and
//! whoever scores at tentative collisions may do so before the first real one.
//!
//! ```text
//! stretch  ├───────── fog ─────────────────────────────┤
//! stretch           ├──── smoke ────┤
//! visited  ·    ·    ×  · × ·  ×   ·       ·      ·        in order of distance
//! ```

use glam::DVec3;
use woodcock_core::majorant::{GridWalk, Tracker};
use woodcock_core::medium::Medium as _;
use woodcock_core::path::{Counts, OneGrid, OneHomogeneous, RecordKind, Tapped};
use woodcock_core::ray::Ray as CoreRay;
use woodcock_core::vec3::Vec3;

use super::Draws;
use crate::ray::Ray;
use crate::world::{CloudField, Local, Medium, Tables, World};

/// A part of a ray within one medium: from, to \[length\], which.
pub(crate) type Stretch = (f64, f64, usize);

/// A tentative collision.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tentative {
    /// Distance along the ray.
    pub(crate) t: f64,
    /// The place.
    pub(crate) place: DVec3,
    /// Of which medium.
    pub(crate) medium: usize,
    /// Which sample of its grid was looked up.
    pub(crate) tap: Option<u32>,
    /// The rate of that medium's process here [1/length].
    pub(crate) majorant: f64,
    /// What the medium is here, by one tap.
    pub(crate) local: Local,
}

/// What a visitor wants next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Next {
    /// The next tentative collision.
    On,
    /// No further one.
    Stop,
}

/// A medium's process on one stretch.
#[derive(Debug)]
enum Runner<'a> {
    Homogeneous(OneHomogeneous, Tracker<f32, ()>),
    Grid(OneGrid<'a>, Tracker<f32, GridWalk<f32>>),
    Cloud(CloudField<'a>, Tracker<f32, GridWalk<f32>>),
}

/// A process under way, and its next tentative collision.
#[derive(Debug)]
struct Running<'a> {
    from: f64,
    medium: usize,
    runner: Runner<'a>,
    next: f64,
}

/// Moves to the next tentative collision; `false` where the stretch ends first.
fn advance<M: woodcock_core::medium::Medium<f32>>(
    medium: &M,
    tracker: &mut Tracker<f32, M::Walk>,
    counts: &mut Counts,
) -> bool {
    loop {
        counts.majorant_cells += 1;
        let advance = tracker.advance(medium, true);
        if advance.tentative {
            return true;
        }
        if advance.left {
            return false;
        }
    }
}

fn begin<'a, M: woodcock_core::medium::Medium<f32>>(
    medium: M,
    ray: &CoreRay<f32>,
    length: f32,
    draws: &mut impl Draws,
    wrap: impl FnOnce(M, Tracker<f32, M::Walk>) -> Runner<'a>,
) -> Runner<'a> {
    let mut tracker = Tracker::idle(medium.idle());
    medium.begin(&mut tracker.walk, ray, true);
    tracker.begin(length, draws, true);
    wrap(medium, tracker)
}

impl<'a> Running<'a> {
    /// Begins a stretch and moves to its first tentative collision; `None` if it has none.
    fn new(
        world: &'a World,
        ray: &Ray,
        (from, to, medium): Stretch,
        draws: &mut impl Draws,
        counts: &mut Counts,
    ) -> Option<Self> {
        let description = world.media.get(medium)?;
        let vec3 = |v: DVec3| Vec3::splat(v.as_vec3().to_array());
        let local = CoreRay {
            origin: vec3(ray.at(from)),
            direction: vec3(ray.direction),
        };
        let length = (to - from) as f32;
        draws.end_nulls();
        let tables = &world.tables;
        let runner = match (description.cloud_field(tables), &description.record.kind) {
            (Some(cloud), _) => begin(cloud, &local, length, draws, Runner::Cloud),
            (None, RecordKind::Homogeneous) => {
                let medium = OneHomogeneous::new(&description.record);
                begin(medium, &local, length, draws, Runner::Homogeneous)
            }
            (None, RecordKind::Grid { .. }) => {
                let medium = tables.one_grid(&description.record);
                begin(medium, &local, length, draws, Runner::Grid)
            }
        };
        draws.begin_nulls();
        let mut running = Self {
            from,
            medium,
            runner,
            next: 0.0,
        };
        running.advance(counts).then_some(running)
    }

    fn advance(&mut self, counts: &mut Counts) -> bool {
        let (found, t) = match &mut self.runner {
            Runner::Homogeneous(medium, tracker) => (advance(medium, tracker, counts), tracker.t()),
            Runner::Grid(medium, tracker) => (advance(medium, tracker, counts), tracker.t()),
            Runner::Cloud(medium, tracker) => (advance(medium, tracker, counts), tracker.t()),
        };
        self.next = self.from + f64::from(t);
        found
    }

    /// What the medium is at the next tentative collision.
    fn look(
        &self,
        world: &World,
        ray: &Ray,
        draws: &mut impl Draws,
        counts: &mut Counts,
    ) -> Tentative {
        let description = &world.media[self.medium];
        let place = ray.at(self.next);
        let (majorant, tap) = match &self.runner {
            Runner::Homogeneous(medium, tracker) => (tracker.majorant(medium), None),
            Runner::Grid(medium, tracker) => {
                counts.lookups += 1;
                let tap = medium.tap(&tracker.walk, tracker.t(), draws, true);
                (tracker.majorant(medium), Some(tap.0))
            }
            Runner::Cloud(medium, tracker) => {
                counts.lookups += 1;
                (tracker.majorant(medium), None)
            }
        };
        let local = description.local(&world.tables, tap, place);
        counts.tentative_collisions += 1;
        let majorant = f64::from(majorant);
        counts.majorant_violations += u64::from(local.sigma_t.iter().any(|s| *s > majorant));
        Tentative {
            t: self.next,
            place,
            medium: self.medium,
            tap,
            majorant,
            local,
        }
    }

    fn redraw(&mut self, draws: &mut impl Draws) {
        match &mut self.runner {
            Runner::Homogeneous(_, tracker) => tracker.redraw(draws, true),
            Runner::Grid(_, tracker) => tracker.redraw(draws, true),
            Runner::Cloud(_, tracker) => tracker.redraw(draws, true),
        }
    }
}

/// The walk of a grid that stands at a place; `None` for media without samples.
pub(crate) fn stand<'a>(
    medium: &Medium,
    tables: &'a Tables,
    place: DVec3,
) -> Option<(OneGrid<'a>, GridWalk<f32>)> {
    if !medium.has_samples() {
        return None;
    }
    let grid = tables.one_grid(&medium.record);
    let mut walk: GridWalk<f32> = grid.idle();
    let ray = CoreRay {
        origin: Vec3::splat(place.as_vec3().to_array()),
        direction: Vec3::splat([1.0, 0.0, 0.0]),
    };
    grid.begin(&mut walk, &ray, true);
    Some((grid, walk))
}

/// The sample that a look-up by one tap picks at a place; `None` for media without samples.
pub(crate) fn tap_at(
    world: &World,
    medium: usize,
    place: DVec3,
    draws: &mut impl Draws,
) -> Option<u32> {
    let (grid, walk) = stand(world.media.get(medium)?, &world.tables, place)?;
    Some(grid.tap(&walk, 0.0, draws, true).0)
}

/// Visits the tentative collisions of a ray in order of distance, until `visit` stops. Returns whether all were
/// visited: the ray is through.
///
/// * `stretches`: sorted by where they begin, all within the part of the ray that is wanted.
///
/// Draws one exponential a stretch, and for each tentative collision two numbers for a tap on a grid, what `visit`
/// draws, and one exponential. All but the first of each stretch count as null collisions' ([`Draws`]).
pub(crate) fn walk<D: Draws>(
    world: &World,
    ray: &Ray,
    stretches: &[Stretch],
    draws: &mut D,
    counts: &mut Counts,
    mut visit: impl FnMut(&mut D, &Tentative) -> Next,
) -> bool {
    if let [only] = *stretches {
        return walk_one(world, ray, only, draws, counts, visit);
    }
    let mut waiting = stretches.iter().peekable();
    let mut running: Vec<Running<'_>> = Vec::new();
    let through = loop {
        let nearest = (0..running.len()).min_by(|&a, &b| {
            let [a, b] = [a, b].map(|i| running[i].next);
            a.total_cmp(&b)
        });
        let limit = nearest.map_or(f64::INFINITY, |i| running[i].next);
        if let Some(stretch) = waiting.next_if(|stretch| stretch.0 <= limit) {
            running.extend(Running::new(world, ray, *stretch, draws, counts));
            continue;
        }
        let Some(index) = nearest else {
            break true;
        };
        let tentative = running[index].look(world, ray, draws, counts);
        if visit(draws, &tentative) == Next::Stop {
            break false;
        }
        running[index].redraw(draws);
        if !running[index].advance(counts) {
            running.swap_remove(index);
        }
    };
    draws.end_nulls();
    through
}

/// [`walk`] on a single stretch: nothing to be merged, and no list to be kept.
fn walk_one<D: Draws>(
    world: &World,
    ray: &Ray,
    stretch: Stretch,
    draws: &mut D,
    counts: &mut Counts,
    mut visit: impl FnMut(&mut D, &Tentative) -> Next,
) -> bool {
    let Some(mut running) = Running::new(world, ray, stretch, draws, counts) else {
        draws.end_nulls();
        return true;
    };
    let through = loop {
        let tentative = running.look(world, ray, draws, counts);
        if visit(draws, &tentative) == Next::Stop {
            break false;
        }
        running.redraw(draws);
        if !running.advance(counts) {
            break true;
        }
    };
    draws.end_nulls();
    through
}
