//! Where the samples of a scene's only grid are kept, and what is known of its blocks.

use woodcock_core::path::RecordKind;

use super::medium::{BRICKS_FROM, Medium, Tables};
use super::needs::{Feature, Needs};

/// Decides between one table and bricks, and brings the samples there; computes controls.
///
/// Bricks serve the kernels for one grid. Whatever scalar code keeps beside samples counts them in one table.
pub(super) fn store(media: &[Medium], tables: &mut Tables, keep: &[Feature], needs: &mut Needs) {
    let alone = match media {
        [medium] if medium.has_samples() && medium.is_plain() => {
            (!needs.runs(Feature::SeveralMedia)).then_some(medium)
        }
        _ => None,
    };
    let samples = tables.box_samples();
    let large = alone.is_some() && samples >= BRICKS_FROM as u64;
    let keep_dense = keep.contains(&Feature::DenseGrid);
    let reason = match (alone, large) {
        (None, _) => "not one plain grid".to_owned(),
        (_, true) => format!("{samples} samples: more than near caches hold"),
        (_, false) => format!("{samples} samples: one table is faster"),
    };
    let bricks_kept = keep.contains(&Feature::Bricks) && alone.is_some() && !keep_dense;
    let kept: &[Feature] = if bricks_kept { keep } else { &[] };
    let bricks = needs.decide(Feature::Bricks, large && !keep_dense, kept, reason);
    let any = media.iter().any(Medium::has_samples);
    let reason = match (any, bricks) {
        (false, _) => "no grid",
        (true, true) => "the samples are in bricks",
        (true, false) => "grids are small, several, or more than densities",
    };
    needs.decide(Feature::DenseGrid, any && !bricks && !large, keep, reason);
    if let Some(medium) = alone {
        tables.fill_controls(&medium.record);
        if bricks && matches!(medium.record.kind, RecordKind::Grid { .. }) {
            tables.into_bricks(&medium.record);
        }
    }
}
