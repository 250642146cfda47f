//! Where media lie: the simplest description that a scene's boundaries come to.

use glam::{DAffine3, DVec3};
use woodcock_core::path::Convex;

use super::boundaries::{self, Facing};
use super::shape::{self, Region};
use super::{Assembled, Boundaries, Feature, Location, Needs, Sides};
use crate::scene::{Boundary, Enclosure, Scene, SceneError, Warning};

/// Finds the simplest description of where media lie.
pub(super) fn locate(
    scene: &Scene,
    assembled: &Assembled,
    origin: DVec3,
    keep: &[Feature],
    needs: &mut Needs,
    warnings: &mut Vec<Warning>,
) -> Location {
    let boundaries: Vec<_> = scene
        .boundaries
        .iter()
        .map(|b| {
            let sides = Sides {
                inside: assembled.of(b.inside),
                outside: assembled.of(b.outside),
            };
            (b, sides)
        })
        .filter(|(_, sides)| sides.inside != sides.outside)
        .map(|(b, sides)| match boundaries::facing(&b.shape) {
            Facing::Outwards => (b, sides),
            Facing::Inwards => (b, sides.swapped()),
            Facing::Open => {
                let message =
                    "this surface is not closed: where a ray crosses it once, no medium is found";
                warnings.push(SceneError::at(&b.place, message).into_warning());
                (b, sides)
            }
        })
        .collect();
    let exterior = exterior(scene, assembled, &boundaries);
    if let Some(id) = scene.camera_medium
        && let Some(index) = assembled.of(Some(id))
        && exterior != Some(index)
        && boundaries
            .iter()
            .all(|(_, sides)| sides.inside != Some(index))
        && let Some(medium) = scene.medium(id)
    {
        warnings.push(
            SceneError::at(&medium.place, "the camera's medium reaches nowhere").into_warning(),
        );
    }
    let several = needs.decide(
        Feature::SeveralMedia,
        assembled.media.len() > 1,
        keep,
        match assembled.media.len() {
            0 => "no medium".to_owned(),
            1 => "one medium: its parameters are constants".to_owned(),
            n => format!("{n} media"),
        },
    );
    let convex = convex(assembled, &boundaries, exterior, origin);
    let reason = match &convex {
        None if assembled.media.is_empty() => "no medium",
        None => "surfaces that are no box or sphere, or several",
        Some(Convex::Everywhere) => "the medium fills space",
        Some(Convex::Box { .. }) => "a box: an interval in closed form",
        Some(Convex::Sphere { .. }) => "a sphere: an interval in closed form",
    };
    if assembled.media.is_empty() || (boundaries.is_empty() && exterior.is_none()) {
        needs.decide(Feature::Boundaries, false, &[], "no medium in reach");
        return Location::Nowhere;
    }
    let search = needs.decide(Feature::Boundaries, convex.is_none(), keep, reason);
    match convex {
        // A kernel of several media still takes a convex place: its medium is number zero.
        Some(convex) if !search => Location::Convex(convex),
        _ => {
            let overlaps = overlaps(assembled, &boundaries, exterior, origin);
            let supports = assembled.media.iter().map(|m| m.support).collect();
            let overlapping = overlaps && several;
            Location::Boundaries(Boundaries::new(
                &boundaries,
                exterior,
                supports,
                origin,
                overlapping,
            ))
        }
    }
}

/// The medium outside of all boundaries: the one that boundaries name as their outside but none as its
/// inside, else that of the camera, unless a boundary encloses it.
fn exterior(
    scene: &Scene,
    assembled: &Assembled,
    boundaries: &[(&Boundary, Sides)],
) -> Option<usize> {
    let enclosed = |medium: usize| {
        boundaries
            .iter()
            .any(|(_, sides)| sides.inside == Some(medium))
    };
    boundaries
        .iter()
        .filter_map(|(_, sides)| sides.outside)
        .chain(assembled.of(scene.camera_medium))
        .find(|medium| !enclosed(*medium))
}

/// One medium in one convex shape, if that is what the scene comes to.
fn convex(
    assembled: &Assembled,
    boundaries: &[(&Boundary, Sides)],
    exterior: Option<usize>,
    origin: DVec3,
) -> Option<Convex> {
    let [medium] = assembled.media.as_slice() else {
        return None;
    };
    match (boundaries, exterior) {
        ([], Some(_)) => Some(match &medium.support {
            Some(support) => shape::convex_box(support),
            None => Convex::Everywhere,
        }),
        (
            [
                (
                    boundary,
                    Sides {
                        inside: Some(_),
                        outside: None,
                    },
                ),
            ],
            None,
        ) => {
            let region = Region::of(boundary, origin)?;
            match &medium.support {
                None => Some(region.convex()),
                Some(support) => region
                    .contains(&support.corners())
                    .then(|| shape::convex_box(support)),
            }
        }
        _ => None,
    }
}

/// Whether media of different boundaries may share space. Judged by boxes: it may be wrong on the safe side.
fn overlaps(
    assembled: &Assembled,
    boundaries: &[(&Boundary, Sides)],
    exterior: Option<usize>,
    origin: DVec3,
) -> bool {
    if assembled.media.len() < 2 {
        return false;
    }
    let boxed = |boundary: &Boundary| -> (DVec3, DVec3) {
        let points: Vec<DVec3> = match &boundary.shape {
            Enclosure::Sphere(sphere) => {
                let m = DAffine3::from_translation(-origin) * sphere.object_to_world;
                let corner = |i: usize| {
                    let sign = |bit: usize| {
                        if i >> bit & 1 == 1 {
                            sphere.radius
                        } else {
                            -sphere.radius
                        }
                    };
                    m.transform_point3(DVec3::new(sign(0), sign(1), sign(2)))
                };
                (0..8).map(corner).collect()
            }
            Enclosure::TriangleMesh(mesh) => mesh.positions.iter().map(|p| *p - origin).collect(),
        };
        let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        (low, high)
    };
    for (i, (a, sides_a)) in boundaries.iter().enumerate() {
        if exterior.is_some() && sides_a.outside != exterior && sides_a.inside != exterior {
            let nested = boundaries
                .iter()
                .any(|(_, s)| s.inside == sides_a.outside && s.inside.is_some());
            if !nested {
                return true;
            }
        }
        for (b, sides_b) in &boundaries[i + 1..] {
            if sides_a.inside == sides_b.inside {
                continue;
            }
            let declared = sides_a.outside.is_some() && sides_a.outside == sides_b.inside
                || sides_b.outside.is_some() && sides_b.outside == sides_a.inside;
            let ((low_a, high_a), (low_b, high_b)) = (boxed(a), boxed(b));
            let apart = high_a.cmplt(low_b).any() || high_b.cmplt(low_a).any();
            if !declared && !apart {
                return true;
            }
        }
    }
    false
}
