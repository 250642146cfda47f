//! Media as paths meet them: extinction with colour, albedo and phase function.
//!
//! A scene with one medium has its parameters as constants ([`OneHomogeneous`], [`OneGrid`]); a scene
//! with several keeps them in a table, and each lane walks its own ([`Atlas`]).

use crate::free_flight::delta::is_real;
use crate::majorant::{BLOCK, GridLayout, GridWalk, MajorantGrid, Mark, Segment};
use crate::medium::{Affine, Control, Controlled, IDENTITY, Medium, transform_ray};
use crate::path::bricks::brick_counts;
use crate::path::geometry::Convex;
use crate::phase::Phase;
use crate::ray::{FAR, Ray};
use crate::real::{Mask, Real, Word, Word32};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// How a medium scatters, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Optics<R: Real> {
    /// Single-scattering albedo by colour, in [0, 1].
    pub albedo: Vec3<R>,
    /// Extinction by colour relative to the largest, in [0, 1]: all ones where it is grey.
    pub colour: Vec3<R>,
    /// Where it scatters to.
    pub phase: Phase<R>,
}

/// A medium of a path: any [`Medium`] whose extinction is that of its most opaque colour.
pub trait PathMedium<R: Real>: Medium<R> {
    /// Puts the walks of the active lanes at the origin of a ray in the medium number `id`.
    fn enter(&self, walk: &mut Self::Walk, ray: &Ray<R>, id: R::Word, active: R::Mask);
    /// How the medium of each lane scatters.
    fn optics(&self, walk: &Self::Walk) -> Optics<R>;

    /// Whether some of it [is closed](Self::is_closed).
    const CLOSED: bool = Self::TIGHT;

    /// The lanes whose present stretch has one extinction throughout, so that its transmittance has a closed form.
    #[inline(always)]
    fn is_closed(&self, _walk: &Self::Walk) -> R::Mask {
        R::Mask::splat(Self::TIGHT)
    }

    /// Whether it alone is in the scene, in all of its domain: rays that set out from [marks](Self::mark) need no geometry.
    #[inline(always)]
    fn is_alone(&self) -> bool {
        false
    }
    /// The places at distance `t` of the present segments. Of a medium that [is alone](Self::is_alone).
    #[inline(always)]
    fn mark(&self, _walk: &Self::Walk, _t: R) -> Mark<R> {
        Mark::none()
    }
    /// Puts the active lanes at marks, on rays in a direction of the world. Returns how far those stay within the medium
    /// \[length\].
    ///
    /// Marks are those of collisions, or of the origins of rays in the same directions.
    #[inline(always)]
    fn resume(&self, _: &mut Self::Walk, _: &Mark<R>, _: Vec3<R>, _active: R::Mask) -> R {
        R::zero()
    }
    /// The marks of the origins of rays.
    #[inline(always)]
    fn mark_origin(&self, ray: &Ray<R>, active: R::Mask) -> Mark<R> {
        let mut walk = self.idle();
        self.enter(&mut walk, ray, R::Word::splat(0), active);
        self.mark(&walk, R::zero())
    }
}

/// A medium of packets: the extinction at a place is that of one sample of a table, picked at random.
pub trait Tapped<R: Real>: PathMedium<R> + Sized {
    /// Whether it sends out light; its optics are then the same everywhere.
    const SHINES: bool = false;

    /// σ_a L_e by colour \[W/(m³ sr)\] at a place of the world, of a tap's extinction [1/length].
    #[inline(always)]
    fn emission(&self, _sigma_t: R, _place: Vec3<R>) -> Vec3<R> {
        Vec3::uniform(0.0)
    }

