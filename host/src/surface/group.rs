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
    /// Which part; [`INSTANCE`] for an instance.
    part: u32,
    /// Which piece of the part, or which instance.
    piece: u32,
}

const INSTANCE: u32 = u32::MAX;

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

/// Parts, perhaps instances, and a tree over all their pieces.
#[derive(Debug, Default)]
pub(super) struct Group {
    pub(super) parts: Vec<Part>,
    pub(super) instances: Vec<Instance>,
    leaves: Vec<Leaf>,
    tree: Tree,
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
        let mut leaves = Vec::with_capacity(count);
        let mut boxes = Vec::with_capacity(count);
        for (part, found) in (0..).zip(&parts) {
            for piece in 0..found.pieces() as u32 {
                if let Some(bounds) = found.bounds(piece) {
                    leaves.push(Leaf { part, piece });
                    boxes.push(bounds);
                }
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
        let (tree, order) = Tree::new(&boxes);
        let leaves = order
            .iter()
            .filter_map(|&i| leaves.get(i as usize).copied())
            .collect();
        Ok(Self {
            parts,
            instances,
            leaves,
            tree,
            bounds,
        })
    }

    /// The nearest piece at 0 < t ≤ `t_max`; of several at the same t the first of the scene.
    pub(super) fn nearest(
        &self,
        objects: &[Self],
        origin: DVec3,
        direction: DVec3,
        t_max: f64,
    ) -> Option<Met> {
        let shear = Shear::new(direction);
        let mut nearest: Option<Met> = None;
        self.tree
            .walk(origin, direction, t_max, |range, mut t_max| {
                for leaf in self.leaves.get(range).unwrap_or_default() {
                    let found = if leaf.part == INSTANCE {
                        self.through_instance(objects, leaf.piece, origin, direction, t_max)
                    } else {
                        self.parts.get(leaf.part as usize).and_then(|part| {
                            let (t, at) =
                                part.meet(leaf.piece, origin, direction, &shear, t_max)?;
                            Some(Met {
                                t,
                                instance: None,
                                part: leaf.part,
                                piece: leaf.piece,
                                at,
                            })
                        })
                    };
                    if let Some(found) = found
                        && nearest.is_none_or(|n| found.t < n.t || found.rank() < n.rank())
                    {
                        t_max = found.t;
                        nearest = Some(found);
                    }
                }
                t_max
            });
        nearest
    }

    fn through_instance(
        &self,
        objects: &[Self],
        index: u32,
        origin: DVec3,
        direction: DVec3,
        t_max: f64,
    ) -> Option<Met> {
        let instance = self.instances.get(index as usize)?;
        let object = objects.get(instance.object)?;
        let (origin, direction) = instance.placement.line(origin, direction);
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
        let shear = Shear::new(direction);
        let mut found = false;
        self.tree.walk(origin, direction, t_max, |range, t_max| {
            for leaf in self.leaves.get(range).unwrap_or_default() {
                found = if leaf.part == INSTANCE {
                    self.instances
                        .get(leaf.piece as usize)
                        .and_then(|i| Some((i, objects.get(i.object)?)))
                        .is_some_and(|(instance, object)| {
                            let (origin, direction) = instance.placement.line(origin, direction);
                            object.occluded(&[], origin, direction, t_max)
                        })
                } else {
                    self.parts
                        .get(leaf.part as usize)
                        .filter(|part| part.material.is_some())
                        .and_then(|part| part.meet(leaf.piece, origin, direction, &shear, t_max))
                        .is_some_and(|(t, _)| t < t_max)
                };
                if found {
                    return -1.0;
                }
            }
            t_max
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
