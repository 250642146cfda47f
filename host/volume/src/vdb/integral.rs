//! The trilinear interpolant of a tree, at a point and exactly along a segment.
//!
//! Between eight neighbouring voxel centres the interpolant along a line is a cubic in t, so Gauss's two-point rule is
//! exact there. Where neighbours come from tiles, the same eight values hold over a whole box of cells (an axis along
//! which nothing changes may be as long as the tile), so a ray crosses a tile in one step and the face between two
//! tiles in one more, however many voxels they stand for.

use super::tree::{Found, ROOT, Tree};
use super::values::Voxel;
use glam::DVec3;

/// Largest index coordinate treated as such \[voxels\]; far outside of all that 32-bit trees hold.
const FAR: f64 = 1e15;

/// Cells that share the values of their corners: a box of whole cells in index space.
struct Block {
    /// Corner values; bit 2 of the index is the x side, bit 1 y, bit 0 z.
    corners: [f64; 8],
    /// Lowest and highest plane of the box per axis \[voxels\].
    low: [i64; 3],
    high: [i64; 3],
}

impl Block {
    fn new<T: Voxel>(tree: &Tree<T>, component: usize, cell: [i64; 3]) -> Self {
        let side = |n: usize, a: usize| (n >> (2 - a) & 1) as i64;
        let found: [Found<T>; 8] =
            std::array::from_fn(|n| tree.find(std::array::from_fn(|a| cell[a] + side(n, a))));
        // First and last voxel, along an axis, of the aligned cube in which a corner's value holds.
        let first = |n: usize, a: usize| (cell[a] + side(n, a)) >> found[n].log2 << found[n].log2;
        let last = |n: usize, a: usize| first(n, a) + (1 << found[n].log2) - 1;
        let mut low = cell;
        let mut high = cell.map(|v| v + 1);
        for a in 0..3 {
            // Aligned cubes nest or are disjoint: if each lower corner's cube holds its upper neighbour, it is the same.
            if (0..8).any(|n| side(n, a) == 0 && last(n, a) <= cell[a]) {
                continue;
            }
            low[a] = (0..8).map(|n| first(n, a)).fold(i64::MIN, i64::max);
            high[a] = (0..8).map(|n| last(n, a)).fold(i64::MAX, i64::min);
        }
        Self {
            corners: found.map(|corner| corner.value.component(component)),
            low,
            high,
        }
    }

    /// The interpolant at `p`; `cell` is any cell of the block.
    fn value(&self, cell: [i64; 3], p: DVec3) -> f64 {
        let p = p.to_array();
        let u: [f64; 3] = std::array::from_fn(|a| (p[a] - cell[a] as f64).clamp(0.0, 1.0));
        let lerp = |low: f64, high: f64, u: f64| low * (1.0 - u) + high * u;
        let c = &self.corners;
        let along_z: [f64; 4] = std::array::from_fn(|n| lerp(c[2 * n], c[2 * n + 1], u[2]));
        let low = lerp(along_z[0], along_z[1], u[1]);
        let high = lerp(along_z[2], along_z[3], u[1]);
        lerp(low, high, u[0])
    }
}

fn cell_of(p: DVec3) -> [i64; 3] {
    p.to_array().map(|v| v.floor() as i64)
}

/// The interpolant at a point of index space; NaN where the point is not finite.
pub(super) fn trilinear<T: Voxel>(tree: &Tree<T>, component: usize, p: DVec3) -> f64 {
    if !p.is_finite() {
        return f64::NAN;
    }
    if p.abs().max_element() > FAR {
        return tree.background.component(component);
    }
    let cell = cell_of(p);
    Block::new(tree, component, cell).value(cell, p)
}

/// The part of a segment outside of which everything is background.
struct Clipped {
    from: DVec3,
    to: DVec3,
    /// Its share of the whole segment.
    share: f64,
}

