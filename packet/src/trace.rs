//! Whole paths, eight at a time.

use woodcock_core::path::{Counts, Geometry, PathSample, Paths, Scene, Stage, Tapped};
use woodcock_core::points::{self, LaneStrata, Strata};
use woodcock_core::real::{Mask, Word32};
use woodcock_core::stream::{Key, KeyedStream};

use crate::bits::LaneStream;
use crate::lanes::{LANES, LaneMask, LaneWords, Lanes};

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

/// A stage runs when this many lanes wait for it, or when nothing fuller does. Scattering is dear, and
/// so is finding a stretch; moving to a tentative collision is cheap.
const FULL_ENOUGH: u32 = 4;

/// What new paths begin with, by lane: written one by one, read all at once.
#[derive(Debug, Default)]
struct Next {
    place: [[f32; LANES]; 2],
    state: [[u32; LANES]; 2],
    strata: [[u32; LANES]; 2],
}

impl Next {
    #[inline(always)]
    fn set(&mut self, lane: usize, request: &PathRequest) {
        let state = request.key.initial_state();
        self.place[0][lane] = request.x as f32;
        self.place[1][lane] = request.y as f32;
        self.state[0][lane] = state as u32;
        self.state[1][lane] = (state >> 32) as u32;
    }

    #[inline(always)]
    fn set_strata(&mut self, lane: usize, strata: Strata) {
        let [low, high] = strata.words();
        self.strata[0][lane] = low;
        self.strata[1][lane] = high;
    }

    #[inline(always)]
    fn launch<M, G, const CHROMATIC: bool, const ANY_RAYLEIGH: bool>(
        &self,
        scene: &Scene<'_, M, G>,
        paths: &mut Paths<Lanes, M::Walk, LaneStream, CHROMATIC, ANY_RAYLEIGH>,
        lanes: LaneMask,
    ) where
        M: Tapped<Lanes>,
        G: Geometry<Lanes> + ?Sized,
    {
        let [low, high] = self.state.map(LaneWords::new);
        paths.stream().set_states(low, high, lanes);
        if scene.settings.points {
            let strata = LaneStrata::new(self.strata.map(LaneWords::new));
            paths.set_strata(strata, lanes);
        }
        let [x, y] = self.place.map(Lanes::new);
        paths.launch(scene, x, y, lanes);
    }
}

/// The strata of the replicate that was asked for last: paths come in the order of their samples.
#[derive(Debug, Default)]
struct Bank {
    of: Option<Key>,
    strata: [Strata; points::REPLICATE as usize],
}

impl Bank {
    #[inline]
    fn strata(&mut self, key: Key) -> Strata {
        let first = Key {
            sample: key.sample / points::REPLICATE,
            ..key
        };
        if self.of != Some(first) {
            self.of = Some(first);
            self.strata = points::replicate(key);
        }
        self.strata[(key.sample % points::REPLICATE) as usize]
    }
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
    let mut waiting = requests.into_iter().enumerate();
    let mut owners = [0_usize; LANES];
    let mut held = 0_u32;
    let mut bank = Bank::default();
    let mut next = Next::default();
    loop {
        let running = paths.running().bits();
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
                if let Some((index, request)) = waiting.next() {
                    *owner = index;
                    held |= bit;
                    begun |= bit;
                    next.set(lane, &request);
                    if scene.settings.points {
                        next.set_strata(lane, bank.strata(request.key));
                    }
                }
            }
            if begun != 0 {
                let begun = LaneMask::from_bits(begun);
                next.launch(scene, &mut paths, begun);
            }
            if held == 0 {
                return *paths.counts();
            }
        }
        // Move lanes on until enough of them wait at something dear.
        while paths.at(Stage::Track).any() && paths.at(Stage::Collide).count() < FULL_ENOUGH {
            paths.track(scene);
        }
        let counts =
            [Stage::Collide, Stage::Scatter, Stage::Enter].map(|stage| paths.at(stage).count());
        let [collide, scatter, enter] = counts;
        if collide >= scatter && collide >= enter {
            paths.collide(scene);
        } else if scatter >= enter {
            paths.scatter(scene);
        } else {
            paths.enter(scene);
        }
    }
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
    use woodcock_core::stream::PathStream;
    let mut paths = Paths::<f32, M::Walk, PathStream, CHROMATIC, ANY_RAYLEIGH>::idle(scene.medium);
    KeyedStream::<f32>::set_key(paths.stream(), 0, request.key);
    if scene.settings.points {
        let strata = points::strata(request.key).words().map(Word32);
        paths.set_strata(LaneStrata::new(strata), true);
    }
    paths.launch(scene, request.x as f32, request.y as f32, true);
    while paths.running() {
        for stage in [Stage::Track, Stage::Collide, Stage::Scatter, Stage::Enter] {
            if paths.at(stage) {
                paths.step(scene, stage);
            }
        }
    }
    counts.add(paths.counts());
    paths.sample(0)
}
