//! The walk over the blocks of a majorant grid: [Amanatides, Woo 1987], in lanes.
//!
//! Blocks are counted in integers (held as exact floats), and the distance to a block's face is
//! computed from the face's index each time, never accumulated; so the walk cannot drift from the
//! grid. A place is clamped to its block before a sample is looked up: what it reads is always
//! within the footprint that the block's bound was proved for.
//!
//! An entry below zero is a [leap](crate::majorant::fill_leaps): nothing is in the cube of blocks ahead, which then is
//! one segment. Beyond it the walk stands in the block that holds its place, found anew from the ray.

use crate::majorant::leaps::{CODE_BITS, CODE_MASK};
use crate::majorant::{BLOCK, MajorantGrid, Segment};
use crate::path::Bricks;
use crate::ray::{Ray, bounded_reciprocal};
use crate::real::{Mask, Real, Word, Word32};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// Where a grid's samples and bounds lie in their tables, per lane: lanes may walk different grids.
#[derive(Clone, Copy, Debug)]
pub struct GridLayout<R: Real> {
    /// Index of the first sample.
    pub samples: R::Word,
    /// Samples from one row, and from one slice, to the next.
    pub strides: [R::Word; 2],
    /// Index of the first bound.
    pub majorants: R::Word,
    /// Bounds from one row, and from one slice, to the next.
    pub majorant_strides: [R::Word; 2],
    /// Edge of a block in voxel cells, a power of two.
    pub edge: R,
    /// The far corner of the domain, n − 1 samples along each axis.
    pub last: Vec3<R>,
    /// What samples and bounds are multiplied with to give extinction [1/length].
    pub scale: R,
}

impl<R: Real> GridLayout<R> {
    /// The layout of one grid, alone in its tables, for every lane.
    pub fn of(grid: &MajorantGrid<'_>, scale: f32) -> Self {
        Self::of_dims(grid.dims, grid.edge, scale)
    }

    /// The layout of a grid of `dims` samples in blocks of `edge` cells, alone in its tables.
    pub(crate) fn of_dims(dims: [u32; 3], edge: u32, scale: f32) -> Self {
        let [strides, majorant_strides] = MajorantGrid::strides(dims, edge);
        Self {
            samples: R::Word::splat(0),
            strides: strides.map(R::Word::splat),
            majorants: R::Word::splat(0),
            majorant_strides: majorant_strides.map(R::Word::splat),
            edge: R::splat(edge as f32),
            last: Vec3::splat(dims.map(|n| (n - 1) as f32)),
            scale: R::splat(scale),
        }
    }

    /// The layout of a table of blocks without samples, a rim of one block around it included:
    /// `blocks` along each axis without the rim.
    pub fn of_blocks(blocks: [u32; 3], scale: f32) -> Self {
        let [nx, ny, _] = blocks;
        let zero = R::Word::splat(0);
        let slice = nx.wrapping_add(2).wrapping_mul(ny.wrapping_add(2));
        Self {
            samples: zero,
            strides: [zero; 2],
            majorants: zero,
            majorant_strides: [R::Word::splat(nx.wrapping_add(2)), R::Word::splat(slice)],
            edge: R::splat(BLOCK as f32),
            last: Vec3::splat(blocks.map(|n| n.wrapping_mul(BLOCK) as f32)),
            scale: R::splat(scale),
        }
    }

    #[inline(always)]
    fn select(mask: R::Mask, a: &Self, b: &Self) -> Self {
        let word = |a, b| R::Word::select(mask, a, b);
        Self {
            samples: word(a.samples, b.samples),
            strides: [
                word(a.strides[0], b.strides[0]),
                word(a.strides[1], b.strides[1]),
            ],
            majorants: word(a.majorants, b.majorants),
            majorant_strides: [
                word(a.majorant_strides[0], b.majorant_strides[0]),
                word(a.majorant_strides[1], b.majorant_strides[1]),
            ],
            edge: R::select(mask, a.edge, b.edge),
            last: Vec3::select(mask, a.last, b.last),
            scale: R::select(mask, a.scale, b.scale),
        }
    }
}