    /// Which sample stands for the place at distance `t` of the present segment: all that is asked of a tentative
    /// collision is asked of it.
    fn tap(&self, walk: &Self::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R::Word;

    /// The extinction of a tap [1/length].
    fn value(&self, walk: &Self::Walk, tap: R::Word, active: R::Mask) -> R;

    /// Whether tentative collisions are real, where extinction is grey. A medium that can tell without the exact
    /// value decides here, and decides alike.
    ///
    /// * `majorant`: of the present segment, per lane [1/length].
    #[inline(always)]
    fn decide(
        &self,
        walk: &Self::Walk,
        tap: R::Word,
        majorant: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> Decided<R> {
        let sigma_t = self.value(walk, tap, active);
        Decided {
            real: is_real::<R, Self>(sigma_t, majorant, rng, active),
            violated: majorant.lt(sigma_t) & active,
            exact: active,
        }
    }
}

/// What became of tentative collisions, per lane.
#[derive(Clone, Copy, Debug)]
pub struct Decided<R: Real> {
    /// Collisions with matter.
    pub real: R::Mask,
    /// The extinction was seen to exceed its bound.
    pub violated: R::Mask,
    /// The exact value was looked up.
    pub exact: R::Mask,
}

/// What a record describes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RecordKind {
    /// The same everywhere.
    Homogeneous,
    /// Samples of a grid, times `scale`.
    Grid {
        /// To the space where samples lie at the integers.
        world_to_grid: Affine,
        /// Samples along x, y, z.
        dims: [u32; 3],
        /// Index of the grid's first sample in the common table.
        samples: u32,
        /// Index of the grid's first bound in the common table.
        majorants: u32,
        /// Edge of a majorant block, in voxel cells.
        edge: u32,
    },
}

/// The parameters of one medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumRecord {
    /// What it is.
    pub kind: RecordKind,
    /// Extinction of the most opaque colour, of a sample of one in a grid [1/length].
    pub scale: f32,
    /// Extinction by colour relative to `scale`, in [0, 1].
    pub colour: [f32; 3],
    /// Single-scattering albedo by colour, in [0, 1].
    pub albedo: [f32; 3],
    /// Mean cosine, in (−1, 1).
    pub g: f32,
    /// Rayleigh's law instead of Henyey–Greenstein's.
    pub rayleigh: bool,
}

/// Words of a record in an [`Atlas`].
pub const RECORD_WORDS: usize = 32;

// Places of a record's fields.
const AFFINE: usize = 0;
const SCALE: usize = 12;
const COLOUR: usize = 13;
const ALBEDO: usize = 16;
const G: usize = 19;
const RAYLEIGH: usize = 20;
const IS_GRID: usize = 21;
const SAMPLES: usize = 22;
const STRIDES: usize = 23;
const MAJORANTS: usize = 25;
const MAJORANT_STRIDES: usize = 26;
const LAST: usize = 28;
const EDGE: usize = 31;

impl MediumRecord {
    /// The medium as light of one colour has it: grey.
    ///
    /// * `colour`: 0, 1 or 2.
    pub fn of_colour(&self, colour: usize) -> Self {
        let pick = |of: [f32; 3]| of.get(colour).copied().unwrap_or(0.0);
        Self {
            scale: self.scale * pick(self.colour),
            colour: [1.0; 3],
            albedo: [pick(self.albedo); 3],
            ..*self
        }
    }

    /// The record as the words of a table.
    pub fn to_words(&self) -> [u32; RECORD_WORDS] {
        let mut words = [0; RECORD_WORDS];
        let mut put = |at: usize, value: u32| {
            if let Some(word) = words.get_mut(at) {
                *word = value;
            }
        };
        put(SCALE, self.scale.to_bits());
        for axis in 0..3 {
            put(COLOUR + axis, self.colour[axis].to_bits());
            put(ALBEDO + axis, self.albedo[axis].to_bits());
        }
        put(G, self.g.to_bits());
        put(RAYLEIGH, u32::from(self.rayleigh));
        let (affine, dims, edge) = match self.kind {
            RecordKind::Homogeneous => (IDENTITY, [2; 3], BLOCK),
            RecordKind::Grid {
                world_to_grid,
                dims,
                samples,
                majorants,
                edge,
            } => {
                put(IS_GRID, 1);
                put(SAMPLES, samples);
                put(MAJORANTS, majorants);
                (world_to_grid, dims, edge)
            }
        };
        for (at, value) in affine.iter().flatten().enumerate() {
            put(AFFINE + at, value.to_bits());
        }
        let [strides, majorant_strides] = MajorantGrid::strides(dims, edge);
        for axis in 0..2 {
            put(STRIDES + axis, strides[axis]);
            put(MAJORANT_STRIDES + axis, majorant_strides[axis]);
        }
        for (axis, n) in dims.iter().enumerate() {
            put(LAST + axis, ((n - 1) as f32).to_bits());
        }
        put(EDGE, (edge as f32).to_bits());
        words
    }

    /// As [`to_words`](Self::to_words), for a grid that lies in [bricks](crate::path::Bricks).
    pub(super) fn to_words_in_bricks(self) -> [u32; RECORD_WORDS] {
        let mut words = self.to_words();
        if let RecordKind::Grid { dims, .. } = self.kind {
            let [x, y, _] = brick_counts(dims);
            (words[STRIDES], words[STRIDES + 1]) = (x, x.wrapping_mul(y));
        }
        words
    }
}

/// Reads a record's fields, each lane its own or all the same, by a function of the field's place.
pub(super) struct Fields<F>(F);

