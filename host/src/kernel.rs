//! Which kernel renders a world: the parameters of the innermost loops, decided once.

use woodcock_core::medium::Controlled;
use woodcock_core::path::{
    Atlas, Counts, Geometry, MediumRecord, NoSurfaces, OneHomogeneous, PathSample, RecordKind,
    Scene, Shining, Surfaces, Tapped,
};
use woodcock_packet::both::Wide;
use woodcock_packet::lanes::Lanes;
use woodcock_packet::trace::{self, PathRequest};

use crate::integrator::surface_queue::SurfaceQueue;
use crate::render::{Kernel, Plan, Requests};
use crate::world::{Feature, Location, World};

/// Something to be done with the kernel of a world: Rust has no generic closures.
trait Job {
    type Output;
    fn run<M, G, H, const CHROMATIC: bool, const RAYLEIGH: bool>(
        self,
        scene: &Scene<'_, M, G>,
        surfaces: H,
    ) -> Self::Output
    where
        M: AnyMedium,
        G: Geometry<f32> + Geometry<Lanes> + Geometry<Wide> + Sync + ?Sized,
        H: Surfaces;
}

/// A medium for both widths.
trait AnyMedium:
    Tapped<f32> + Controlled<f32> + Tapped<Lanes> + Controlled<Lanes> + Tapped<Wide> + Sync
{
}
impl<M> AnyMedium for M where
    M: Tapped<f32> + Controlled<f32> + Tapped<Lanes> + Controlled<Lanes> + Tapped<Wide> + Sync
{
}

/// Geometry for both widths, behind one pointer: a call a ray, not a call a step.
trait AnyGeometry: Geometry<f32> + Geometry<Lanes> + Geometry<Wide> + Sync {}
impl<G: Geometry<f32> + Geometry<Lanes> + Geometry<Wide> + Sync> AnyGeometry for G {}

/// A ray that meets nothing.
#[derive(Debug)]
struct Nothing;

impl<R: woodcock_core::real::Real> Geometry<R> for Nothing {
    fn overlaps(&self) -> bool {
        false
    }
    fn stretch(
        &self,
        _: &woodcock_core::ray::Ray<R>,
        _: R::Word,
        _: R::Mask,
    ) -> woodcock_core::path::Stretch<R> {
        woodcock_core::path::Stretch::none()
    }
}

/// The medium that a world's kernel is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Homogeneous,
    Grid,
    Several,
}

fn kind(world: &World) -> Kind {
    match world.media.as_slice() {
        // Of several media none shines in packets.
        [_] if world.source.is_some() => Kind::Grid,
        _ if world.needs.runs(Feature::SeveralMedia) => Kind::Several,
        [medium] => match medium.record.kind {
            // Among surfaces there are fewer kernels.
            RecordKind::Homogeneous if world.needs.runs(Feature::SurfaceQueue) => Kind::Several,
            RecordKind::Homogeneous if !world.needs.runs(Feature::Tracking) => Kind::Homogeneous,
            RecordKind::Homogeneous => Kind::Several,
            RecordKind::Grid { .. } => Kind::Grid,
        },
        [] => Kind::Homogeneous,
        _ => Kind::Several,
    }
}

/// The name of the kernel that runs, for `explain` and the statistics.
pub fn kernel_name(world: &World, kernel: Kernel) -> String {
    if world.room.is_some() && !world.needs.runs(Feature::DetailedSurfaces) {
        return format!("{}: a room, met piece by piece", kernel.name());
    }
    if !world.is_plain() {
        return "scalar: surfaces, lights and media of all kinds".to_owned();
    }
    let medium = match kind(world) {
        Kind::Homogeneous => "homogeneous",
        Kind::Grid => "grid",
        Kind::Several => "several media",
    };
    let colour = if world.needs.colours_apart() {
        "grey, colours apart"
    } else if world.needs.runs(Feature::Chromatic) {
        "chromatic"
    } else {
        "grey"
    };
    let queue = if world.needs.runs(Feature::SurfaceQueue) {
        ", surfaces by a queue"
    } else {
        ""
    };
    format!("{}: {medium}, {colour}{queue}", kernel.name())
}

