//! A tree of lights: to choose one among many by what each may matter at a place, in logarithmic time.
//!
//! ```text
//! p(light) = ∏ over the walk down  I(child taken) / (I(first) + I(second)),   I as in `extent`
//! ```
//!
//! Built by the surface area orientation heuristic, walked from the root at a random number [Conty Estevez, Kulla
//! 2018]. The way to each light is kept, so the probability of a given one takes the same walk and has the same bits.
//! Where both children seem dark, strength decides: so the probabilities of all lights sum to one at every place.
//!
//! Memory: about 300 bytes per light.

mod extent;

use glam::DVec3;

use extent::Bound;
pub(super) use extent::Extent;

use super::discrete::BELOW_ONE;

/// Bins per axis that splits are sought between.
const BINS: usize = 12;

/// Depth from which groups are halved by number, whatever their place: 64 bits hold any way.
const HALVE_FROM: u32 = 30;

/// Neither child of a node that both may matter is taken less often than this, which 32-bit random numbers can tell.
const LEAST: f64 = 1.0 / 16_777_216.0;

/// Bytes that a tree takes for each light, and its building besides.
pub(super) const BYTES_PER_LIGHT: u64 = 600;

#[derive(Clone, Copy, Debug)]
enum Link {
    /// One light.
    Leaf(u32),
    /// The first child follows its parent; this is the second.
    Inner(u32),
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bound: Bound,
    link: Link,
}

/// A tree of lights.
#[derive(Debug, Default)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    /// For each item, the turns from the root, the first in the lowest bit.
    ways: Vec<u64>,
    /// Least squared distance that counts.
    nearest: f64,
}

impl Tree {
    /// * `items`: lights, each of positive strength; a light is named by its index here.
    /// * `scale`: length that the distances of the scene are to be compared with, positive also in single precision.
    pub(super) fn new(items: &[Extent], scale: f64) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity(2 * items.len()),
            ways: vec![0; items.len()],
            // A place on a light must not make it infinitely important.
            nearest: (scale * 1e-12) * (scale * 1e-12),
        };
        let mut order: Vec<u32> = (0..items.len() as u32).collect();
        if !order.is_empty() {
            tree.build(items, &mut order, 0, 0);
        }
        tree
    }

    pub(super) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Adds a group of lights; its extent.
    fn build(&mut self, items: &[Extent], group: &mut [u32], depth: u32, way: u64) -> Extent {
        let index = self.nodes.len();
        if let [item] = *group {
            let extent = items[item as usize];
            self.ways[item as usize] = way;
            self.nodes.push(Node {
                bound: extent.bound(),
                link: Link::Leaf(item),
            });
            return extent;
        }
        let middle = split(items, group, depth);
        let (first, second) = group.split_at_mut(middle);
        // Its place, until the children are known.
        self.nodes.push(Node {
            bound: items[first[0] as usize].bound(),
            link: Link::Inner(0),
        });
        let first = self.build(items, first, depth + 1, way);
        let link = Link::Inner(self.nodes.len() as u32);
        let second = self.build(items, second, depth + 1, way | 1 << depth);
        let extent = first.union(&second);
        self.nodes[index] = Node {
            bound: extent.bound(),
            link,
        };
        extent
    }

    /// What all lights together may matter at a place; zero only where none shines.
    pub(super) fn importance(&self, from: DVec3, normal: DVec3) -> f64 {
        let importance = |root: &Node| root.bound.importance(from, normal, self.nearest);
        self.nodes.first().map_or(0.0, importance)
    }

    /// Probability of the first child. Neither is impossible where both may matter.
    fn first_share(&self, first: &Node, second: &Node, from: DVec3, normal: DVec3) -> f64 {
        let of = |node: &Node| node.bound.importance(from, normal, self.nearest);
        match (of(first), of(second)) {
            (0.0, 0.0) => {
                let (a, b) = (first.bound.strength(), second.bound.strength());
                a / (a + b)
            }
            (_, 0.0) => 1.0,
            (0.0, _) => 0.0,
            (a, b) => (a / (a + b)).clamp(LEAST, 1.0 - LEAST),
        }
    }

    /// An item at u in [0, 1), its probability, and what is left of u, again uniform.
    pub(super) fn choose(&self, from: DVec3, normal: DVec3, u: f64) -> Option<(u32, f64, f64)> {
        let (mut u, mut probability) = (u, 1.0);
        let mut index = 0;
        loop {
            let second = match self.nodes.get(index)?.link {
                Link::Leaf(item) => return Some((item, probability, u)),
                Link::Inner(second) => second as usize,
            };
            let share = self.first_share(
                self.nodes.get(index + 1)?,
                self.nodes.get(second)?,
                from,
                normal,
            );
            if u < share {
                u /= share;
                probability *= share;
                index += 1;
            } else {
                u = (u - share) / (1.0 - share);
                probability *= 1.0 - share;
                index = second;
            }
            u = u.min(BELOW_ONE);
        }
    }

    /// The probability with which [`choose`](Self::choose) takes an item, to the bit.
    pub(super) fn probability(&self, item: u32, from: DVec3, normal: DVec3) -> f64 {
        let Some(&(mut way)) = self.ways.get(item as usize) else {
            return 0.0;
        };
        let mut probability = 1.0;
        let mut index = 0;
        while let Some(Node {
            link: Link::Inner(second),
            ..
        }) = self.nodes.get(index)
        {
            let second = *second as usize;
            let (Some(a), Some(b)) = (self.nodes.get(index + 1), self.nodes.get(second)) else {
                return 0.0;
            };
            let share = self.first_share(a, b, from, normal);
            if way & 1 == 0 {
                probability *= share;
                index += 1;
            } else {
                probability *= 1.0 - share;
                index = second;
            }
            way >>= 1;
        }
        probability
    }
}

