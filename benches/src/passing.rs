//! Ways to estimate what passes along shadow rays, in sixteen lanes and one by one.

use woodcock_core::collision;
use woodcock_core::majorant::{Process, Stages};
use woodcock_core::medium::{Audited, Controlled, Medium};
use woodcock_core::ray::Ray;
use woodcock_core::real::Real;
use woodcock_core::stream::{PathStream, Stream};
use woodcock_core::transmittance::delta::Delta;
use woodcock_core::transmittance::power_series::{self, Depth, Distance};
use woodcock_core::transmittance::ratio::Ratio;
use woodcock_core::transmittance::residual_ratio::{Mean, Minimum, ResidualRatio};
use woodcock_core::transmittance::{Estimate, Rule};
use woodcock_core::vec3::Vec3;
use woodcock_packet::both::Wide;
use woodcock_packet::bundle::{Bundle, BundleRay, Schedule, in_turn, run};

/// Any estimate by tracking whose weight plays roulette below a floor, as paths let it.
#[derive(Clone, Debug)]
struct Played<R, P> {
    estimate: P,
    factor: R,
    floor: R,
}

impl<R: Real, P> Played<R, P> {
    fn new(estimate: P, floor: f32) -> Self {
        Self {
            estimate,
            factor: R::one(),
            floor: R::splat(floor),
        }
    }
}

impl<R: Real, M: Medium<R>, P: Process<R, M>> Process<R, M> for Played<R, P> {
    #[inline(always)]
    fn stages(&mut self) -> &mut Stages<R, M::Walk> {
        self.estimate.stages()
    }
    #[inline(always)]
    fn begin(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) {
        self.estimate.begin(medium, ray, t_max, rng, active);
        self.factor = R::select(active, R::one(), self.factor);
    }
    #[inline(always)]
    fn advance(&mut self, medium: &M) {
        self.estimate.advance(medium);
    }
    #[inline(always)]
    fn collide(&mut self, medium: &M, rng: &mut impl Stream<R>) {
        let deciding = self.stages().tentative();
        self.estimate.collide(medium, rng);
        let lanes = self.stages().tracking() & deciding;
        let weight = self.estimate.result() * self.factor;
        let factor = collision::roulette(weight, self.floor, rng, lanes);
        self.factor = R::select(lanes, self.factor * factor, self.factor);
        let lost = factor.eq(R::zero()) & lanes;
        self.stages().finish(lost);
    }
    #[inline(always)]
    fn result(&self) -> R {
        self.estimate.result() * self.factor
    }
}

/// The majorant depth of rays, block by block: what a choice by that depth costs beforehand.
#[derive(Clone, Debug)]
struct Beforehand<R: Real, W> {
    stages: Stages<R, W>,
    depth: R,
}

impl<R: Real, M: Medium<R>> Process<R, M> for Beforehand<R, M::Walk> {
    #[inline(always)]
    fn stages(&mut self) -> &mut Stages<R, M::Walk> {
        &mut self.stages
    }
    #[inline(always)]
    fn begin(
        &mut self,
        medium: &M,
        ray: &Ray<R>,
        t_max: R,
        _: &mut impl Stream<R>,
        active: R::Mask,
    ) {
        let nowhere = R::splat(f32::INFINITY);
        self.stages
            .begin_towards(medium, ray, t_max, nowhere, active);
        self.depth = R::select(active, R::zero(), self.depth);
    }
    #[inline(always)]
    fn advance(&mut self, medium: &M) {
        let lanes = self.stages.tracking();
        let majorant = self.stages.tracker.majorant(medium);
        let length = self.stages.advance(medium).length;
        self.depth = R::select(lanes, self.depth + majorant * length, self.depth);
    }
    #[inline(always)]
    fn collide(&mut self, _: &M, _: &mut impl Stream<R>) {}
    #[inline(always)]
    fn result(&self) -> R {
        self.depth
    }
}

/// Estimates of all rays of a bundle that play roulette below a floor.
pub type Lanes<'a> = Box<dyn Fn(&Bundle, f32, &mut [f32]) + 'a>;
/// The same of one ray.
pub type Single<'a> = Box<dyn Fn(&Ray<f32>, f32, f32, &mut PathStream) -> f32 + 'a>;

/// How many look-ups an estimate takes.
pub type Counted<'a> = Box<dyn Fn(&BundleRay, f32) -> u64 + 'a>;

/// A way to estimate what passes.
pub struct Way<'a> {
    /// What it is called.
    pub name: &'static str,
    /// Sixteen rays at a time.
    pub lanes: Lanes<'a>,
    /// Ray by ray: the ray, its length, the floor.
    pub single: Single<'a>,
    /// The same, under audit: how many look-ups there were.
    pub lookups: Counted<'a>,
}