/// Clips to the box of all root entries, which also brings far ends to where neighbouring voxels differ in `f64`.
fn clip<T>(tree: &Tree<T>, a: DVec3, b: DVec3) -> Option<Clipped> {
    let (first, _) = tree.root.first()?;
    let (mut low, mut high) = (*first, *first);
    for (key, _) in &tree.root {
        for axis in 0..3 {
            low[axis] = low[axis].min(key[axis]);
            high[axis] = high[axis].max(key[axis]);
        }
    }
    // One cell more on either side: it interpolates towards the background.
    let low = DVec3::from_array(low.map(|v| (i64::from(v) << ROOT) as f64 - 1.0));
    let high = DVec3::from_array(high.map(|v| ((i64::from(v) + 1) << ROOT) as f64));
    let d = b - a;
    let (mut t0, mut t1) = (0.0_f64, 1.0_f64);
    for axis in 0..3 {
        if d[axis] == 0.0 {
            if a[axis] < low[axis] || a[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let s = (low[axis] - a[axis]) / d[axis];
        let e = (high[axis] - a[axis]) / d[axis];
        t0 = t0.max(s.min(e));
        t1 = t1.min(s.max(e));
    }
    let at = |t: f64, end: DVec3, own: f64| {
        if t == own {
            end
        } else {
            (a + d * t).clamp(low, high)
        }
    };
    (t0 < t1).then(|| Clipped {
        from: at(t0, a, 0.0),
        to: at(t1, b, 1.0),
        share: t1 - t0,
    })
}

/// ∫₀¹ f(a + t (b − a)) dt of the interpolant f in index space: the mean value along the segment.
///
/// NaN where an end is not finite. Steps: one per leaf cell and per pair of neighbouring tiles that the segment meets.
pub(super) fn mean_along<T: Voxel>(tree: &Tree<T>, component: usize, a: DVec3, b: DVec3) -> f64 {
    if !(a.is_finite() && b.is_finite() && (b - a).is_finite()) {
        return f64::NAN;
    }
    let background = tree.background.component(component);
    let Some(inside) = clip(tree, a, b) else {
        return background;
    };
    let mean = walk(tree, component, inside.from, inside.to);
    if inside.share < 1.0 {
        return mean * inside.share + background * (1.0 - inside.share);
    }
    mean
}

/// [`mean_along`] of a segment within the box of all root entries.
fn walk<T: Voxel>(tree: &Tree<T>, component: usize, a: DVec3, b: DVec3) -> f64 {
    let d = b - a;
    let mut sum = 0.0;
    let mut lost = 0.0; // Kahan: thousands of small terms
    let mut t = 0.0;
    let mut cell = cell_of(a + d * t);
    loop {
        let block = Block::new(tree, component, cell);
        let mut exit = 1.0;
        let mut through = None;
        for axis in 0..3 {
            let plane = match d[axis] {
                v if v > 0.0 => block.high[axis],
                v if v < 0.0 => block.low[axis],
                _ => continue,
            };
            let at = (plane as f64 - a[axis]) / d[axis];
            if at < exit {
                exit = at;
                through = Some(axis);
            }
        }
        let exit = exit.max(t);
        if exit > t {
            let middle = 0.5 * (t + exit);
            let offset = 0.5 * (exit - t) / 3.0_f64.sqrt();
            let mut f = 0.0;
            for at in [middle - offset, middle + offset] {
                f += block.value(cell, a + d * at);
            }
            let term = 0.5 * (exit - t) * f - lost;
            let next = sum + term;
            lost = (next - sum) - term;
            sum = next;
        }
        t = exit;
        let Some(through) = through else { return sum };
        // The axis that was left moves on by at least a cell, the others never back: the walk ends.
        let here = cell_of(a + d * t);
        for axis in 0..3 {
            let inside = here[axis].clamp(block.low[axis], block.high[axis] - 1);
            if d[axis] > 0.0 {
                cell[axis] = inside.max(cell[axis]);
            } else if d[axis] < 0.0 {
                cell[axis] = inside.min(cell[axis]);
            }
        }
        cell[through] = if d[through] > 0.0 {
            block.high[through]
        } else {
            block.low[through] - 1
        };
    }
}
