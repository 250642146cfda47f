//! Media that shine, as packets meet them: light is scored at every tentative collision of a flight, unless a
//! [comb](crate::path::glow()) has found it.
//!
//! ```text
//! L = E[ Σᵢ β σ_a(tᵢ) L_e(tᵢ) / σ̄ ],  tᵢ the tentative collisions up to the first real one
//! ```
//!
//! which also finds light where little is absorbed, and more often than collisions would ([Raab, Seibert, Keller 2006],
//! [Simon 2017]). σ_a is that of the tap. L_e is no linear function of what is interpolated (a temperature, a product),
//! so all its parts are interpolated in full at the place itself.

use crate::majorant::{Mark, Segment};
use crate::medium::{Affine, Control, Controlled, Medium, transform_ray};
use crate::path::{Decided, Optics, PathMedium, Tapped};
use crate::ray::Ray;
use crate::real::{Mask, Real, Word};
use crate::stream::Stream;
use crate::vec3::Vec3;

/// Samples at the integers of a space of their own, trilinear in between; beyond them goes on what is outermost.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// x fastest; as many in a row for each place as asked for.
    pub values: &'a [f32],
    /// Places along x, y, z; at least two each.
    pub dims: [u32; 3],
    /// World to where samples lie at the integers.
    pub world_to_grid: Affine,
}

impl Field<'_> {
    /// The interpolants of `N` quantities at a place of the world, per lane.
    #[inline(always)]
    fn at<R: Real, const N: usize>(&self, place: Vec3<R>) -> [R; N] {
        let rows = self.world_to_grid.map(|row| row.map(R::splat));
        let direction = Vec3::uniform(0.0);
        let origin = place;
        let p = transform_ray(rows, &Ray { origin, direction }).origin;
        let [nx, ny, nz] = self.dims;
        // The cell of a place, and how far into it; a NaN comes to the near end.
        let split = |p: R, n: u32| {
            let last = R::splat(n.saturating_sub(1) as f32);
            let p = p.max(R::zero()).min(last);
            let cell = R::from_word(p.to_word()).min(R::splat(n.saturating_sub(2) as f32));
            (cell.to_word(), p - cell)
        };
        let ((x, wx), (y, wy), (z, wz)) = (split(p.x, nx), split(p.y, ny), split(p.z, nz));
        let stride = |places: u32| R::Word::splat(places.wrapping_mul(N as u32));
        let (dx, dy, dz) = (stride(1), stride(nx), stride(nx.wrapping_mul(ny)));
        let base = x * dx + y * dy + z * dz;
        let mut found = [R::zero(); N];
        for (n, found) in found.iter_mut().enumerate() {
            let base = base + R::Word::splat(n as u32);
            let lerp = |w: R, a: R, b: R| a * (R::one() - w) + b * w;
            let at = |i: R::Word| R::gather(self.values, i);
            let row = |i: R::Word| lerp(wx, at(i), at(i + dx));
            let slice = |i: R::Word| lerp(wy, row(i), row(i + dy));
            *found = lerp(wz, slice(base), slice(base + dz));
        }
        found
    }
}

/// Colours of black bodies over temperature, equidistant in √(1/T) and linear in between.
#[derive(Clone, Copy, Debug)]
pub struct BlackBodies<'a> {
    /// Red, green and blue of each entry, from the hottest to the coldest.
    pub colours: &'a [f32],
    /// √(1/T) of the first entry, and entries per unit of it.
    pub first: f32,
    /// See `first`.
    pub density: f32,
    /// No light at this temperature and below \[K\].
    pub dark: f32,
}

impl BlackBodies<'_> {
    #[inline(always)]
    fn at<R: Real>(&self, kelvin: R) -> Vec3<R> {
        let shines = R::splat(self.dark).lt(kelvin);
        if !shines.any() {
            return Vec3::uniform(0.0);
        }
        let last = (self.colours.len() / 3).saturating_sub(1);
        let place = (R::one() / kelvin.max(R::splat(self.dark))).sqrt();
        let at = (place - R::splat(self.first)) * R::splat(self.density);
        let at = at.max(R::zero()).min(R::splat(last as f32));
        let cell = R::from_word(at.to_word()).min(R::splat(last.saturating_sub(1) as f32));
        let w = at - cell;
        let base = cell.to_word() * R::Word::splat(3);
        let colour = |c: u32| {
            let i = base + R::Word::splat(c);
            let near = R::gather(self.colours, i);
            let far = R::gather(self.colours, i + R::Word::splat(3));
            (near * (R::one() - w) + far * w).or_zero(shines)
        };
        Vec3::new(colour(0), colour(1), colour(2))
    }
}

/// L_e but for a factor by place.
#[derive(Clone, Copy, Debug)]
pub enum Radiance<'a> {
    /// The same everywhere \[W/(m² sr)\].
    Constant([f32; 3]),
    /// Three numbers a place \[W/(m² sr)\].
    Field(Field<'a>),
    /// That of black bodies, scaled.
    Temperature {
        /// One number a place.
        values: Field<'a>,
        /// kelvin = value · scale + offset.
        scale: f32,
        /// See `scale`.
        offset: f32,
        /// Their light \[W/(m² sr)\].
        colours: BlackBodies<'a>,
    },
}