/// Runs a job with the kernel of a world.
///
/// * `colour`: the one whose grey path is traced, where colours have paths of their own.
fn with_kernel<J: Job>(world: &World, plan: &Plan, colour: Option<usize>, job: J) -> J::Output {
    let geometry: &dyn AnyGeometry = match &world.place {
        Location::Nowhere => &Nothing,
        Location::Convex(convex) => convex,
        Location::Boundaries(boundaries) => boundaries,
    };
    let chromatic = world.needs.runs(Feature::Chromatic) && colour.is_none();
    let one = |record: &MediumRecord| colour.map_or(*record, |c| record.of_colour(c));
    let rayleigh = world.needs.runs(Feature::Rayleigh);
    match kind(world) {
        Kind::Homogeneous => {
            let vacuum = || MediumRecord {
                kind: RecordKind::Homogeneous,
                scale: 0.0,
                colour: [1.0; 3],
                albedo: [0.0; 3],
                g: 0.0,
                rayleigh: false,
            };
            let record = world.media.first().map_or_else(vacuum, |m| one(&m.record));
            let medium = OneHomogeneous::new(&record);
            pick(world, plan, &medium, geometry, chromatic, rayleigh, job)
        }
        Kind::Grid => {
            let record = &world.media[0].record;
            let mut medium = world.tables.one_grid(&one(record));
            if let Location::Convex(place) = &world.place {
                medium = medium.within(place);
            }
            match &world.source {
                None if world.needs.runs(Feature::SurfaceQueue) => {
                    let scene = scene(world, plan, &medium, geometry);
                    let surfaces = SurfaceQueue::new(world);
                    if chromatic {
                        job.run::<_, _, _, true, true>(&scene, surfaces)
                    } else {
                        job.run::<_, _, _, false, true>(&scene, surfaces)
                    }
                }
                None => pick(world, plan, &medium, geometry, chromatic, rayleigh, job),
                Some(source) => {
                    let mut source = source.as_source();
                    if let Some(c) = colour {
                        // Absorption relative to this colour's own extinction; without any there is no light either.
                        let own = record.colour[c];
                        let share = if own > 0.0 { 1.0 / own } else { 0.0 };
                        source.absorbed = source.absorbed.map(|a| a * share);
                    }
                    let medium = Shining { medium, source };
                    pick(world, plan, &medium, geometry, chromatic, true, job)
                }
            }
        }
        Kind::Several => {
            let words = |m: &crate::world::Medium| one(&m.record).to_words();
            let of_colour: Vec<u32> = match colour {
                Some(_) => world.media.iter().flat_map(words).collect(),
                None => Vec::new(),
            };
            let medium = Atlas {
                records: if colour.is_some() {
                    &of_colour
                } else {
                    &world.records
                },
                samples: &world.tables.samples,
                majorants: &world.tables.majorants,
            };
            if world.needs.runs(Feature::SurfaceQueue) {
                let scene = scene(world, plan, &medium, geometry);
                return job.run::<_, _, _, true, true>(&scene, SurfaceQueue::new(world));
            }
            // Rare enough that Rayleigh's branch need not be compiled away.
            pick(world, plan, &medium, geometry, chromatic, true, job)
        }
    }
}

fn pick<M, J: Job>(
    world: &World,
    plan: &Plan,
    medium: &M,
    geometry: &dyn AnyGeometry,
    chromatic: bool,
    rayleigh: bool,
    job: J,
) -> J::Output
where
    M: AnyMedium,
{
    let scene = scene(world, plan, medium, geometry);
    match (chromatic, rayleigh) {
        (false, false) => job.run::<_, _, _, false, false>(&scene, NoSurfaces),
        (false, true) => job.run::<_, _, _, false, true>(&scene, NoSurfaces),
        (true, _) => job.run::<_, _, _, true, true>(&scene, NoSurfaces),
    }
}

/// A world as the paths of a plan meet it.
fn scene<'a, M>(
    world: &'a World,
    plan: &Plan,
    medium: &'a M,
    geometry: &'a dyn AnyGeometry,
) -> Scene<'a, M, dyn AnyGeometry + 'a> {
    Scene {
        medium,
        geometry,
        lights: world.lights(),
        camera: &world.camera,
        settings: plan.settings,
    }
}

/// Paths through a world, into a table.
struct Trace<'a, 'r> {
    plan: &'a Plan,
    absorbs: bool,
    requests: Requests<'r>,
    paths: &'a mut [PathSample],
    /// The one that paths are grey in, where colours have paths of their own.
    colour: Option<usize>,
}

impl Job for Trace<'_, '_> {
    type Output = Counts;
    fn run<M, G, H, const CHROMATIC: bool, const RAYLEIGH: bool>(
        self,
        scene: &Scene<'_, M, G>,
        surfaces: H,
    ) -> Counts
    where
        M: AnyMedium,
        G: Geometry<f32> + Geometry<Lanes> + Geometry<Wide> + Sync + ?Sized,
        H: Surfaces,
    {
        let requests = self.requests.iter();
        let (paths, colour) = (self.paths, self.colour);
        let mut land = |index: usize, path: PathSample| match colour {
            None => paths[index] = path,
            Some(colour) => add_colour(&mut paths[index], colour, &path),
        };
        match (self.plan.kernel, self.absorbs) {
            (Kernel::Packet, false) => {
                trace::trace_among::<M, G, H, CHROMATIC, RAYLEIGH>(scene, surfaces, requests, land)
            }
            (Kernel::Packet, true) => trace::absorb::<M, G, CHROMATIC>(scene, requests, land),
            (Kernel::Scalar, absorbs) => {
                let mut counts = Counts::default();
                for (index, request) in requests.enumerate() {
                    let path = trace_one::<M, G, H, CHROMATIC, RAYLEIGH>(
                        scene,
                        surfaces.clone(),
                        absorbs,
                        request,
                        &mut counts,
                    );
                    land(index, path);
                }
                counts
            }
        }
    }
}