/// A ray on its way through the blocks of a grid, in grid space, per lane.
#[derive(Clone, Copy, Debug)]
pub struct GridWalk<R: Real> {
    layout: GridLayout<R>,
    origin: Vec3<R>,
    direction: Vec3<R>,
    inverse: Vec3<R>,
    /// From a block's near faces to its far ones: its edge, with the direction's signs.
    across: Vec3<R>,
    /// Where the present block's near faces lie, those that the ray enters by; multiples of the edge.
    near: Vec3<R>,
    /// From an entry to that of the next block on the ray along x, y and z.
    strides: [R::Word; 3],
    /// Index of the present entry.
    index: R::Word,
    /// Where the entries' codes say how far the ray may leap.
    octant: R::Word,
    majorant: R,
    /// Blocks along the edge of the present segment's cube, from the present block on; at least one.
    reach: R,
}

/// A place in a grid and what is known of its block: rays set out from it without asking where they are.
#[derive(Clone, Copy, Debug)]
pub struct Mark<R: Real> {
    place: Vec3<R>,
    /// The block's low corner.
    low: Vec3<R>,
    index: R::Word,
    majorant: R,
    reach: R,
}

impl<R: Real> Default for Mark<R> {
    #[inline(always)]
    fn default() -> Self {
        Self::none()
    }
}

impl<R: Real> Mark<R> {
    /// No place.
    #[inline(always)]
    pub fn none() -> Self {
        let nowhere = Vec3::uniform(0.0);
        Self {
            place: nowhere,
            low: nowhere,
            index: R::Word::splat(0),
            majorant: R::zero(),
            reach: R::one(),
        }
    }

    /// `if_true` where the mask holds, else `if_false`.
    #[inline(always)]
    pub fn select(mask: R::Mask, if_true: &Self, if_false: &Self) -> Self {
        Self {
            place: Vec3::select(mask, if_true.place, if_false.place),
            low: Vec3::select(mask, if_true.low, if_false.low),
            index: R::Word::select(mask, if_true.index, if_false.index),
            majorant: R::select(mask, if_true.majorant, if_false.majorant),
            reach: R::select(mask, if_true.reach, if_false.reach),
        }
    }

    /// The same places for rays in any direction: what is known to be empty ahead is forgotten.
    #[inline(always)]
    pub(crate) fn for_all_directions(self) -> Self {
        Self {
            reach: R::one(),
            ..self
        }
    }

    /// Sets one lane.
    #[inline(always)]
    pub fn set_lane(&mut self, lane: usize, mark: &Mark<f32>) {
        self.place.set_lane(lane, mark.place.lane(0));
        self.low.set_lane(lane, mark.low.lane(0));
        self.index.set_lane(lane, mark.index.0);
        self.majorant.set_lane(lane, mark.majorant);
        self.reach.set_lane(lane, mark.reach);
    }

    /// One lane.
    #[inline(always)]
    pub fn lane(&self, lane: usize) -> Mark<f32> {
        Mark {
            place: Vec3::splat(self.place.lane(lane)),
            low: Vec3::splat(self.low.lane(lane)),
            index: Word32(self.index.lane(lane)),
            majorant: self.majorant.lane(lane),
            reach: self.reach.lane(lane),
        }
    }
}

impl<R: Real> GridWalk<R> {
    /// A walk with no ray yet, in no grid.
    pub fn idle() -> Self {
        let zero = R::Word::splat(0);
        Self::within(GridLayout {
            samples: zero,
            strides: [zero; 2],
            majorants: zero,
            majorant_strides: [zero; 2],
            edge: R::splat(BLOCK as f32),
            last: Vec3::uniform(0.0),
            scale: R::zero(),
        })
    }

    /// A walk with no ray yet, in one grid for good.
    pub fn within(layout: GridLayout<R>) -> Self {
        let zero = R::Word::splat(0);
        let nowhere = Vec3::uniform(0.0);
        Self {
            layout,
            origin: nowhere,
            direction: nowhere,
            inverse: nowhere,
            across: nowhere,
            near: nowhere,
            strides: [zero; 3],
            index: zero,
            octant: zero,
            majorant: R::zero(),
            reach: R::one(),
        }
    }

    /// Puts the active lanes at the origin of a ray that begins within a grid's domain.
    ///
    /// `ray`: in grid space; the direction's length is what a unit of t covers there.
    #[inline(always)]
    pub fn begin(
        &mut self,
        layout: &GridLayout<R>,
        ray: &Ray<R>,
        majorants: &[f32],
        active: R::Mask,
    ) {
        self.layout = GridLayout::select(active, layout, &self.layout);
        self.enter(ray, majorants, active);
    }

