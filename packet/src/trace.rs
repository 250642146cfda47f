//! Whole paths, sixteen at a time; eight in WebAssembly.

use woodcock_core::medium::{Controlled, Medium};
use woodcock_core::path::{
    self, Counts, Geometry, NoSurfaces, PathSample, Paths, Scene, Stage, Start, Surfaces, Tapped,
};
use woodcock_core::points::{self, LaneStrata};
use woodcock_core::ray::{FAR, Ray};
use woodcock_core::real::{Mask, Word32};
use woodcock_core::stream::{Key, PathStream};

use crate::lanes::{LANES, LaneMask, Lanes};
use crate::queue::{Bank, Next, Queue};

pub use width::PathLanes;
use width::{Streams, WIDTH};

// Two vectors of eight hide each other's latency. WebAssembly's hold four numbers: there sixteen lanes do not fit in registers, and eight
// trace clouds 1.2 and fog 1.3 times as fast as sixteen, with kernels half as large.
#[cfg(not(target_family = "wasm"))]
mod width {
    use crate::bits::LaneStream;
    use crate::both::{Both, Wide};

    /// What whole paths run in.
    pub type PathLanes = Wide;
    pub(super) type Streams = Both<LaneStream>;
    pub(super) use crate::both::WIDTH;
}
#[cfg(target_family = "wasm")]
mod width {
    use crate::bits::LaneStream;
    use crate::lanes::Lanes;

    /// What whole paths run in.
    pub type PathLanes = Lanes;
    pub(super) type Streams = LaneStream;
    pub(super) use crate::lanes::LANES as WIDTH;
}

/// A bit for every lane.
const ALL: u32 = (1 << WIDTH) - 1;

/// Lanes that wait to look or to be shaded, from which on they do, whatever else is to be done.
const QUEUED: u32 = 4;

/// A path in scalar code.
type ScalarPaths<M, H, const CHROMATIC: bool, const ANY_RAYLEIGH: bool> =
    Paths<f32, <M as Medium<f32>>::Walk, PathStream, CHROMATIC, ANY_RAYLEIGH, H>;

/// The paths of all lanes.
type WidePaths<M, H, const CHROMATIC: bool, const ANY_RAYLEIGH: bool> =
    Paths<PathLanes, <M as Medium<PathLanes>>::Walk, Streams, CHROMATIC, ANY_RAYLEIGH, H>;

/// A path to trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathRequest {
    /// Column of its pixel.
    pub x: u32,
    /// Row of its pixel.
    pub y: u32,
    /// Its random numbers.
    pub key: Key,
}

/// Traces the requested paths and hands each sample to `land(index, sample)`, in any order.
///
/// The sample of a request is a pure function of it and of the scene: it has the same bits in
/// [`trace_scalar`], in any lane, whatever else is requested.
pub fn trace<M, G, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>(
    scene: &Scene<'_, M, G>,
    requests: impl IntoIterator<Item = PathRequest>,
    land: impl FnMut(usize, PathSample),
) -> Counts
where
    M: Tapped<Lanes> + Tapped<PathLanes>,
    G: Geometry<Lanes> + Geometry<PathLanes> + ?Sized,
{
    trace_among::<M, G, _, CHROMATIC, ANY_RAYLEIGH>(scene, NoSurfaces, requests, land)
}

