//! Requests on their way to lanes.

use woodcock_core::majorant::Mark;
use woodcock_core::path::{
    self, BRANCHES, Counts, Geometry, Glow, PathSample, Scene, Start, Stretch, Surfaces, Tapped,
};
use woodcock_core::points::{self, LaneStrata, Strata};
use woodcock_core::ray::{FAR, Interval, Ray};
use woodcock_core::real::{Mask, Real, Word32};
use woodcock_core::stream::{Key, KeyedStream};
use woodcock_core::vec3::Vec3;

use crate::bits::LaneStream;
use crate::lanes::{LANES, LaneMask, LaneWords, Lanes};
use crate::trace::{PathRequest, sight};

/// What new paths begin with, by lane: written one by one, read all at once.
#[derive(Debug, Default)]
pub(crate) struct Next {
    pub(crate) place: [[f32; LANES]; 2],
    pub(crate) state: [[u32; LANES]; 2],
    pub(crate) strata: [[u32; LANES]; 2],
    pub(crate) common: [u32; LANES],
}

impl Next {
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, request: &PathRequest) {
        let state = request.key.initial_state();
        self.place[0][lane] = request.x as f32;
        self.place[1][lane] = request.y as f32;
        self.state[0][lane] = state as u32;
        self.state[1][lane] = (state >> 32) as u32;
    }

    /// Takes as many requests as there are lanes, or the last of them, and says how many; with strata where there is
    /// a bank.
    #[inline(always)]
    pub(crate) fn take(
        &mut self,
        requests: &mut impl Iterator<Item = PathRequest>,
        mut bank: Option<&mut Bank>,
    ) -> usize {
        let mut taken = 0;
        for (lane, request) in requests.take(LANES).enumerate() {
            self.set(lane, &request);
            if let Some(bank) = &mut bank {
                self.set_strata(lane, bank.strata(request.key));
                self.common[lane] = bank.common;
            }
            taken = lane + 1;
        }
        taken
    }

    /// The streams, pixels and strata of the given lanes.
    #[inline(always)]
    pub(crate) fn begin(&self, lanes: LaneMask) -> (LaneStream, [Lanes; 2], LaneStrata<LaneWords>) {
        let mut stream = LaneStream::idle();
        let [low, high] = self.state.map(LaneWords::new);
        stream.set_states(low, high, lanes);
        let strata = LaneStrata::new(self.strata.map(LaneWords::new))
            .with_common(LaneWords::new(self.common));
        (stream, self.place.map(Lanes::new), strata)
    }

    #[inline(always)]
    pub(crate) fn set_strata(&mut self, lane: usize, strata: Strata) {
        let [low, high] = strata.words();
        self.strata[0][lane] = low;
        self.strata[1][lane] = high;
    }
}

/// Paths that stand ready, as plain numbers: one by one they move to free lanes.
#[derive(Debug, Default)]
pub(crate) struct Ready {
    /// Origin and direction of each ray, beginning and end of its first stretch.
    numbers: [[f32; LANES]; 8],
    medium: [u32; LANES],
    state: [[u32; LANES]; 2],
    strata: [[u32; LANES]; 2],
    mark: Mark<Lanes>,
    /// Radiance, hidden part, number and weight of branches.
    seen: [[f32; LANES]; 6],
    distances: [[f32; LANES]; BRANCHES],
    /// How far each ray's first surface is.
    surfaces: [f32; LANES],
    /// Rays that have a stretch within a medium, one bit each: all that get lanes, but for those that meet a surface.
    entering: u32,
}

impl Ready {
    fn new(start: &Start<Lanes>, stream: &LaneStream) -> Self {
        let [o, d] = [start.ray.origin, start.ray.direction];
        let Interval { t0, t1 } = start.first.interval;
        Self {
            numbers: [o.x, o.y, o.z, d.x, d.y, d.z, t0, t1].map(Lanes::to_array),
            medium: start.first.medium.to_array(),
            state: stream.states(),
            strata: start.strata.words().map(LaneWords::to_array),
            mark: start.mark,
            seen: Default::default(),
            distances: Default::default(),
            surfaces: [FAR; LANES],
            entering: start.first.found.bits(),
        }
    }

    fn set_glow(&mut self, glow: &Glow<Lanes>) {
        let l = glow.radiance;
        self.seen = [l.x, l.y, l.z, glow.alpha, glow.branches, glow.weight].map(Lanes::to_array);
        self.distances = glow.distances.map(Lanes::to_array);
    }

    /// What a path has found by its beginning.
    fn found(&self, place: usize) -> PathSample {
        let glow = self.glow(place);
        PathSample {
            radiance: glow.radiance.lane(0),
            alpha: glow.alpha,
        }
    }

    /// What the path of a place < 8 has found, if it goes on.
    #[inline(always)]
    pub(crate) fn glow(&self, place: usize) -> Glow<f32> {
        let place = place % LANES;
        let [r, g, b, alpha, branches, weight] = core::array::from_fn(|i| self.seen[i][place]);
        Glow {
            radiance: Vec3::new(r, g, b),
            alpha,
            branches,
            weight,
            distances: core::array::from_fn(|i| self.distances[i][place]),
        }
    }

    /// The path of a place < 8.
    #[inline(always)]
    pub(crate) fn start(&self, place: usize) -> Start<f32> {
        let place = place % LANES;
        let [ox, oy, oz, dx, dy, dz, t0, t1] = core::array::from_fn(|i| self.numbers[i][place]);
        Start {
            ray: Ray {
                origin: Vec3::new(ox, oy, oz),
                direction: Vec3::new(dx, dy, dz),
            },
            first: Stretch {
                interval: Interval { t0, t1 },
                medium: Word32(self.medium[place]),
                found: true,
            },
            strata: LaneStrata::new(core::array::from_fn(|i| Word32(self.strata[i][place]))),
            mark: self.mark.lane(place),
        }
    }

