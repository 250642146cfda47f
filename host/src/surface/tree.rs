//! A tree of boxes, and the walk of a ray through it.
//!
//! obvhs builds it; the walk is our own. Boxes are kept as `f32`, relative to their middle and scaled to order one,
//! so that neither tiny nor distant scenes lose them, and rounded outwards. Rays stay in double precision: no hit
//! of double precision is culled, and boxes need no further room.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ploc::SortPrecision;

use crate::line::ROUNDING;

/// Either two further nodes or a run of leaves.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Lower corner, then upper corner.
    planes: [f32; 6],
    /// Of the two nodes, or of the leaves.
    first: u32,
    /// How many leaves; 0 for two nodes.
    count: u32,
}

/// Two nodes that are always looked at together: one line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Pair([Node; 2]);

/// Boxes sorted for rays. 32 bytes per node, at most two nodes per leaf.
#[derive(Debug, Default)]
pub(super) struct Tree {
    root: Option<Node>,
    pairs: Vec<Pair>,
    middle: DVec3,
    /// A power of two.
    scale: f64,
}

/// Nodes that a walk has still to visit, nearest last: twice the pair plus the side, and where the ray enters.
/// Deep trees spill to the heap.
struct Pending {
    near: [(u32, f64); 32],
    count: usize,
    deep: Vec<(u32, f64)>,
}

impl Pending {
    fn push(&mut self, entry: (u32, f64)) {
        if let Some(place) = self.near.get_mut(self.count) {
            *place = entry;
            self.count += 1;
        } else {
            self.deep.push(entry);
        }
    }

    fn pop(&mut self) -> Option<(u32, f64)> {
        self.deep.pop().or_else(|| {
            self.count = self.count.checked_sub(1)?;
            self.near.get(self.count).copied()
        })
    }
}

/// A ray in the space of the boxes.
struct Slabs {
    /// Where the planes that are entered and those that are left are counted from: the origin, moved by the
    /// rounding of its own coordinates so that either plane errs outwards.
    enter: [f64; 3],
    leave: [f64; 3],
    inverse: [f64; 3],
    /// Which plane is entered, by axis; the other is left.
    entered: [usize; 3],
    left: [usize; 3],
}

impl Slabs {
    fn new(origin: DVec3, direction: DVec3) -> Self {
        let slack = 4.0 * ROUNDING * origin.abs().max_element();
        let mut slabs = Self {
            enter: [0.0; 3],
            leave: [0.0; 3],
            inverse: [0.0; 3],
            entered: [0; 3],
            left: [0; 3],
        };
        for axis in 0..3 {
            // Without infinities no product is undefined; a ray this slow along an axis never reaches the next plane.
            let speed = direction[axis];
            slabs.inverse[axis] = if speed.abs() < 1e-200 {
                1e200_f64.copysign(speed)
            } else {
                1.0 / speed
            };
            let backwards = speed.is_sign_negative();
            let outwards = if backwards { -slack } else { slack };
            slabs.enter[axis] = origin[axis] + outwards;
            slabs.leave[axis] = origin[axis] - outwards;
            slabs.entered[axis] = if backwards { axis + 3 } else { axis };
            slabs.left[axis] = if backwards { axis } else { axis + 3 };
        }
        slabs
    }

    /// Where the ray enters a box; infinity if it misses it or enters after `t_max` [Ize 2013].
    #[inline]
    fn enter(&self, planes: &[f32; 6], t_max: f64) -> f64 {
        let mut near = 0.0_f64;
        let mut far = t_max;
        for axis in 0..3 {
            let a = (f64::from(planes[self.entered[axis]]) - self.enter[axis]) * self.inverse[axis];
            let b = (f64::from(planes[self.left[axis]]) - self.leave[axis]) * self.inverse[axis];
            near = if a > near { a } else { near };
            far = if b < far { b } else { far };
        }
        // Three roundings on either side.
        if near * (1.0 - 8.0 * ROUNDING) <= far * (1.0 + 8.0 * ROUNDING) {
            near
        } else {
            f64::INFINITY
        }
    }
}