/// Sorts a group of two or more so that a good first part stands in front; its length, neither zero nor all.
fn split(items: &[Extent], group: &mut [u32], depth: u32) -> usize {
    let half = group.len() / 2;
    let centre = |item: u32| items[item as usize].centre();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &item in group.iter() {
        low = low.min(centre(item));
        high = high.max(centre(item));
        least = least.min(items[item as usize].low);
        most = most.max(items[item as usize].high);
    }
    if depth >= HALVE_FROM {
        return half;
    }
    let size = most - least;
    let longest = size.max_element();
    let bin_of = |item: u32, axis: usize| {
        let at = (centre(item)[axis] - low[axis]) / (high[axis] - low[axis]);
        ((at * BINS as f64) as usize).min(BINS - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        if high[axis] <= low[axis] {
            continue;
        }
        let mut bins: [Option<Extent>; BINS] = [None; BINS];
        for &item in group.iter() {
            let bin = &mut bins[bin_of(item, axis)];
            *bin = merged(*bin, Some(items[item as usize]));
        }
        // From the right, then from the left.
        let mut behind = [None; BINS];
        for i in (1..BINS).rev() {
            behind[i - 1] = merged(behind[i], bins[i]);
        }
        let mut before = None;
        for i in 0..BINS - 1 {
            before = merged(before, bins[i]);
            let (Some(a), Some(b)) = (before, behind[i]) else {
                continue;
            };
            // Thin slabs are poor groups: their long sides see little of the gain.
            let cost = (a.cost() + b.cost()) * (longest / size[axis]);
            if best.is_none_or(|(least, _, _)| cost < least) {
                best = Some((cost, axis, i));
            }
        }
    }
    // All in one place: any halves are as good.
    let Some((_, axis, last)) = best else {
        return half;
    };
    // Stable, so that equal scenes give equal trees.
    group.sort_by_key(|&item| bin_of(item, axis) > last);
    group.partition_point(|&item| bin_of(item, axis) <= last)
}

fn merged(a: Option<Extent>, b: Option<Extent>) -> Option<Extent> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a.union(&b)),
        (a, b) => a.or(b),
    }
}

#[cfg(test)]
mod tests;