impl<F> Fields<F> {
    #[inline(always)]
    fn real<R: Real>(&self, at: usize) -> R
    where
        F: Fn(usize) -> R::Word,
    {
        R::from_f32_bits((self.0)(at))
    }
    #[inline(always)]
    fn vec3<R: Real>(&self, at: usize) -> Vec3<R>
    where
        F: Fn(usize) -> R::Word,
    {
        Vec3::new(
            self.real::<R>(at),
            self.real::<R>(at + 1),
            self.real::<R>(at + 2),
        )
    }
    #[inline(always)]
    pub(super) fn layout<R: Real>(&self) -> GridLayout<R>
    where
        F: Fn(usize) -> R::Word,
    {
        let word = &self.0;
        GridLayout {
            samples: word(SAMPLES),
            strides: [word(STRIDES), word(STRIDES + 1)],
            majorants: word(MAJORANTS),
            majorant_strides: [word(MAJORANT_STRIDES), word(MAJORANT_STRIDES + 1)],
            edge: self.real::<R>(EDGE),
            last: self.vec3::<R>(LAST),
            scale: self.real::<R>(SCALE),
        }
    }
    #[inline(always)]
    pub(super) fn to_grid<R: Real>(&self, ray: &Ray<R>) -> Ray<R>
    where
        F: Fn(usize) -> R::Word,
    {
        let row = |at: usize| [0_usize, 1, 2, 3].map(|i| self.real::<R>(AFFINE + at * 4 + i));
        transform_ray([row(0), row(1), row(2)], ray)
    }
    /// The box of a grid's domain, of a record that is the same for all lanes.
    pub(super) fn domain(&self) -> Convex
    where
        F: Fn(usize) -> Word32,
    {
        let row = |at: usize| [0_usize, 1, 2, 3].map(|i| self.real::<f32>(AFFINE + at * 4 + i));
        Convex::Box {
            to_local: [row(0), row(1), row(2)],
            size: self.vec3::<f32>(LAST).lane(0),
        }
    }
    #[inline(always)]
    pub(super) fn optics<R: Real>(&self) -> Optics<R>
    where
        F: Fn(usize) -> R::Word,
    {
        let one = R::Word::splat(1);
        Optics {
            albedo: self.vec3::<R>(ALBEDO),
            colour: self.vec3::<R>(COLOUR),
            phase: Phase {
                g: self.real::<R>(G),
                rayleigh: (self.0)(RAYLEIGH).eq(one),
            },
        }
    }
}

/// Gives every lane the same record.
#[inline(always)]
pub(super) fn constant<R: Real>(
    words: &[u32; RECORD_WORDS],
) -> Fields<impl Fn(usize) -> R::Word + '_> {
    Fields(|at: usize| R::Word::splat(words[at]))
}

/// The only medium of a scene, homogeneous.
#[derive(Clone, Copy, Debug)]
pub struct OneHomogeneous {
    words: [u32; RECORD_WORDS],
}

impl OneHomogeneous {
    /// From its record.
    pub fn new(record: &MediumRecord) -> Self {
        Self {
            words: record.to_words(),
        }
    }
}

impl<R: Real> Medium<R> for OneHomogeneous {
    type Walk = ();
    const ONE_SEGMENT: bool = true;
    const TIGHT: bool = true;

    #[inline(always)]
    fn idle(&self) {}
    #[inline(always)]
    fn begin(&self, _: &mut (), _: &Ray<R>, _: R::Mask) {}
    #[inline(always)]
    fn segment(&self, _: &()) -> Segment<R> {
        let majorant = constant::<R>(&self.words).real::<R>(SCALE);
        Segment {
            majorant,
            t_exit: R::splat(FAR),
        }
    }
    #[inline(always)]
    fn next_segment(&self, _: &mut (), _: R::Mask) {}
    #[inline(always)]
    fn sigma_t(&self, _: &(), _: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        constant::<R>(&self.words).real::<R>(SCALE)
    }
}

impl<R: Real> PathMedium<R> for OneHomogeneous {
    #[inline(always)]
    fn enter(&self, _: &mut (), _: &Ray<R>, _: R::Word, _: R::Mask) {}
    #[inline(always)]
    fn optics(&self, _: &()) -> Optics<R> {
        constant::<R>(&self.words).optics::<R>()
    }
}

impl<R: Real> Tapped<R> for OneHomogeneous {
    #[inline(always)]
    fn tap(&self, _: &(), _: R, _: &mut impl Stream<R>, _: R::Mask) -> R::Word {
        R::Word::splat(0)
    }
    #[inline(always)]
    fn value(&self, _: &(), _: R::Word, _: R::Mask) -> R {
        constant::<R>(&self.words).real::<R>(SCALE)
    }
}