/// One path in scalar code.
fn trace_one<M, G, H, const CHROMATIC: bool, const RAYLEIGH: bool>(
    scene: &Scene<'_, M, G>,
    surfaces: H,
    absorbs: bool,
    request: PathRequest,
    counts: &mut Counts,
) -> PathSample
where
    M: AnyMedium,
    G: Geometry<f32> + ?Sized,
    H: Surfaces,
{
    if absorbs {
        trace::absorb_scalar::<M, G, CHROMATIC>(scene, request, counts)
    } else {
        trace::trace_scalar_among::<M, G, H, CHROMATIC, RAYLEIGH>(scene, surfaces, request, counts)
    }
}

/// The seed of a colour's own paths.
fn seed_of(seed: u64, colour: usize) -> u64 {
    const APART: [u64; 3] = [0, 0x3c6e_f372_fe94_f82b, 0xa54f_f53a_5f1d_36f1];
    seed ^ APART[colour]
}

/// Adds what the grey path of one colour brings to the sample of all.
fn add_colour(sample: &mut PathSample, colour: usize, path: &PathSample) {
    sample.radiance[colour] = path.radiance[colour];
    sample.alpha += path.alpha * (1.0 / 3.0);
}

/// Traces the requested paths; their samples land at their places, which hold nothing yet.
pub(crate) fn trace(
    world: &World,
    plan: &Plan,
    requests: Requests<'_>,
    paths: &mut [PathSample],
) -> Counts {
    let absorbs = plan.absorbs(world);
    let mut counts = Counts::default();
    if !world.needs.colours_apart() {
        let job = Trace {
            plan,
            absorbs,
            requests,
            paths,
            colour: None,
        };
        return with_kernel(world, plan, None, job);
    }
    for colour in 0..3 {
        let job = Trace {
            plan,
            absorbs,
            requests: requests.seeded(seed_of(plan.seed, colour)),
            paths,
            colour: Some(colour),
        };
        counts.add(&with_kernel(world, plan, Some(colour), job));
    }
    counts
}

/// One path, again.
struct Replay {
    absorbs: bool,
    request: PathRequest,
}

impl Job for Replay {
    type Output = (PathSample, Counts);
    fn run<M, G, H, const CHROMATIC: bool, const RAYLEIGH: bool>(
        self,
        scene: &Scene<'_, M, G>,
        surfaces: H,
    ) -> Self::Output
    where
        M: AnyMedium,
        G: Geometry<f32> + Geometry<Lanes> + Geometry<Wide> + Sync + ?Sized,
        H: Surfaces,
    {
        let mut counts = Counts::default();
        let path = trace_one::<M, G, H, CHROMATIC, RAYLEIGH>(
            scene,
            surfaces,
            self.absorbs,
            self.request,
            &mut counts,
        );
        (path, counts)
    }
}

/// Traces one path in scalar code: what it brings, and what it met.
pub(crate) fn replay(world: &World, plan: &Plan, request: PathRequest) -> (PathSample, Counts) {
    let absorbs = plan.absorbs(world);
    if !world.needs.colours_apart() {
        return with_kernel(world, plan, None, Replay { absorbs, request });
    }
    let mut all = (PathSample::default(), Counts::default());
    for colour in 0..3 {
        let mut request = request;
        request.key.seed = seed_of(plan.seed, colour);
        let (path, counts) = with_kernel(world, plan, Some(colour), Replay { absorbs, request });
        add_colour(&mut all.0, colour, &path);
        all.1.add(&counts);
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pilot;

    /// A pilot's bad luck must not be the picture's.
    #[test]
    fn colours_and_pilots_have_seeds_of_their_own() {
        for seed in [0, 1, u64::MAX] {
            let of = |seed| (0..3).map(move |colour| seed_of(seed, colour));
            let mut seeds: Vec<u64> = of(seed).chain(of(pilot::seed(seed))).collect();
            seeds.sort_unstable();
            seeds.dedup();
            assert_eq!(seeds.len(), 6);
        }
    }
}