/// The same among surfaces, whose `places` (see [`Surfaces::sight`]) are below [`LANES`] and whose lanes below [`both::WIDTH`](crate::both::WIDTH).
pub fn trace_among<M, G, H, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>(
    scene: &Scene<'_, M, G>,
    surfaces: H,
    requests: impl IntoIterator<Item = PathRequest>,
    mut land: impl FnMut(usize, PathSample),
) -> Counts
where
    M: Tapped<Lanes> + Tapped<PathLanes>,
    G: Geometry<Lanes> + Geometry<PathLanes> + ?Sized,
    H: Surfaces,
{
    let mut paths = WidePaths::<M, H, CHROMATIC, ANY_RAYLEIGH>::idle(scene.medium, surfaces);
    let mut queue = Queue::new(requests);
    let mut owners = [0_usize; WIDTH];
    // Lanes with an owner, one bit each.
    let mut held = 0_u32;
    let combs = WidePaths::<M, H, CHROMATIC, ANY_RAYLEIGH>::combs(scene);
    let alone = WidePaths::<M, H, CHROMATIC, ANY_RAYLEIGH>::sets_out_from_marks(scene);
    loop {
        let mut running = paths.running().bits();
        if running != ALL && combs {
            paths.branch(scene);
            running = paths.running().bits();
        }
        let mut free = !running & ALL;
        if free != 0 {
            while free != 0 {
                let lane = free.trailing_zeros() as usize % WIDTH;
                let bit = free & free.wrapping_neg();
                free ^= bit;
                if held & bit != 0 {
                    land(owners[lane], paths.sample(lane));
                    held ^= bit;
                }
                if let Some(place) = queue.next(scene, combs, paths.outside(), &mut land) {
                    owners[lane] = queue.owners[place];
                    held |= bit;
                    paths.stream().set_state(lane, queue.ready.stream(place));
                    let mut start = queue.ready.start(place);
                    if H::ANY {
                        start.first.found = queue.ready.enters(place);
                    }
                    paths.launch(lane, &start, alone);
                    if combs {
                        paths.launch_glowing(lane, &start.ray, &queue.ready.glow(place));
                    }
                    if H::ANY {
                        let distance = queue.ready.distance(place);
                        paths.launch_among(lane, (distance < FAR).then_some(place), distance);
                    }
                }
            }
            if combs {
                paths.branch(scene);
            }
            if held == 0 {
                return *paths.counts();
            }
        }
        // The fullest stage, whatever it costs: lanes that wait cost as much as steps that run half empty.
        let at = |stage| paths.at(stage).count();
        let [track, collide, scatter, enter] =
            [Stage::Track, Stage::Collide, Stage::Scatter, Stage::Enter].map(at);
        if H::ANY {
            // Lanes that are served one by one gain little by waiting for company.
            let [look, shade] = [Stage::Look, Stage::Shade].map(at);
            let enough = track.max(collide).max(scatter).max(enter).clamp(1, QUEUED);
            if shade >= enough {
                paths.shade(scene);
                continue;
            }
            if look >= enough {
                paths.look();
                continue;
            }
        }
        if track >= collide && track >= scatter && track >= enter {
            paths.track(scene);
        } else if collide >= scatter && collide >= enter {
            paths.collide(scene);
        } else if scatter >= enter {
            paths.scatter(scene);
        } else {
            paths.enter(scene);
        }
    }
}

/// Renders the requested paths of a scene that only absorbs; else as [`trace`].
///
/// Eight rays at a time, next to each other in the picture and so about equally long.
pub fn absorb<M, G, const CHROMATIC: bool>(
    scene: &Scene<'_, M, G>,
    requests: impl IntoIterator<Item = PathRequest>,
    mut land: impl FnMut(usize, PathSample),
) -> Counts
where
    M: Tapped<Lanes> + Controlled<Lanes>,
    G: Geometry<Lanes> + ?Sized,
{
    let mut counts = Counts::default();
    let mut bank = Bank::default();
    let mut next = Next::default();
    let mut requests = requests.into_iter();
    let mut done = 0;
    loop {
        let bank = scene.settings.points.then_some(&mut bank);
        let begun = next.take(&mut requests, bank);
        if begun == 0 {
            return counts;
        }
        let lanes = LaneMask::from_bits((1 << begun) - 1);
        let (mut stream, place, strata) = next.begin(lanes);
        let found = path::absorb::<Lanes, M, G, CHROMATIC>(
            scene,
            place,
            &strata,
            &mut stream,
            lanes,
            &mut counts,
        );
        counts.add_step(LANES, begun as u32);
        for lane in 0..begun {
            land(done + lane, path::sample_of(&found, lane));
        }
        done += begun;
    }
}