impl Tree {
    /// Sorts boxes; returns the order of their leaves, too.
    ///
    /// * `boxes`: finite, of coordinates below 1e100.
    ///
    /// While it builds, some 200 bytes per box are taken.
    pub(super) fn new(boxes: &[[DVec3; 2]]) -> (Self, Vec<u32>) {
        let Some([low, high]) = union(boxes.iter().copied()) else {
            return (Self::default(), Vec::new());
        };
        let middle = low + (high - low) * 0.5;
        let half = (high - middle).max(middle - low).max_element();
        let scale = power_of_two_below(1.0 / half.max(1e-100));
        let relative = |p: DVec3| (p - middle) * scale;
        let round = |v: f64, away: f64| {
            let near = v as f32;
            // Beyond the nearest in any case.
            if away < 0.0 {
                near.next_down()
            } else {
                near.next_up()
            }
        };
        let boxes: Vec<Aabb> = boxes
            .iter()
            .map(|&[low, high]| {
                // What the corners themselves were rounded by.
                let room = (high - low) * 1e-12 + low.abs().max(high.abs()) * (8.0 * ROUNDING);
                let (low, high) = (relative(low - room), relative(high + room));
                let vec = |v: DVec3, away| {
                    Vec3A::new(round(v.x, away), round(v.y, away), round(v.z, away))
                };
                Aabb::new(vec(low, -1.0), vec(high, 1.0))
            })
            .collect();
        let built = build_bvh2(
            &boxes,
            BvhBuildParams {
                // Pieces cost more than boxes here.
                max_prims_per_leaf: 2,
                collapse_traversal_cost: 1.0,
                // A small object on a wide ground needs more than 21 bits.
                sort_precision: SortPrecision::U128,
                ..BvhBuildParams::medium_build()
            },
            &mut Duration::default(),
        );
        let (root, pairs) = paired(&built);
        let tree = Self {
            root,
            pairs,
            middle,
            scale,
        };
        (tree, built.primitive_indices)
    }

    /// Shows leaves in about the order that a ray meets their boxes, as long as those begin before `t_max`.
    ///
    /// * `leaf`: given the places of leaves in the order, and the present bound, it returns the next bound; a
    ///   negative one ends the walk.
    pub(super) fn walk(
        &self,
        origin: DVec3,
        direction: DVec3,
        mut t_max: f64,
        mut leaf: impl FnMut(std::ops::Range<usize>, f64) -> f64,
    ) {
        let slabs = Slabs::new((origin - self.middle) * self.scale, direction * self.scale);
        let Some(mut node) = self.root else {
            return;
        };
        if !slabs.enter(&node.planes, t_max).is_finite() {
            return;
        }
        let mut pending = Pending {
            near: [(0, 0.0); 32],
            count: 0,
            deep: Vec::new(),
        };
        loop {
            let first = node.first as usize;
            if node.count > 0 {
                t_max = leaf(first..first + node.count as usize, t_max);
                if t_max < 0.0 {
                    return;
                }
            } else if let Some(Pair([a, b])) = self.pairs.get(first) {
                let (s, t) = (slabs.enter(&a.planes, t_max), slabs.enter(&b.planes, t_max));
                let (near, side, near_t, far_t) = if t < s { (b, 0, t, s) } else { (a, 1, s, t) };
                if far_t.is_finite() {
                    pending.push((2 * node.first + side, far_t));
                }
                if near_t.is_finite() {
                    node = *near;
                    continue;
                }
            }
            loop {
                let Some((next, t)) = pending.pop() else {
                    return;
                };
                // Bounds came down since it was put aside; its entry may have been rounded up.
                if t * (1.0 - 8.0 * ROUNDING) <= t_max
                    && let Some(Pair(sides)) = self.pairs.get(next as usize / 2)
                {
                    node = sides[next as usize % 2];
                    break;
                }
            }
        }
    }
}

