//! Surfaces that are traversed together: those of the world, or those of an object.

use glam::{DVec2, DVec3};

use super::part::{MOST_PIECES, Part};
use super::spot::{Placement, Spot};
use super::tree::{Tree, union};
use crate::line::Shear;
use crate::scene::{Place, SceneError};

/// An object placed in the world.
#[derive(Debug)]
pub(super) struct Instance {
    /// Which object.
    pub(super) object: usize,
    pub(super) placement: Placement,
}

/// What a leaf of the tree is. 8 bytes, beside the node's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Leaf {
    /// Which part; [`INSTANCE`] for an instance, [`CLUSTER`] for a cluster.
    part: u32,
    /// Which piece of the part, which instance, or which cluster.
    piece: u32,
}

const INSTANCE: u32 = u32::MAX;
const CLUSTER: u32 = u32::MAX - 1;

/// Parts of more pieces have a tree of their own.
const FEW: usize = 16;

/// Leaves with their tree.
#[derive(Debug, Default)]
struct Cluster {
    leaves: Vec<Leaf>,
    tree: Tree,
}

impl Cluster {
    fn new(leaves: &[Leaf], boxes: &[[DVec3; 2]]) -> Self {
        let (tree, order) = Tree::new(boxes);
        let leaves = order
            .iter()
            .filter_map(|&i| leaves.get(i as usize).copied())
            .collect();
        Self { leaves, tree }
    }
}

/// A line that is searched for what it meets.
#[derive(Clone, Copy)]
struct Line<'a> {
    objects: &'a [Group],
    origin: DVec3,
    direction: DVec3,
    shear: Shear,
}

/// What a ray met first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    pub(super) t: f64,
    /// Which instance, if any.
    pub(super) instance: Option<u32>,
    pub(super) part: u32,
    pub(super) piece: u32,
    at: DVec2,
}

impl Met {
    /// What counts among surfaces in the same place: the order of the scene.
    fn rank(&self) -> (Option<u32>, u32, u32) {
        (self.instance, self.part, self.piece)
    }
}

/// Boxes of which no more than this many are compared pair by pair.
const PAIRED: usize = 32;