    /// As [`begin`](Self::begin), in the grid that the lanes are in.
    #[inline(always)]
    pub fn enter(&mut self, ray: &Ray<R>, majorants: &[f32], active: R::Mask) {
        let layout = &self.layout;
        let edge = layout.edge;
        let blocks = R::one() / edge;
        let one = R::Word::splat(1);
        // The last block begins at the last multiple of the edge below the far corner.
        let block = |o: R, last: R| {
            let inside = o.max(R::zero()).min(last);
            let block = (inside * blocks).to_word();
            // On the far face itself, the block before it.
            let beyond = last.le(R::from_word(block) * edge) & R::zero().lt(last);
            block - R::Word::from_mask(beyond)
        };
        let cell = [
            block(ray.origin.x, layout.last.x),
            block(ray.origin.y, layout.last.y),
            block(ray.origin.z, layout.last.z),
        ];
        let index = layout.majorants
            + (cell[0] + one)
            + (cell[1] + one) * layout.majorant_strides[0]
            + (cell[2] + one) * layout.majorant_strides[1];
        let low = |a: usize| R::from_word(cell[a]) * edge;
        let low = Vec3::new(low(0), low(1), low(2));
        self.set_out(ray, low, index, active);
        self.read(majorants, active);
    }

    /// Puts the active lanes on a ray in the block of a low corner and an entry.
    #[inline(always)]
    fn set_out(&mut self, ray: &Ray<R>, low: Vec3<R>, index: R::Word, active: R::Mask) {
        let layout = &self.layout;
        let edge = layout.edge;
        let Vec3 { x, y, z } = ray.direction;
        let backward = [x, y, z].map(|d| d.lt(R::zero()));
        let across = |a: usize| R::select(backward[a], -edge, edge);
        let across = Vec3::new(across(0), across(1), across(2));
        // Exact: multiples of a power of two.
        let near = |low: R, a: usize| low + edge.or_zero(backward[a]);
        let near = Vec3::new(near(low.x, 0), near(low.y, 1), near(low.z, 2));
        let (zero, one) = (R::Word::splat(0), R::Word::splat(1));
        let signed = |stride, back| R::Word::select(back, zero - stride, stride);
        let strides = [
            signed(one, backward[0]),
            signed(layout.majorant_strides[0], backward[1]),
            signed(layout.majorant_strides[1], backward[2]),
        ];
        let bit = |back, value| R::Word::select(back, R::Word::splat(value), zero);
        let octant = bit(backward[0], CODE_BITS)
            + bit(backward[1], 2 * CODE_BITS)
            + bit(backward[2], 4 * CODE_BITS);
        self.origin = Vec3::select(active, ray.origin, self.origin);
        self.direction = Vec3::select(active, ray.direction, self.direction);
        self.inverse = Vec3::select(active, ray.direction.map(bounded_reciprocal), self.inverse);
        self.across = Vec3::select(active, across, self.across);
        self.near = Vec3::select(active, near, self.near);
        for (own, new) in self.strides.iter_mut().zip(strides) {
            *own = R::Word::select(active, new, *own);
        }
        self.index = R::Word::select(active, index, self.index);
        self.octant = R::Word::select(active, octant, self.octant);
    }

    /// The places at distance `t` of the present segments; where those are cubes of blocks, within the first.
    #[inline(always)]
    pub fn mark(&self, t: R) -> Mark<R> {
        let far = self.near + self.across;
        Mark {
            place: self.place(t),
            low: Vec3::new(
                self.near.x.min(far.x),
                self.near.y.min(far.y),
                self.near.z.min(far.z),
            ),
            index: self.index,
            majorant: self.majorant,
            reach: self.reach,
        }
    }

    /// Puts the active lanes at marks of the grid that they are in. Returns how far their rays stay within the grid's domain.
    ///
    /// * `direction`: in grid space; its length is what a unit of t covers there. Of marks with empty blocks around, the one that
    ///   they were made with.
    #[inline(always)]
    pub fn resume(&mut self, mark: &Mark<R>, direction: Vec3<R>, active: R::Mask) -> R {
        let ray = Ray {
            origin: mark.place,
            direction,
        };
        self.set_out(&ray, mark.low, mark.index, active);
        self.majorant = R::select(active, mark.majorant, self.majorant);
        self.reach = R::select(active, mark.reach, self.reach);
        let last = self.layout.last;
        let exit = |o: R, d: R, inverse: R, last: R| (last.or_zero(R::zero().le(d)) - o) * inverse;
        let (o, d, inverse) = (ray.origin, ray.direction, self.inverse);
        let x = exit(o.x, d.x, inverse.x, last.x);
        let y = exit(o.y, d.y, inverse.y, last.y);
        let z = exit(o.z, d.z, inverse.z, last.z);
        x.min(y).min(z)
    }