impl std::fmt::Debug for Way<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// A bundle's ray as scalar code takes it.
pub fn world_ray(ray: &BundleRay) -> Ray<f32> {
    Ray {
        origin: Vec3::splat(ray.origin),
        direction: Vec3::splat(ray.direction),
    }
}

/// One process to its end on one ray.
fn alone<M: Medium<f32>, P: Process<f32, M>>(
    medium: &M,
    mut process: P,
    ray: &Ray<f32>,
    t_max: f32,
    rng: &mut PathStream,
) -> f32 {
    process.begin(medium, ray, t_max, rng, true);
    process.run(medium, rng);
    process.result()
}

/// A way from a process: `$idle` makes one without rays for a medium and a floor.
macro_rules! tracked {
    ($name:literal, $medium:ident, $idle:ident $(::<$kind:ty>)?) => {
        Way {
            name: $name,
            lanes: Box::new(move |bundle, floor, out| {
                let mut process = $idle::<Wide, M $(, $kind)?>($medium, floor);
                run($medium, &mut process, bundle, Schedule::Refill, out);
            }),
            single: Box::new(move |ray, t_max, floor, rng| {
                let process = $idle::<f32, M $(, $kind)?>($medium, floor);
                alone($medium, process, ray, t_max, rng)
            }),
            lookups: Box::new(move |ray, floor| {
                let audited = Audited::new($medium.clone());
                let process = $idle::<f32, Audited<M> $(, $kind)?>(&audited, floor);
                let mut rng = PathStream::new(ray.key);
                alone(&audited, process, &world_ray(ray), ray.t_max, &mut rng);
                audited.lookups()
            }),
        }
    };
}

fn by_rule<R: Real, M: Medium<R>, U: Rule>(medium: &M, _: f32) -> Estimate<R, M::Walk, U> {
    Estimate::idle(medium)
}
fn ratio_played<R: Real, M: Medium<R>>(medium: &M, floor: f32) -> impl Process<R, M> + use<R, M> {
    Played::new(Estimate::<R, M::Walk, Ratio>::idle(medium), floor)
}
fn minimum_played<R: Real, M: Controlled<R>>(
    medium: &M,
    floor: f32,
) -> impl Process<R, M> + use<R, M> {
    Played::new(ResidualRatio::<R, M::Walk, Minimum>::idle(medium), floor)
}
fn mean_played<R: Real, M: Controlled<R>>(
    medium: &M,
    floor: f32,
) -> impl Process<R, M> + use<R, M> {
    Played::new(ResidualRatio::<R, M::Walk, Mean>::idle(medium), floor)
}
fn mean_only<R: Real, M: Controlled<R>>(medium: &M, _: f32) -> ResidualRatio<R, M::Walk, Mean> {
    ResidualRatio::idle(medium)
}

/// A way from a power series.
macro_rules! series {
    ($name:literal, $medium:ident, $spacing:ty) => {
        Way {
            name: $name,
            lanes: Box::new(move |bundle, _, out| {
                in_turn(bundle, out, |ray, t_max, rng, lanes| {
                    power_series::estimate::<$spacing, Wide, M>($medium, ray, t_max, rng, lanes)
                });
            }),
            single: Box::new(move |ray, t_max, _, rng| {
                power_series::estimate::<$spacing, f32, M>($medium, ray, t_max, rng, true)
            }),
            lookups: Box::new(move |ray, _| {
                let audited = Audited::new($medium.clone());
                let mut rng = PathStream::new(ray.key);
                let (on, t_max) = (world_ray(ray), ray.t_max);
                power_series::estimate::<$spacing, f32, _>(&audited, &on, t_max, &mut rng, true);
                audited.lookups()
            }),
        }
    };
}

/// The place of the way that paths take among [`ways`].
pub const RENDERED: usize = 0;

/// The place of the first that is no tracking.
pub const SERIES: usize = 6;

/// All ways through a medium.
pub fn ways<'a, M>(medium: &'a M) -> Vec<Way<'a>>
where
    M: Controlled<f32> + Controlled<Wide> + Clone,
{
    vec![
        tracked!("ratio, roulette", medium, ratio_played),
        tracked!("ratio", medium, by_rule::<Ratio>),
        tracked!("delta", medium, by_rule::<Delta>),
        tracked!("residual minimum, roulette", medium, minimum_played),
        tracked!("residual mean, roulette", medium, mean_played),
        tracked!("residual mean", medium, mean_only),
        series!("power series, distance", medium, Distance),
        series!("power series, depth", medium, Depth),
    ]
}

/// Finds the majorant depth of all rays of a bundle, in lanes.
pub fn beforehand<M: Medium<Wide>>(medium: &M, bundle: &Bundle, depths: &mut [f32]) {
    let mut process = Beforehand {
        stages: Stages::idle(medium),
        depth: Wide::zero(),
    };
    run(medium, &mut process, bundle, Schedule::Refill, depths);
}
