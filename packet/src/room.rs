//! Paths in rooms, eight at a time.

use woodcock_core::path::{Counts, PathSample};
use woodcock_core::points::{self, LaneStrata};
use woodcock_core::real::{Mask, Word32};
use woodcock_core::room::{Room, Walks};
use woodcock_core::stream::{KeyedStream, PathStream};

use crate::bits::LaneStream;
use crate::lanes::{LANES, LaneMask, LaneWords, Lanes};
use crate::queue::{Bank, Next};
use crate::trace::PathRequest;

/// Traces the requested paths and hands each sample to `land(index, sample)`, in any order.
///
/// The sample of a request is a pure function of it and of the room: it has the same bits in [`trace_scalar`], in any
/// lane, whatever else is requested.
pub fn trace(
    room: &Room<'_>,
    requests: impl IntoIterator<Item = PathRequest>,
    mut land: impl FnMut(usize, PathSample),
) -> Counts {
    let mut walks = Walks::<Lanes, LaneStream>::idle();
    let mut waiting = requests.into_iter().enumerate();
    let mut owners = [0_usize; LANES];
    let mut held = 0_u32;
    let mut bank = Bank::default();
    let mut next = Next::default();
    loop {
        let running = walks.running().bits();
        if running != 0xff {
            let mut begun = 0_u32;
            for (lane, owner) in owners.iter_mut().enumerate() {
                let bit = 1 << lane;
                if running & bit != 0 {
                    continue;
                }
                if held & bit != 0 {
                    land(*owner, walks.sample(lane));
                    held &= !bit;
                }
                if let Some((index, request)) = waiting.next() {
                    *owner = index;
                    held |= bit;
                    begun |= bit;
                    next.set(lane, &request);
                    if room.points {
                        next.set_strata(lane, bank.strata(request.key));
                    }
                }
            }
            if begun != 0 {
                let begun = LaneMask::from_bits(begun);
                let [low, high] = next.state.map(LaneWords::new);
                walks.stream().set_states(low, high, begun);
                let strata = LaneStrata::new(next.strata.map(LaneWords::new));
                walks.launch(room, next.place.map(Lanes::new), &strata, begun);
            }
            if held == 0 {
                return *walks.counts();
            }
        }
        walks.step(room);
    }
}

/// Traces one path in scalar code: the oracle of [`trace`].
pub fn trace_scalar(room: &Room<'_>, request: PathRequest, counts: &mut Counts) -> PathSample {
    let mut walks = Walks::<f32, PathStream>::idle();
    KeyedStream::<f32>::set_key(walks.stream(), 0, request.key);
    let strata = points::strata(request.key).words().map(Word32);
    let place = [request.x as f32, request.y as f32];
    walks.launch(room, place, &LaneStrata::new(strata), true);
    while walks.running() {
        walks.step(room);
    }
    counts.add(walks.counts());
    walks.sample(0)
}