/// Renders one path of a scene that only absorbs in scalar code: the oracle of [`absorb`].
pub fn absorb_scalar<M, G, const CHROMATIC: bool>(
    scene: &Scene<'_, M, G>,
    request: PathRequest,
    counts: &mut Counts,
) -> PathSample
where
    M: Tapped<f32> + Controlled<f32>,
    G: Geometry<f32> + ?Sized,
{
    let mut stream = PathStream::new(request.key);
    let strata = points::strata(request.key).words().map(Word32);
    let place = [request.x as f32, request.y as f32];
    let strata = LaneStrata::new(strata);
    let found =
        path::absorb::<f32, M, G, CHROMATIC>(scene, place, &strata, &mut stream, true, counts);
    counts.add_step(1, 1);
    path::sample_of(&found, 0)
}

/// Traces one path in scalar code: the oracle of [`trace`].
pub fn trace_scalar<M, G, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>(
    scene: &Scene<'_, M, G>,
    request: PathRequest,
    counts: &mut Counts,
) -> PathSample
where
    M: Tapped<f32>,
    G: Geometry<f32> + ?Sized,
{
    let none = NoSurfaces;
    trace_scalar_among::<M, G, _, CHROMATIC, ANY_RAYLEIGH>(scene, none, request, counts)
}

/// Traces one path among surfaces in scalar code: the oracle of [`trace_among`].
pub fn trace_scalar_among<M, G, H, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>(
    scene: &Scene<'_, M, G>,
    surfaces: H,
    request: PathRequest,
    counts: &mut Counts,
) -> PathSample
where
    M: Tapped<f32>,
    G: Geometry<f32> + ?Sized,
    H: Surfaces,
{
    let mut stream = PathStream::new(request.key);
    let strata = if scene.settings.points {
        let common = Word32(points::common(request.key));
        LaneStrata::new(points::strata(request.key).words().map(Word32)).with_common(common)
    } else {
        LaneStrata::idle()
    };
    let place = [request.x as f32, request.y as f32];
    let start = Start::new(scene, place, strata, &mut stream, true);
    let mut paths = ScalarPaths::<M, H, CHROMATIC, ANY_RAYLEIGH>::idle(scene.medium, surfaces);
    let combs = ScalarPaths::<M, H, CHROMATIC, ANY_RAYLEIGH>::combs(scene);
    let glow = combs.then(|| path::glow(scene, &start, &mut stream, true, paths.outside().0));
    *paths.stream() = stream;
    paths.launch(
        0,
        &start,
        ScalarPaths::<M, H, CHROMATIC, ANY_RAYLEIGH>::sets_out_from_marks(scene),
    );
    if let Some(glow) = &glow {
        paths.launch_glowing(0, &start.ray, glow);
        paths.branch(scene);
    }
    if H::ANY {
        let distance = sight(paths.outside().1, 0, &start.ray);
        paths.launch_among(0, (distance < FAR).then_some(0), distance);
    }
    while paths.running() {
        for stage in [Stage::Track, Stage::Collide, Stage::Scatter, Stage::Enter] {
            if paths.at(stage) {
                paths.step(scene, stage);
            }
        }
        if H::ANY {
            for stage in [Stage::Look, Stage::Shade] {
                if paths.at(stage) {
                    paths.step(scene, stage);
                }
            }
        }
        if combs {
            paths.branch(scene);
        }
    }
    counts.add(paths.counts());
    paths.sample(0)
}

/// Looks along the camera ray that waits at a place: the distance of the first surface, [`FAR`] if there is none.
pub(crate) fn sight(surfaces: &mut impl Surfaces, place: usize, ray: &Ray<f32>) -> f32 {
    if path::clearance(surfaces.enclosures(), ray, Word32(path::NO_PLANE)) < FAR {
        surfaces.sight(place, ray.origin.lane(0), ray.direction.lane(0))
    } else {
        FAR
    }
}
