//! Extinction by a function of the place within a box, under a proven bound for each of its cells.
//!
//! ```text
//! σ_t(p) ≤ σ̄ᵢ  for all p of cell i,   because  σ_t(p) ∈ Σ(cell i),  σ̄ᵢ ≥ max Σ(cell i)
//! ```
//!
//! Σ is the interval extension of σ_t: the caller writes the formula a second time, over
//! [`Enclosure`]s, and [`new`](ProceduralGrid::new) proves that the bounds cover it in every cell. That
//! both are the same formula is what remains to be trusted. Tighter than one bound for everything
//! ([`Procedural`](crate::medium::Procedural)) wherever the extinction varies; a finer grid makes
//! extensions tighter and walks longer. [`Cells`] says how places are kept within their cells.

use crate::enclosure::Enclosure;
use crate::majorant::{CellError, Cells, GridWalk, Segment};
use crate::medium::{Control, Controlled, Medium};
use crate::ray::{Interval, Ray};
use crate::real::Real;
use crate::stream::Stream;
use crate::vec3::Vec3;

/// A procedural medium that fills a box, with borrowed bounds.
#[derive(Clone, Copy, Debug)]
pub struct ProceduralGrid<'a, F> {
    sigma_t: F,
    cells: Cells,
    majorants: &'a [f32],
}

impl<'a, F> ProceduralGrid<'a, F> {
    /// * `sigma_t`: extinction at a place in the box, per lane [1/length]; not negative, total, as
    ///   finished lanes ask too.
    /// * `extension`: the same formula over enclosures, operation by operation.
    /// * `majorants`: a bound for each cell, as [`Cells::fill_majorants`] computes them [1/length].
    ///
    /// # Errors
    /// A wrong length, or the first cell whose bound fails.
    ///
    /// # Example: a puff of smoke
    /// ```
    /// use woodcock_core::enclosure::Enclosure;
    /// use woodcock_core::majorant::Cells;
    /// use woodcock_core::medium::ProceduralGrid;
    /// use woodcock_core::vec3::Vec3;
    ///
    /// let sigma_t = |p: Vec3<f32>| 3.0 * woodcock_core::elementary::exp(p.dot(p) * -4.0);
    /// let extension = |[x, y, z]: [Enclosure; 3]| {
    ///     ((x.square() + y.square() + z.square()) * -4.0).exp() * 3.0
    /// };
    /// let cells = Cells::new([-1.0; 3], [1.0; 3], [2, 2, 2])?;
    /// let mut majorants = [0.0; 64];
    /// cells.fill_majorants(extension, &mut majorants)?;
    /// let puff = ProceduralGrid::new(sigma_t, cells, extension, &majorants)?;
    /// # let _ = puff;
    /// # Ok::<(), woodcock_core::majorant::CellError>(())
    /// ```
    pub fn new(
        sigma_t: F,
        cells: Cells,
        extension: impl Fn([Enclosure; 3]) -> Enclosure,
        majorants: &'a [f32],
    ) -> Result<Self, CellError> {
        cells.prove(extension, majorants)?;
        Ok(Self {
            sigma_t,
            cells,
            majorants,
        })
    }

    /// The part of a ray within the box, which is the medium's domain.
    #[inline(always)]
    pub fn clip<R: Real>(&self, ray: &Ray<R>) -> Interval<R> {
        self.cells.clip(ray)
    }
}

impl<R: Real, F: Fn(Vec3<R>) -> R> Medium<R> for ProceduralGrid<'_, F> {
    type Walk = GridWalk<R>;
    const ONE_SEGMENT: bool = false;
    const TIGHT: bool = false;

    #[inline(always)]
    fn idle(&self) -> GridWalk<R> {
        GridWalk::idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut GridWalk<R>, ray: &Ray<R>, active: R::Mask) {
        let ray = self.cells.in_units(ray);
        walk.begin(&self.cells.layout(), &ray, self.majorants, active);
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
    fn sigma_t(&self, walk: &GridWalk<R>, t: R, _: &mut impl Stream<R>, _: R::Mask) -> R {
        (self.sigma_t)(self.cells.place(walk.place(t)))
    }
}

/// Nothing is known from below.
impl<R: Real, F: Fn(Vec3<R>) -> R> Controlled<R> for ProceduralGrid<'_, F> {
    #[inline(always)]
    fn control(&self, _: &GridWalk<R>) -> Control<R> {
        Control {
            minimum: R::zero(),
            mean: R::zero(),
        }
    }
}
