//! The only medium of a scene, on a grid: dense, or in bricks.

use crate::free_flight::delta::is_real;
use crate::majorant::{GridWalk, Mark, Segment};
use crate::medium::{Control, Controlled, Medium};
use crate::path::bricks::Bricks;
use crate::path::geometry::Convex;
use crate::path::media::{
    Decided, MediumRecord, Optics, PathMedium, RECORD_WORDS, Tapped, constant,
};
use crate::ray::Ray;
use crate::real::{Mask, Real};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// Where a grid's samples are.
#[derive(Clone, Copy, Debug)]
pub enum Store<'a> {
    /// All of them, in a table that the record points into.
    Dense(&'a [f32]),
    /// Those where matter is.
    Bricks(Bricks<'a>),
}

/// The only medium of a scene, on a grid.
///
/// Either store gives every path the same bits. Its walks are those that its `idle` makes, which know the grid for good.
#[derive(Clone, Copy, Debug)]
pub struct OneGrid<'a> {
    words: [u32; RECORD_WORDS],
    store: Store<'a>,
    majorants: &'a [f32],
    /// Minorants and means of blocks, or nothing.
    controls: [&'a [f32]; 2],
    alone: bool,
}

impl<'a> OneGrid<'a> {
    /// From its record, and the tables that the record points into.
    pub fn new(record: &MediumRecord, samples: &'a [f32], majorants: &'a [f32]) -> Self {
        Self::stored(record, Store::Dense(samples), majorants)
    }

    /// From its record, its samples wherever they are, and the table of bounds that the record points into.
    pub fn stored(record: &MediumRecord, store: Store<'a>, majorants: &'a [f32]) -> Self {
        let words = match store {
            Store::Dense(_) => record.to_words(),
            Store::Bricks(_) => record.to_words_in_bricks(),
        };
        Self {
            words,
            store,
            majorants,
            controls: [&[]; 2],
            alone: false,
        }
    }

    /// The same grid in a scene whose geometry is given: where that is nothing but the grid's own domain, rays that begin within
    /// need not ask for it.
    #[must_use]
    pub fn within(self, place: &Convex) -> Self {
        let alone = *place == constant::<f32>(&self.words).domain();
        Self { alone, ..self }
    }

    /// With what is known of blocks besides their bounds: tables in the layout of the bounds, as
    /// [`fill_control_slab`](crate::majorant::fill_control_slab) makes them. Empty tables say nothing.
    #[must_use]
    pub fn with_controls(self, minorants: &'a [f32], means: &'a [f32]) -> Self {
        Self {
            controls: [minorants, means],
            ..self
        }
    }
}

impl<R: Real> Medium<R> for OneGrid<'_> {
    type Walk = GridWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> GridWalk<R> {
        GridWalk::within(constant::<R>(&self.words).layout::<R>())
    }
    #[inline(always)]
    fn begin(&self, walk: &mut GridWalk<R>, ray: &Ray<R>, active: R::Mask) {
        let fields = constant::<R>(&self.words);
        walk.enter(&fields.to_grid(ray), self.majorants, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &GridWalk<R>) -> Segment<R> {
        walk.segment()
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut GridWalk<R>, active: R::Mask) {
        walk.next_segment(self.majorants, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &GridWalk<R>, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        let tap = self.tap(walk, t, rng, active);
        self.value(walk, tap, active)
    }
}

impl<R: Real> PathMedium<R> for OneGrid<'_> {
    #[inline(always)]
    fn enter(&self, walk: &mut GridWalk<R>, ray: &Ray<R>, _: R::Word, active: R::Mask) {
        self.begin(walk, ray, active);
    }
    #[inline(always)]
    fn optics(&self, _: &GridWalk<R>) -> Optics<R> {
        constant::<R>(&self.words).optics::<R>()
    }
    #[inline(always)]
    fn is_alone(&self) -> bool {
        self.alone
    }
    #[inline(always)]
    fn mark(&self, walk: &GridWalk<R>, t: R) -> Mark<R> {
        walk.mark(t)
    }
    #[inline(always)]
    fn resume(
        &self,
        walk: &mut GridWalk<R>,
        mark: &Mark<R>,
        direction: Vec3<R>,
        active: R::Mask,
    ) -> R {
        let along = Ray {
            origin: Vec3::uniform(0.0),
            direction,
        };
        let along = constant::<R>(&self.words).to_grid(&along);
        walk.resume(mark, along.direction, active)
    }
}

impl<R: Real> Tapped<R> for OneGrid<'_> {
    #[inline(always)]
    fn tap(&self, walk: &GridWalk<R>, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R::Word {
        match &self.store {
            Store::Dense(_) => walk.tap(t, rng, active),
            Store::Bricks(bricks) => walk.tap_in(bricks, t, rng, active),
        }
    }
    #[inline(always)]
    fn value(&self, walk: &GridWalk<R>, tap: R::Word, _: R::Mask) -> R {
        match &self.store {
            Store::Dense(samples) => walk.value(samples, tap),
            Store::Bricks(bricks) => bricks.value::<R>(tap) * walk.scale(),
        }
    }
    /// In bricks, a squeeze: samples are read only where their bytes do not settle it.
    #[inline(always)]
    fn decide(
        &self,
        walk: &GridWalk<R>,
        tap: R::Word,
        majorant: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> Decided<R> {
        let Store::Bricks(bricks) = &self.store else {
            let sigma_t = self.value(walk, tap, active);
            return Decided {
                real: is_real::<R, Self>(sigma_t, majorant, rng, active),
                violated: majorant.lt(sigma_t) & active,
                exact: active,
            };
        };
        // The draw of `is_real`, and below its comparison.
        let threshold = rng.uniform_fine(active) * majorant;
        let (low, high) = bricks.bracket::<R>(tap);
        // Rounding is monotone, so scaled brackets hold scaled samples.
        let (low, high) = (low * walk.scale(), high * walk.scale());
        let mut real = threshold.lt(low) & active;
        let mut violated = majorant.lt(low) & active;
        let exact = active.and_not(real | high.le(threshold));
        if exact.any() {
            let sigma_t = self.value(walk, tap, exact);
            real = real | (threshold.lt(sigma_t) & exact);
            violated = violated | (majorant.lt(sigma_t) & exact);
        }
        Decided {
            real,
            violated,
            exact,
        }
    }
}

/// From the tables of controls; without them nothing but the bound is known.
impl<R: Real> Controlled<R> for OneGrid<'_> {
    #[inline(always)]
    fn control(&self, walk: &GridWalk<R>) -> Control<R> {
        let [minorants, means] = self.controls;
        if means.is_empty() {
            return Control {
                minimum: R::zero(),
                mean: walk.segment().majorant,
            };
        }
        Control {
            minimum: walk.of_block(minorants),
            mean: walk.of_block(means),
        }
    }
}
