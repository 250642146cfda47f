//! Whole paths, eight at a time.

use woodcock_core::medium::Controlled;
use woodcock_core::path::{self, Counts, Geometry, PathSample, Paths, Scene, Stage, Tapped};
use woodcock_core::points::{self, LaneStrata};
use woodcock_core::real::{Mask, Word32};
use woodcock_core::stream::{Key, KeyedStream, PathStream};

use crate::bits::LaneStream;
use crate::lanes::{LANES, LaneMask, LaneWords, Lanes};
use crate::queue::{Bank, Next, Queue, Ready};

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
    mut land: impl FnMut(usize, PathSample),
) -> Counts
where
    M: Tapped<Lanes>,
    G: Geometry<Lanes> + ?Sized,
{
    let mut paths =
        Paths::<Lanes, M::Walk, LaneStream, CHROMATIC, ANY_RAYLEIGH>::idle(scene.medium);
    let mut queue = Queue::new(requests);
    let mut owners = [0_usize; LANES];
    let mut held = 0_u32;
    let mut ready = Ready::default();
    let combs = Paths::<Lanes, M::Walk, LaneStream, CHROMATIC, ANY_RAYLEIGH>::combs::<M, G>(scene);
    loop {
        let mut running = paths.running().bits();
        if running != 0xff && combs {
            paths.branch(scene);
            running = paths.running().bits();
        }
        if running != 0xff {
            let mut begun = 0_u32;
            for (lane, owner) in owners.iter_mut().enumerate() {
                let bit = 1 << lane;
                if running & bit != 0 {
                    continue;
                }
                if held & bit != 0 {
                    land(*owner, paths.sample(lane));
                    held &= !bit;
                }
                if let Some(place) = queue.next(scene, combs, paths.counts_mut(), &mut land) {
                    *owner = queue.owners[place];
                    held |= bit;
                    begun |= bit;
                    ready.copy(lane, &queue.ready, place);
                    if M::SHINES {
                        ready.copy_glow(lane, &queue.ready, place);
                    }
                }
            }
            if begun != 0 {
                let begun = LaneMask::from_bits(begun);
                let [low, high] = ready.state.map(LaneWords::new);
                paths.stream().set_states(low, high, begun);
                if combs {
                    paths.launch_glowing(&ready.start(begun), &ready.glow(), begun);
                    paths.branch(scene);
                } else {
                    paths.launch_at(&ready.start(begun), begun);
                }
            }
            if held == 0 {
                return *paths.counts();
            }
        }
        // The fullest stage, whatever it costs: lanes that wait cost as much as steps that run half empty.
        let at = |stage| paths.at(stage).count();
        let [track, collide, scatter, enter] =
            [Stage::Track, Stage::Collide, Stage::Scatter, Stage::Enter].map(at);
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
        counts.steps += 1;
        counts.busy_lanes += begun as u64;
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
    counts.steps += 1;
    counts.busy_lanes += 1;
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
    let mut paths = Paths::<f32, M::Walk, PathStream, CHROMATIC, ANY_RAYLEIGH>::idle(scene.medium);
    KeyedStream::<f32>::set_key(paths.stream(), 0, request.key);
    if scene.settings.points {
        let strata = points::strata(request.key).words().map(Word32);
        let common = Word32(points::common(request.key));
        paths.set_strata(LaneStrata::new(strata).with_common(common), true);
    }
    paths.launch(scene, request.x as f32, request.y as f32, true);
    while paths.running() {
        for stage in [Stage::Track, Stage::Collide, Stage::Scatter, Stage::Enter] {
            if paths.at(stage) {
                paths.step(scene, stage);
            }
        }
        if Paths::<f32, M::Walk, PathStream, CHROMATIC, ANY_RAYLEIGH>::combs(scene) {
            paths.branch(scene);
        }
    }
    counts.add(paths.counts());
    paths.sample(0)
}