/// The nodes of a tree in pairs, each before what is below it and next to what is below its first.
fn paired(built: &Bvh2) -> (Option<Node>, Vec<Pair>) {
    let node = |i: u32| {
        built.nodes.get(i as usize).map(|node| {
            let aabb = node.aabb();
            let ([a, b, c], [d, e, f]) = (aabb.min.to_array(), aabb.max.to_array());
            Node {
                planes: [a, b, c, d, e, f],
                first: node.first_index,
                count: node.prim_count,
            }
        })
    };
    let Some(mut root) = node(0) else {
        return (None, Vec::new());
    };
    let mut pairs: Vec<Pair> = Vec::with_capacity(built.nodes.len() / 2);
    // Where the parent of what is to be placed stands: pair and side; none is the root.
    let mut open = Vec::new();
    if root.count == 0 {
        open.push((None, root.first));
    }
    while let Some((parent, first)) = open.pop() {
        let (Some(a), Some(b)) = (node(first), node(first + 1)) else {
            continue;
        };
        let place = pairs.len();
        match parent {
            None => root.first = place as u32,
            Some((pair, side)) => {
                let above: Option<&mut Pair> = pairs.get_mut::<usize>(pair);
                if let Some(above) = above.and_then(|p| p.0.get_mut::<usize>(side)) {
                    above.first = place as u32;
                }
            }
        }
        pairs.push(Pair([a, b]));
        for (side, child) in [(1, b), (0, a)] {
            if child.count == 0 {
                open.push((Some((place, side)), child.first));
            }
        }
    }
    (Some(root), pairs)
}

/// The box around boxes.
pub(super) fn union(boxes: impl Iterator<Item = [DVec3; 2]>) -> Option<[DVec3; 2]> {
    boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])
}

/// The power of two with the exponent of a positive normal number.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (0x7ff << 52))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_beyond_the_stack() {
        let mut pending = Pending {
            near: [(0, 0.0); 32],
            count: 0,
            deep: Vec::new(),
        };
        for i in 0..100 {
            pending.push((i, f64::from(i)));
        }
        for i in (0..100).rev() {
            assert_eq!(pending.pop(), Some((i, f64::from(i))));
        }
        assert_eq!(pending.pop(), None);
        assert!(pending.pop().is_none());
    }

    #[test]
    fn slabs_judge_by_the_planes_of_the_box() {
        let planes = [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0];
        let enter = |o: [f64; 3], d: [f64; 3], t_max| {
            Slabs::new(DVec3::from_array(o), DVec3::from_array(d)).enter(&planes, t_max)
        };
        let near = enter([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], 9.0);
        assert!((near - 2.0).abs() < 1e-14, "{near}");
        assert!(enter([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], 1.9).is_infinite());
        assert!(enter([-3.0, 0.0, 0.0], [-1.0, 0.0, 0.0], 9.0).is_infinite());
        assert!(enter([3.0, 0.0, 0.0], [-1.0, -0.0, 0.0], 9.0).is_finite());
        // Along a face, within it, and beside it.
        assert!(enter([-3.0, 1.0, 0.0], [1.0, 0.0, 0.0], 9.0).is_finite());
        assert!(enter([-3.0, 1.0, 0.0], [1.0, -0.0, 0.0], 9.0).is_finite());
        assert!(enter([-3.0, 1.0 + 1e-9, 0.0], [1.0, 0.0, 0.0], 9.0).is_infinite());
        // From inside.
        assert_eq!(enter([0.1, 0.2, 0.3], [0.6, 0.0, 0.8], 9.0), 0.0);
    }

    #[test]
    fn every_leaf_is_shown_once_and_the_walk_ends_when_told() {
        let boxes: Vec<_> = (0..1000)
            .map(|i| {
                let low = DVec3::new(f64::from(i), 0.0, 0.0);
                [low, low + DVec3::splat(0.5)]
            })
            .collect();
        let (tree, order) = Tree::new(&boxes);
        let mut shown = vec![0; 1000];
        let (origin, along) = (DVec3::new(-1.0, 0.25, 0.25), DVec3::X);
        tree.walk(origin, along, f64::INFINITY, |range, t_max| {
            for i in range {
                shown[order[i] as usize] += 1;
            }
            t_max
        });
        assert!(shown.iter().all(|&count| count == 1));
        let mut most = 0;
        tree.walk(origin, along, f64::INFINITY, |range, _| {
            most = range.map(|i| order[i]).fold(most, u32::max);
            if most > 3 { -1.0 } else { 3.2 }
        });
        assert!(most < 6, "{most}");
        let (empty, _) = Tree::new(&[]);
        empty.walk(origin, along, 1.0, |_, _| panic!("nothing is there"));
    }

    #[test]
    fn many_boxes_in_one_place_are_no_trouble() {
        let (tree, order) = Tree::new(&[[DVec3::ONE; 2]; 5000]);
        let mut shown = 0;
        tree.walk(DVec3::ZERO, DVec3::ONE, 9.0, |range, t_max| {
            shown += range.len();
            t_max
        });
        assert_eq!((shown, order.len()), (5000, 5000));
    }
}
