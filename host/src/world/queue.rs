//! Surfaces that wait in a queue while packets track the media among them: which scenes have them, and the boxes that enclose them.

use glam::DVec3;

use super::{Feature, Medium, Needs};
use crate::surface::Surfaces;

/// A plane across an axis, in which all lies that one of the boxes around surfaces holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    /// 0, 1 or 2.
    pub(crate) axis: usize,
    /// Where \[length\].
    pub(crate) level: f64,
    /// Which box.
    pub(crate) number: u32,
}

/// The flat ones of boxes.
pub(super) fn planes(enclosures: &[[DVec3; 2]]) -> Vec<Plane> {
    let flat = |(number, [low, high]): (u32, &[DVec3; 2])| {
        let axis = (0..3).find(|&axis| low[axis] == high[axis])?;
        Some(Plane {
            axis,
            level: low[axis],
            number,
        })
    };
    (0..).zip(enclosures).filter_map(flat).collect()
}

/// Boxes that packets compare with each ray.
pub(super) const ENCLOSURES: usize = 6;

/// Whether surfaces can wait in a queue while packets track the media among them, or why not.
pub(super) fn queued(
    media: &[Medium],
    surfaces: &Surfaces,
    needs: &Needs,
) -> Result<(), &'static str> {
    if media.is_empty() {
        return Err("no medium to be seen");
    }
    if surfaces.emitters() > 0 {
        return Err("surfaces shine");
    }
    if needs.runs(Feature::Emission) {
        return Err("a medium shines");
    }
    if needs.needs_scalars_but_for_surfaces() {
        return Err("lights or media are more than packets render");
    }
    Ok(())
}