    /// The ray of a place < 8.
    fn ray(&self, place: usize) -> Ray<f32> {
        self.start(place).ray
    }

    /// Whether the path of a place < 8 begins with a stretch within a medium.
    #[inline(always)]
    pub(crate) fn enters(&self, place: usize) -> bool {
        self.entering >> (place % LANES) & 1 == 1
    }

    /// How far the first surface is from where the path of a place < 8 begins.
    #[inline(always)]
    pub(crate) fn distance(&self, place: usize) -> f32 {
        self.surfaces[place % LANES]
    }

    /// The stream of a place < 8, its lower and upper half.
    #[inline(always)]
    pub(crate) fn stream(&self, place: usize) -> [u32; 2] {
        let place = place % LANES;
        [self.state[0][place], self.state[1][place]]
    }
}

/// Requests on their way to lanes. Camera rays are made eight at a time, and those that meet no medium go no further.
pub(crate) struct Queue<I> {
    requests: I,
    asked: usize,
    bank: Bank,
    next: Next,
    pub(crate) ready: Ready,
    pub(crate) owners: [usize; LANES],
    /// Places of `ready` that wait, one bit each.
    waiting: u32,
}

impl<I: Iterator<Item = PathRequest>> Queue<I> {
    pub(crate) fn new(requests: impl IntoIterator<IntoIter = I>) -> Self {
        Self {
            requests: requests.into_iter(),
            asked: 0,
            bank: Bank::default(),
            next: Next::default(),
            ready: Ready::default(),
            owners: [0; LANES],
            waiting: 0,
        }
    }

    /// The place of a path that stands ready; `None` when all requests are under way. The samples of rays that meet
    /// nothing, and those that end with what is before them, land at once.
    ///
    /// * `combs`: whether paths begin with their [glow](path::glow).
    #[inline(always)]
    pub(crate) fn next<M, G, H: Surfaces>(
        &mut self,
        scene: &Scene<'_, M, G>,
        combs: bool,
        (counts, surfaces): (&mut Counts, &mut H),
        land: &mut impl FnMut(usize, PathSample),
    ) -> Option<usize>
    where
        M: Tapped<Lanes>,
        G: Geometry<Lanes> + ?Sized,
    {
        while self.waiting == 0 {
            if !self.fill(scene, combs, (counts, surfaces), land) {
                return None;
            }
        }
        let place = self.waiting.trailing_zeros() as usize;
        self.waiting &= self.waiting - 1;
        Some(place)
    }

    /// Makes the next eight camera rays ready; whether there were any.
    #[inline(never)]
    fn fill<M, G, H: Surfaces>(
        &mut self,
        scene: &Scene<'_, M, G>,
        combs: bool,
        (counts, surfaces): (&mut Counts, &mut H),
        land: &mut impl FnMut(usize, PathSample),
    ) -> bool
    where
        M: Tapped<Lanes>,
        G: Geometry<Lanes> + ?Sized,
    {
        let bank = scene.settings.points.then_some(&mut self.bank);
        let begun = self.next.take(&mut self.requests, bank);
        if begun == 0 {
            return false;
        }
        self.owners = core::array::from_fn(|lane| self.asked + lane);
        self.asked += begun;
        let lanes = LaneMask::from_bits((1 << begun) - 1);
        let (mut stream, place, strata) = self.next.begin(lanes);
        let start = Start::new(scene, place, strata, &mut stream, lanes);
        let mut going = start.first.found;
        let glow = if M::SHINES && combs {
            let glow = path::glow(scene, &start, &mut stream, lanes, counts);
            going = going & Lanes::zero().lt(glow.branches);
            Some(glow)
        } else {
            None
        };
        self.ready = Ready::new(&start, &stream);
        self.waiting = going.bits();
        if let Some(glow) = &glow {
            self.ready.set_glow(glow);
            for lane in (0..begun).filter(|lane| self.waiting >> lane & 1 == 0) {
                counts.paths += 1;
                land(self.owners[lane], self.ready.found(lane));
            }
            return true;
        }
        if H::ANY {
            for place in 0..begun {
                let ray = self.ready.ray(place);
                let distance = sight(surfaces, place, &ray);
                self.ready.surfaces[place] = distance;
                self.waiting |= u32::from(distance < FAR) << place;
            }
        }
        let missed = PathSample {
            radiance: scene.lights.environment,
            alpha: 0.0,
        };
        for lane in (0..begun).filter(|lane| self.waiting >> lane & 1 == 0) {
            counts.paths += 1;
            land(self.owners[lane], missed);
        }
        true
    }
}

/// The strata of the replicate that was asked for last: paths come in the order of their samples.
#[derive(Debug, Default)]
pub(crate) struct Bank {
    of: Option<Key>,
    common: u32,
    strata: [Strata; points::REPLICATE as usize],
}

impl Bank {
    #[inline]
    pub(crate) fn strata(&mut self, key: Key) -> Strata {
        let first = Key {
            sample: key.sample / points::REPLICATE,
            ..key
        };
        if self.of != Some(first) {
            self.of = Some(first);
            self.strata = points::replicate(key);
            self.common = points::common(key);
        }
        self.strata[(key.sample % points::REPLICATE) as usize]
    }
}