/// Several media of any kind, their grids one after the other in common tables.
#[derive(Clone, Copy, Debug)]
pub struct Atlas<'a> {
    /// The records' words, [`RECORD_WORDS`] a medium.
    pub records: &'a [u32],
    /// The samples of all grids.
    pub samples: &'a [f32],
    /// The bounds of all grids.
    pub majorants: &'a [f32],
}

impl Atlas<'_> {
    #[inline(always)]
    fn fields<R: Real>(&self, id: R::Word) -> Fields<impl Fn(usize) -> R::Word + '_> {
        let base = id * R::Word::splat(RECORD_WORDS as u32);
        Fields(move |at: usize| R::Word::gather(self.records, base + R::Word::splat(at as u32)))
    }
}

/// A lane's way through one of several media.
#[derive(Clone, Debug)]
pub struct AtlasWalk<R: Real> {
    id: R::Word,
    grid: GridWalk<R>,
    is_grid: R::Mask,
    scale: R,
}

impl<R: Real> Medium<R> for Atlas<'_> {
    type Walk = AtlasWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> AtlasWalk<R> {
        AtlasWalk {
            id: R::Word::splat(0),
            grid: GridWalk::idle(),
            is_grid: R::Mask::splat(false),
            scale: R::zero(),
        }
    }
    #[inline(always)]
    fn begin(&self, walk: &mut AtlasWalk<R>, ray: &Ray<R>, active: R::Mask) {
        self.enter(walk, ray, R::Word::splat(0), active);
    }
    #[inline(always)]
    fn segment(&self, walk: &AtlasWalk<R>) -> Segment<R> {
        let grid = walk.grid.segment();
        Segment {
            majorant: R::select(walk.is_grid, grid.majorant, walk.scale),
            t_exit: R::select(walk.is_grid, grid.t_exit, R::splat(FAR)),
        }
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut AtlasWalk<R>, active: R::Mask) {
        walk.grid
            .next_segment(self.majorants, active & walk.is_grid);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &AtlasWalk<R>, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        let tap = self.tap(walk, t, rng, active);
        self.value(walk, tap, active)
    }
}

impl<R: Real> PathMedium<R> for Atlas<'_> {
    const CLOSED: bool = true;

    #[inline(always)]
    fn is_closed(&self, walk: &AtlasWalk<R>) -> R::Mask {
        R::Mask::splat(true).and_not(walk.is_grid)
    }
    #[inline(always)]
    fn enter(&self, walk: &mut AtlasWalk<R>, ray: &Ray<R>, id: R::Word, active: R::Mask) {
        let fields = self.fields::<R>(id);
        let is_grid = (fields.0)(IS_GRID).eq(R::Word::splat(1));
        walk.id = R::Word::select(active, id, walk.id);
        walk.is_grid = (is_grid & active) | walk.is_grid.and_not(active);
        walk.scale = R::select(active, fields.real::<R>(SCALE), walk.scale);
        let on_grid = is_grid & active;
        if on_grid.any() {
            let ray = fields.to_grid(ray);
            walk.grid
                .begin(&fields.layout::<R>(), &ray, self.majorants, on_grid);
        }
    }
    #[inline(always)]
    fn optics(&self, walk: &AtlasWalk<R>) -> Optics<R> {
        self.fields::<R>(walk.id).optics::<R>()
    }
}

impl<R: Real> Tapped<R> for Atlas<'_> {
    #[inline(always)]
    fn tap(&self, walk: &AtlasWalk<R>, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R::Word {
        let on_grid = active & walk.is_grid;
        if on_grid.any() {
            walk.grid.tap(t, rng, on_grid)
        } else {
            R::Word::splat(0)
        }
    }
    #[inline(always)]
    fn value(&self, walk: &AtlasWalk<R>, tap: R::Word, active: R::Mask) -> R {
        if (active & walk.is_grid).any() {
            let grid = walk.grid.value(self.samples, tap);
            R::select(walk.is_grid, grid, walk.scale)
        } else {
            walk.scale
        }
    }
}

impl<R: Real> Controlled<R> for OneHomogeneous {
    #[inline(always)]
    fn control(&self, walk: &()) -> Control<R> {
        let sigma_t = self.segment(walk).majorant;
        Control {
            minimum: sigma_t,
            mean: sigma_t,
        }
    }
}

impl<R: Real> Controlled<R> for Atlas<'_> {
    #[inline(always)]
    fn control(&self, walk: &AtlasWalk<R>) -> Control<R> {
        Control {
            minimum: R::zero(),
            mean: self.segment(walk).majorant,
        }
    }
}