/// The light of a medium.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Absorption by colour, of extinction one.
    pub absorbed: [f32; 3],
    /// A factor by place.
    pub factor: Option<Field<'a>>,
    /// The rest.
    pub radiance: Radiance<'a>,
}

impl Source<'_> {
    /// L_e at a place of the world, by colour \[W/(m² sr)\].
    #[inline(always)]
    pub fn radiance<R: Real>(&self, place: Vec3<R>) -> Vec3<R> {
        let radiance = match &self.radiance {
            Radiance::Constant(radiance) => Vec3::splat(*radiance),
            Radiance::Field(field) => {
                let [r, g, b] = field.at::<R, 3>(place);
                Vec3::new(r, g, b)
            }
            Radiance::Temperature {
                values,
                scale,
                offset,
                colours,
            } => {
                let [value] = values.at::<R, 1>(place);
                colours.at(value * R::splat(*scale) + R::splat(*offset))
            }
        };
        match &self.factor {
            None => radiance,
            Some(field) => {
                let [factor] = field.at::<R, 1>(place);
                radiance * factor
            }
        }
    }
}

/// A medium and its light.
#[derive(Clone, Copy, Debug)]
pub struct Shining<'a, M> {
    /// What absorbs and scatters.
    pub medium: M,
    /// What it sends out.
    pub source: Source<'a>,
}

impl<R: Real, M: Medium<R>> Medium<R> for Shining<'_, M> {
    type Walk = M::Walk;
    const ONE_SEGMENT: bool = M::ONE_SEGMENT;
    const TIGHT: bool = M::TIGHT;

    #[inline(always)]
    fn idle(&self) -> M::Walk {
        self.medium.idle()
    }
    #[inline(always)]
    fn begin(&self, walk: &mut M::Walk, ray: &Ray<R>, active: R::Mask) {
        self.medium.begin(walk, ray, active);
    }
    #[inline(always)]
    fn segment(&self, walk: &M::Walk) -> Segment<R> {
        self.medium.segment(walk)
    }
    #[inline(always)]
    fn next_segment(&self, walk: &mut M::Walk, active: R::Mask) {
        self.medium.next_segment(walk, active);
    }
    #[inline(always)]
    fn sigma_t(&self, walk: &M::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R {
        self.medium.sigma_t(walk, t, rng, active)
    }
}

impl<R: Real, M: PathMedium<R>> PathMedium<R> for Shining<'_, M> {
    const CLOSED: bool = M::CLOSED;

    #[inline(always)]
    fn is_closed(&self, walk: &M::Walk) -> R::Mask {
        self.medium.is_closed(walk)
    }
    #[inline(always)]
    fn enter(&self, walk: &mut M::Walk, ray: &Ray<R>, id: R::Word, active: R::Mask) {
        self.medium.enter(walk, ray, id, active);
    }
    #[inline(always)]
    fn optics(&self, walk: &M::Walk) -> Optics<R> {
        self.medium.optics(walk)
    }
    #[inline(always)]
    fn is_alone(&self) -> bool {
        self.medium.is_alone()
    }
    #[inline(always)]
    fn mark(&self, walk: &M::Walk, t: R) -> Mark<R> {
        self.medium.mark(walk, t)
    }
    #[inline(always)]
    fn resume(&self, walk: &mut M::Walk, mark: &Mark<R>, direction: Vec3<R>, active: R::Mask) -> R {
        self.medium.resume(walk, mark, direction, active)
    }
}

impl<R: Real, M: Tapped<R>> Tapped<R> for Shining<'_, M> {
    const SHINES: bool = true;

    #[inline(always)]
    fn tap(&self, walk: &M::Walk, t: R, rng: &mut impl Stream<R>, active: R::Mask) -> R::Word {
        self.medium.tap(walk, t, rng, active)
    }
    #[inline(always)]
    fn value(&self, walk: &M::Walk, tap: R::Word, active: R::Mask) -> R {
        self.medium.value(walk, tap, active)
    }
    #[inline(always)]
    fn decide(
        &self,
        walk: &M::Walk,
        tap: R::Word,
        majorant: R,
        rng: &mut impl Stream<R>,
        active: R::Mask,
    ) -> Decided<R> {
        self.medium.decide(walk, tap, majorant, rng, active)
    }
    #[inline(always)]
    fn emission(&self, sigma_t: R, place: Vec3<R>) -> Vec3<R> {
        (Vec3::splat(self.source.absorbed) * sigma_t).times(self.source.radiance(place))
    }
}

impl<R: Real, M: Controlled<R>> Controlled<R> for Shining<'_, M> {
    #[inline(always)]
    fn control(&self, walk: &M::Walk) -> Control<R> {
        self.medium.control(walk)
    }
}