/// Joins boxes until at most `most` ≥ 1 are left: at each step the two that have the smallest area together; neighbours on the longest
/// axis before, where there are many.
pub(super) fn join(mut boxes: Vec<[DVec3; 2]>, most: usize) -> Vec<[DVec3; 2]> {
    let both = |a: &[DVec3; 2], b: &[DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    if boxes.len() > PAIRED
        && let Some([low, high]) = union(boxes.iter().copied())
    {
        let extent = high - low;
        let axis = (0..3).fold(0, |a, b| if extent[b] > extent[a] { b } else { a });
        let middle = |b: &[DVec3; 2]| b[0][axis] + b[1][axis];
        boxes.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
        let run = boxes.len().div_ceil(PAIRED);
        let runs = boxes.chunks(run);
        boxes = runs.filter_map(|run| union(run.iter().copied())).collect();
    }
    while boxes.len() > most.max(1) {
        let mut least = (f64::INFINITY, 0, 0);
        for (i, a) in boxes.iter().enumerate() {
            for (j, b) in boxes.iter().enumerate().skip(i + 1) {
                let [low, high] = both(a, b);
                let e = high - low;
                let area = e.x * e.y + e.y * e.z + e.z * e.x;
                if area < least.0 || least.2 == 0 {
                    least = (area, i, j);
                }
            }
        }
        let (_, i, j) = least;
        let other = boxes.swap_remove(j);
        if let Some(one) = boxes.get_mut(i) {
            *one = both(one, &other);
        }
    }
    boxes
}

/// Parts, perhaps instances, and a tree over them.
///
/// The order in which obvhs sorts pieces is relative to the box around all: on a ground that is far wider than a mesh
/// it would see no difference between the mesh's triangles. So large parts are sorted on their own.
#[derive(Debug, Default)]
pub(super) struct Group {
    pub(super) parts: Vec<Part>,
    pub(super) instances: Vec<Instance>,
    clusters: Vec<Cluster>,
    top: Cluster,
    pub(super) bounds: Option<[DVec3; 2]>,
}

impl Group {
    /// Sorts the pieces of parts, and instances of objects.
    ///
    /// * `place`: where the scene describes what may be too much.
    pub(super) fn new(
        parts: Vec<Part>,
        instances: Vec<Instance>,
        objects: &[Self],
        place: Option<&Place>,
    ) -> Result<Self, SceneError> {
        let count = parts.iter().map(Part::pieces).sum::<usize>() + instances.len();
        if count > MOST_PIECES {
            let message = format!("more than {MOST_PIECES} pieces of surface");
            return Err(match place {
                Some(place) => SceneError::at(place, message),
                None => SceneError::of_file("scene", message),
            });
        }
        let (mut leaves, mut boxes) = (Vec::new(), Vec::new());
        let mut clusters = Vec::new();
        for (part, found) in (0..).zip(&parts) {
            let first = leaves.len();
            for piece in 0..found.pieces() as u32 {
                if let Some(bounds) = found.bounds(piece) {
                    leaves.push(Leaf { part, piece });
                    boxes.push(bounds);
                }
            }
            if leaves.len() - first > FEW
                && let Some(around) = union(boxes.iter().skip(first).copied())
            {
                let cluster = Leaf {
                    part: CLUSTER,
                    piece: clusters.len() as u32,
                };
                clusters.push(Cluster::new(
                    &leaves.split_off(first),
                    &boxes.split_off(first),
                ));
                leaves.push(cluster);
                boxes.push(around);
            }
        }
        for (piece, instance) in (0..).zip(&instances) {
            let own = objects.get(instance.object).and_then(|o| o.bounds);
            if let Some(own) = own {
                leaves.push(Leaf {
                    part: INSTANCE,
                    piece,
                });
                boxes.push(instance.placement.box_bounds(own));
            }
        }
        let bounds = union(boxes.iter().copied());
        Ok(Self {
            parts,
            instances,
            clusters,
            top: Cluster::new(&leaves, &boxes),
            bounds,
        })
    }

    /// The corners of a box around each part and instance.
    pub(super) fn outlines(&self, objects: &[Self]) -> Vec<[DVec3; 2]> {
        let parts = self.parts.iter().filter_map(|part| {
            let pieces = 0..part.pieces() as u32;
            union(pieces.filter_map(|piece| part.bounds(piece)))
        });
        let instances = self.instances.iter().filter_map(|instance| {
            let own = objects.get(instance.object)?.bounds?;
            Some(instance.placement.box_bounds(own))
        });
        parts.chain(instances).collect()
    }

    /// The nearest piece at 0 < t ≤ `t_max`; of several at the same t the first of the scene.
    pub(super) fn nearest(
        &self,
        objects: &[Self],
        origin: DVec3,
        direction: DVec3,
        t_max: f64,
    ) -> Option<Met> {
        let line = Line {
            objects,
            origin,
            direction,
            shear: Shear::new(direction),
        };
        let mut nearest = None;
        self.search(&self.top, &line, t_max, &mut nearest);
        nearest
    }

    /// Looks for what is nearer than `nearest`; returns the new bound.
    fn search(
        &self,
        cluster: &Cluster,
        line: &Line<'_>,
        t_max: f64,
        nearest: &mut Option<Met>,
    ) -> f64 {
        let mut bound = t_max;
        let (origin, direction) = (line.origin, line.direction);
        cluster.tree.walk(origin, direction, t_max, |range, _| {
            for leaf in cluster.leaves.get(range).unwrap_or_default() {
                let found = match leaf.part {
                    CLUSTER => {
                        if let Some(inner) = self.clusters.get(leaf.piece as usize) {
                            bound = self.search(inner, line, bound, nearest);
                        }
                        None
                    }
                    INSTANCE => self.through_instance(leaf.piece, line, bound),
                    part => self.parts.get(part as usize).and_then(|found| {
                        let (t, at) =
                            found.meet(leaf.piece, origin, direction, &line.shear, bound)?;
                        Some(Met {
                            t,
                            instance: None,
                            part,
                            piece: leaf.piece,
                            at,
                        })
                    }),
                };
                if let Some(found) = found
                    && nearest.is_none_or(|n| found.t < n.t || found.rank() < n.rank())
                {
                    bound = found.t;
                    *nearest = Some(found);
                }
            }
            bound
        });
        bound
    }

    fn through_instance(&self, index: u32, line: &Line<'_>, t_max: f64) -> Option<Met> {
        let instance = self.instances.get(index as usize)?;
        let object = line.objects.get(instance.object)?;
        let (origin, direction) = instance.placement.line(line.origin, line.direction);
        let found = object.nearest(&[], origin, direction, t_max)?;
        Some(Met {
            instance: Some(index),
            ..found
        })
    }

    /// Whether a piece that has a material lies at 0 < t < `t_max`.
    pub(super) fn occluded(
        &self,
        objects: &[Self],
        origin: DVec3,
        direction: DVec3,
        t_max: f64,
    ) -> bool {
        let line = Line {
            objects,
            origin,
            direction,
            shear: Shear::new(direction),
        };
        self.blocks(&self.top, &line, t_max)
    }

    fn blocks(&self, cluster: &Cluster, line: &Line<'_>, t_max: f64) -> bool {
        let (origin, direction) = (line.origin, line.direction);
        let block = |leaf: &Leaf| match leaf.part {
            CLUSTER => {
                let inner = self.clusters.get(leaf.piece as usize);
                inner.is_some_and(|inner| self.blocks(inner, line, t_max))
            }
            INSTANCE => self
                .instances
                .get(leaf.piece as usize)
                .and_then(|i| Some((i, line.objects.get(i.object)?)))
                .is_some_and(|(instance, object)| {
                    let (origin, direction) = instance.placement.line(origin, direction);
                    object.occluded(&[], origin, direction, t_max)
                }),
            part => self
                .parts
                .get(part as usize)
                .filter(|part| part.material.is_some())
                .and_then(|part| part.meet(leaf.piece, origin, direction, &line.shear, t_max))
                .is_some_and(|(t, _)| t < t_max),
        };
        let mut found = false;
        cluster.tree.walk(origin, direction, t_max, |range, t_max| {
            let leaves = cluster.leaves.get(range).unwrap_or_default();
            found = leaves.iter().any(block);
            if found { -1.0 } else { t_max }
        });
        found
    }

    /// The part that was met.
    pub(super) fn part<'a>(&'a self, objects: &'a [Self], met: &Met) -> Option<&'a Part> {
        let group = match met.instance {
            Some(i) => objects.get(self.instances.get(i as usize)?.object)?,
            None => self,
        };
        group.parts.get(met.part as usize)
    }

    /// The place that was met, in the world.
    pub(super) fn spot(
        &self,
        objects: &[Self],
        met: &Met,
        origin: DVec3,
        direction: DVec3,
    ) -> Option<Spot> {
        let part = self.part(objects, met)?;
        match met.instance {
            Some(i) => {
                let placement = &self.instances.get(i as usize)?.placement;
                let (origin, direction) = placement.line(origin, direction);
                let local = part.spot(met.piece, met.at, origin + direction * met.t)?;
                Some(placement.carry(&local))
            }
            None => part.spot(met.piece, met.at, origin + direction * met.t),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joined_boxes_hold_what_the_others_held() {
        let unit = |at: DVec3| [at, at + DVec3::ONE];
        let near = [DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 50.0];
        let three: Vec<_> = near.map(unit).into();
        assert_eq!(join(three.clone(), 3), three);
        let two = join(three, 2);
        assert_eq!(
            two,
            [[DVec3::ZERO, DVec3::new(3.0, 1.0, 1.0)], unit(near[2])]
        );
        let many: Vec<_> = (0..1000)
            .map(|i| {
                unit(DVec3::new(
                    f64::from(i * 7 % 13),
                    f64::from(i),
                    f64::from(i % 5),
                ))
            })
            .collect();
        let few = join(many.clone(), 6);
        assert_eq!(few.len(), 6);
        let holds = |inner: &[DVec3; 2]| {
            few.iter()
                .any(|outer| outer[0].cmple(inner[0]).all() && inner[1].cmple(outer[1]).all())
        };
        assert!(many.iter().all(holds));
        assert!(!holds(&unit(DVec3::new(0.0, 1001.0, 0.0))));
        assert!(join(Vec::new(), 6).is_empty());
    }
}
