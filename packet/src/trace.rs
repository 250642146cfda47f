//! Whole paths, eight at a time.

use woodcock_core::path::{Counts, Geometry, PathSample, Paths, Scene, Stage, Tapped};
use woodcock_core::points::{self, Strata};
use woodcock_core::real::{Mask, Real};
use woodcock_core::stream::{Key, KeyedStream};

use crate::bits::LaneStream;
use crate::lanes::{LANES, LaneMask, Lanes};

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
    loop {
        let running = paths.running().bits();
        if running != 0xff {
            let mut begun = 0_u32;
            let (mut x, mut y) = (Lanes::zero(), Lanes::zero());
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
                    x.set_lane(lane, request.x as f32);
                    y.set_lane(lane, request.y as f32);
                    paths.stream().set_key(lane, request.key);
                    if scene.settings.points {
                        paths.strata().set(lane, bank.strata(request.key));
                    }
                }
            }
            if begun != 0 {
                paths.launch(scene, x, y, LaneMask::from_bits(begun));
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
        paths.strata().set(0, points::strata(request.key));
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