    /// Reads the present entry: a bound, or how much nothing lies ahead.
    #[inline(always)]
    fn read(&mut self, majorants: &[f32], active: R::Mask) {
        let entry = R::gather(majorants, self.index);
        let majorant = entry.max(R::zero()) * self.layout.scale;
        let code = (-entry).max(R::zero()).to_word();
        let further = code.shr_each(self.octant) & R::Word::splat(CODE_MASK);
        let reach = R::from_word(further) + R::one();
        self.majorant = R::select(active, majorant, self.majorant);
        self.reach = R::select(active, reach, self.reach);
    }

    /// Distances to the present segment's exit faces.
    #[inline(always)]
    fn exits(&self) -> Vec3<R> {
        let far = self.near + self.across * self.reach;
        (far - self.origin).times(self.inverse)
    }

    /// The present block's bound and where the ray leaves it, or the empty cube ahead.
    #[inline(always)]
    pub fn segment(&self) -> Segment<R> {
        let exits = self.exits();
        Segment {
            majorant: self.majorant,
            t_exit: exits.x.min(exits.y).min(exits.z),
        }
    }

    /// What a table in the layout of the bounds says of the present block, scaled as the bounds are.
    #[inline(always)]
    pub fn of_block(&self, table: &[f32]) -> R {
        R::gather(table, self.index) * self.layout.scale
    }

    /// Steps the active lanes into the block beyond the nearest face.
    #[inline(always)]
    pub fn next_segment(&mut self, majorants: &[f32], active: R::Mask) {
        let exits = self.exits();
        let along_x = exits.x.le(exits.y) & exits.x.le(exits.z) & active;
        let along_y = exits.y.le(exits.z).and_not(along_x) & active;
        let along_z = active.and_not(along_x | along_y);
        let leaping = R::one().lt(self.reach) & active;
        if leaping.any() {
            self.leap([along_x, along_y, along_z], active);
        } else {
            self.near = Vec3::new(
                self.near.x + self.across.x.or_zero(along_x),
                self.near.y + self.across.y.or_zero(along_y),
                self.near.z + self.across.z.or_zero(along_z),
            );
            let zero = R::Word::splat(0);
            let [x, y, z] = self.strides;
            self.index = self.index
                + R::Word::select(along_x, x, zero)
                + R::Word::select(along_y, y, zero)
                + R::Word::select(along_z, z, zero);
        }
        self.read(majorants, active);
    }

    /// Steps over the present cubes: by their whole edge along one axis, along the others to where the ray is.
    #[inline(always)]
    fn leap(&mut self, along: [R::Mask; 3], active: R::Mask) {
        let t = self.segment().t_exit;
        let inside = self.origin + self.direction * t - self.near;
        // Exact: edges are powers of two.
        let blocks = R::one() / (self.layout.edge * self.layout.edge);
        let last = self.reach - R::one();
        let steps = |inside: R, across: R, along: R::Mask| {
            let passed = (inside * (across * blocks)).max(R::zero()).min(last);
            let passed = R::from_word(passed.to_word());
            R::select(along, self.reach, passed).or_zero(active)
        };
        let steps = Vec3::new(
            steps(inside.x, self.across.x, along[0]),
            steps(inside.y, self.across.y, along[1]),
            steps(inside.z, self.across.z, along[2]),
        );
        self.near = self.near + self.across.times(steps);
        let [x, y, z] = self.strides;
        self.index =
            self.index + x * steps.x.to_word() + y * steps.y.to_word() + z * steps.z.to_word();
    }

