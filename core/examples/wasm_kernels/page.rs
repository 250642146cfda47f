//! What a page writes into a module's memory: a medium of its own, made of the core's walk.

use woodcock_core::majorant::{BLOCK, GridLayout, GridWalk, Segment, block_counts};
use woodcock_core::medium::Medium;
use woodcock_core::ray::Ray;
use woodcock_core::real::{Real, Word};
use woodcock_core::stream::Stream;
use woodcock_core::vec3::Vec3;

/// What the page writes: a grid, and a ray in it.
#[repr(C)]
#[derive(Debug)]
pub struct Page {
    samples: *const f32,
    majorants: *const f32,
    dims: [u32; 3],
    scale: f32,
    pub(crate) origin: [f32; 3],
    pub(crate) direction: [f32; 3],
    pub(crate) t_max: f32,
}

/// The page's grid as a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lent<'a, R: Real> {
    samples: &'a [f32],
    majorants: &'a [f32],
    layout: GridLayout<R>,
}

impl Page {
    /// The grid, in as many lanes as are asked for.
    #[inline(never)]
    pub(crate) fn grid<R: Real>(&self) -> Lent<'_, R> {
        let [nx, ny, nz] = self.dims;
        let [bx, by, bz] = block_counts(self.dims, BLOCK).map(|n| n.wrapping_add(2));
        let [slice, slab] = [nx.wrapping_mul(ny), bx.wrapping_mul(by)];
        let [n, m] = [slice.wrapping_mul(nz), slab.wrapping_mul(bz)].map(|n| n as usize);
        let word = R::Word::splat;
        Lent {
            // SAFETY: the page's word; a module's memory holds no more than can be counted.
            samples: unsafe { core::slice::from_raw_parts(self.samples, n) },
            // SAFETY: as above.
            majorants: unsafe { core::slice::from_raw_parts(self.majorants, m) },
            layout: GridLayout {
                samples: word(0),
                strides: [word(nx), word(slice)],
                majorants: word(0),
                majorant_strides: [word(bx), word(slab)],
                edge: R::splat(BLOCK as f32),
                last: Vec3::splat(self.dims.map(|n| n.wrapping_sub(1) as f32)),
                scale: R::splat(self.scale),
            },
        }
    }
}

impl<R: Real> Medium<R> for Lent<'_, R> {
    type Walk = GridWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    fn idle(&self) -> GridWalk<R> {
        GridWalk::within(self.layout)
    }
    fn begin(&self, walk: &mut GridWalk<R>, ray: &Ray<R>, active: R::Mask) {
        walk.enter(ray, self.majorants, active);
    }
    fn segment(&self, walk: &GridWalk<R>) -> Segment<R> {
        walk.segment()
    }
    fn next_segment(&self, walk: &mut GridWalk<R>, active: R::Mask) {
        walk.next_segment(self.majorants, active);
    }
    fn sigma_t(&self, walk: &GridWalk<R>, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        walk.sigma_t(self.samples, t, rng, active)
    }
}
