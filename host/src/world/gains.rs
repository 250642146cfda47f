//! What skipping gains, as measured.

use super::Feature;

/// Feature, scene of the bench, how many times longer pictures take with it, and how many times worse seconds times
/// relMSE become. Lines of `cargo bench -p woodcock-benches --bench skips`.
const MEASURED: &[(Feature, &str, f64, f64)] = &[];

/// What keeping a feature costs on the scene of the bench where it costs most, if it was measured to cost anything:
/// the scene, and how many times worse seconds times relMSE become.
pub(super) fn cost(feature: Feature) -> Option<(&'static str, f64)> {
    let rows = MEASURED.iter().filter(|row| row.0 == feature);
    let worst = rows.max_by(|a, b| a.3.total_cmp(&b.3))?;
    (worst.3 >= NOTICEABLE).then_some((worst.1, worst.3))
}

/// What the bench tells from noise.
const NOTICEABLE: f64 = 1.05;
