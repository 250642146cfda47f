//! How long paths will be, known before the first one begins.
//!
//! Nothing cuts a path off but absorption, the way out, and `--max-depth`: any other cap would be a bias. Where
//! none of these comes soon a render would seem to hang; so the mean number of collisions is bounded beforehand, and
//! a scene beyond [`LIMIT`] is refused.

use woodcock_core::majorant::majorant_count_of;
use woodcock_core::path::RecordKind;

use super::{Medium, Tables};

/// Collisions of a path on average that a render begins with: at ten nanoseconds each, ten paths a second.
pub const LIMIT: f64 = 1e7;

/// About how often a path that enters a medium collides there on average.
///
/// * `extent`: the diameter of what bounds it \[length\], infinite where nothing does.
/// * `from_within`: the camera may be inside.
///
/// Light that enters a body from all sides flies 4V/S in it on average, however it scatters ([Blanco, Fournier
/// 2003]), which is at most the diameter; so it collides at most as often as the optical depth D across. From within,
/// diffusion takes about D²/8 to the surface. Neither goes on longer than absorption lets live.
pub(super) fn collisions(medium: &Medium, tables: &Tables, extent: f64, from_within: bool) -> f64 {
    let record = &medium.record;
    let extent = medium.support.as_ref().map_or(extent, |support| {
        let [near, .., far] = support.corners();
        extent.min((far - near).length())
    });
    let across = thickest(medium, tables) * extent;
    let seen = (0..3).filter(|&c| record.colour[c] > 0.0);
    let albedo = seen
        .map(|c| f64::from(record.albedo[c]))
        .fold(0.0, f64::max);
    let scattered = if from_within {
        across.max(across * across / 8.0)
    } else {
        across
    };
    scattered.min(1.0 / (1.0 - albedo))
}

/// The largest extinction of a medium, by its bounds [1/length].
pub(super) fn thickest(medium: &Medium, tables: &Tables) -> f64 {
    let record = &medium.record;
    let largest = match record.kind {
        RecordKind::Homogeneous => 1.0,
        RecordKind::Grid {
            dims,
            majorants,
            edge,
            ..
        } => {
            let first = majorants as usize;
            let bounds = first..first + majorant_count_of(dims, edge).unwrap_or(0);
            let bounds = tables.majorants.get(bounds).unwrap_or_default();
            f64::from(bounds.iter().fold(0.0_f32, |a, b| a.max(*b)))
        }
    };
    f64::from(record.scale) * largest
}