    /// The place at distance `t` in grid space, kept within the present block and the domain.
    #[inline(always)]
    pub fn place(&self, t: R) -> Vec3<R> {
        let p = self.origin + self.direction * t;
        let clamp = |p: R, near: R, across: R, last: R| {
            let far = near + across;
            let (low, high) = (near.min(far), near.max(far));
            p.max(low).min(high.min(last)).max(R::zero())
        };
        Vec3::new(
            clamp(p.x, self.near.x, self.across.x, self.layout.last.x),
            clamp(p.y, self.near.y, self.across.y, self.layout.last.y),
            clamp(p.z, self.near.z, self.across.z, self.layout.last.z),
        )
    }

    /// One-tap stochastic trilinear look-up of the extinction at distance `t` [1/length].
    ///
    /// The sample that [`tap`](Self::tap) picks, so the expectation is the interpolant, and an analog
    /// decision that compares it with a uniform number has exactly the same probability.
    #[inline(always)]
    pub fn sigma_t(&self, samples: &[f32], t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        self.value(samples, self.tap(t, rng, active))
    }

    /// The extinction that a [tap](Self::tap) stands for [1/length].
    #[inline(always)]
    pub fn value(&self, samples: &[f32], tap: R::Word) -> R {
        R::gather(samples, tap) * self.layout.scale
    }

    /// The index of one of the eight samples around the place at distance `t`, picked with its
    /// trilinear weight.
    ///
    /// Whatever else is known of that sample (albedo, colour) may be read at the same index: linear
    /// combinations of such values have the interpolants as their expectations. Two draws: 21, 21 and
    /// 22 bits for the three axes.
    #[inline(always)]
    pub fn tap(&self, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R::Word {
        let [x, y, z] = self.corner(t, rng, active);
        self.layout.samples + x + y * self.layout.strides[0] + z * self.layout.strides[1]
    }

    /// As [`tap`](Self::tap), of samples in bricks: the strides of the layout are those of the lattice.
    #[inline(always)]
    pub(crate) fn tap_in(
        &self,
        bricks: &Bricks<'_>,
        t: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> R::Word {
        bricks.index::<R>(self.corner(t, rng, active), self.layout.strides)
    }

    /// The coordinates of the sample of a [tap](Self::tap).
    #[inline(always)]
    fn corner(&self, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> [R::Word; 3] {
        let place = self.place(t);
        let (a, b) = (rng.next_word(active), rng.next_word(active));
        let low_bits = R::Word::splat(0x7ff);
        let c = (a & low_bits).shl(11) | (b & low_bits);
        // The corner beyond, with probability equal to the fraction.
        let corner = |p: R, bits: R::Word, range: f32| {
            let cell = p.to_word();
            let fraction = p - R::from_word(cell);
            let u = R::from_word(bits) + R::splat(0.5);
            cell + R::Word::from_mask(u.lt(fraction * R::splat(range)))
        };
        let x = corner(place.x, a.shr(11), 2_097_152.0);
        let y = corner(place.y, b.shr(11), 2_097_152.0);
        let z = corner(place.z, c, 4_194_304.0);
        [x, y, z]
    }

    /// What samples and bounds are multiplied with to give extinction [1/length].
    #[inline(always)]
    pub(crate) fn scale(&self) -> R {
        self.layout.scale
    }

    /// The full trilinear interpolant at distance `t` [1/length]: eight look-ups, no draws.
    #[inline(always)]
    pub fn trilinear(&self, samples: &[f32], t: R) -> R {
        let place = self.place(t);
        let cell = |p: R| p.to_word();
        let (x, y, z) = (cell(place.x), cell(place.y), cell(place.z));
        let weight = |p: R, cell: R::Word| p - R::from_word(cell);
        let (wx, wy, wz) = (weight(place.x, x), weight(place.y, y), weight(place.z, z));
        // On the far face of the domain the weight is zero and the sample beyond must not be named.
        let one =
            |w: R, stride: R::Word| R::Word::select(R::zero().lt(w), stride, R::Word::splat(0));
        let dx = one(wx, R::Word::splat(1));
        let dy = one(wy, self.layout.strides[0]);
        let dz = one(wz, self.layout.strides[1]);
        let base =
            self.layout.samples + x + y * self.layout.strides[0] + z * self.layout.strides[1];
        let lerp = |w: R, a: R, b: R| a * (R::one() - w) + b * w;
        let row = |i: R::Word| lerp(wx, R::gather(samples, i), R::gather(samples, i + dx));
        let slice = |i: R::Word| lerp(wy, row(i), row(i + dy));
        lerp(wz, slice(base), slice(base + dz)) * self.layout.scale
    }
}
