//! What skipping gains, as measured.

use super::Feature;

/// Feature, scene of the bench, how many times longer pictures take with it, and how many times worse seconds times
/// relMSE become. Lines of `cargo bench -p woodcock-benches --bench skips`, and of the bench `shadows`.
const MEASURED: &[(Feature, &str, f64, f64)] = &[
    (Feature::Chromatic, "cloud", 1.19, 1.22),
    (Feature::SeveralMedia, "cloud", 1.27, 1.25),
    (Feature::Boundaries, "cloud", 3.16, 3.20),
    (Feature::EnvironmentNextEvent, "cloud", 1.13, 1.67),
    (Feature::Rayleigh, "cloud", 1.10, 1.10),
    (Feature::Surfaces, "cloud", 8.13, 15.97),
    (Feature::EquiAngular, "cloud", 8.08, 14.53),
    (Feature::FaintShadowRays, "cloud", 2.10, 2.04),
    (Feature::SingleEstimates, "cloud", 0.96, 1.15),
    (Feature::IndependentSamples, "cloud", 1.00, 1.11),
    (Feature::DenseGrid, "cloud", 1.14, 1.13),
    (Feature::Tracking, "fog", 0.95, 3.91),
    (Feature::DetailedSurfaces, "ground", 4.61, 12.59),
    (Feature::Chromatic, "fog", 0.93, 3.83),
    (Feature::SeveralMedia, "fog", 0.95, 3.90),
    (Feature::Boundaries, "fog", 2.42, 10.09),
    (Feature::EnvironmentNextEvent, "fog", 1.05, 18.49),
    (Feature::Rayleigh, "fog", 1.23, 1.22),
    (Feature::Surfaces, "fog", 6.96, 115.31),
    (Feature::EquiAngular, "fog", 7.04, 116.47),
    (Feature::FreePassage, "fog", 0.77, 3.19),
    (Feature::IndependentSamples, "fog", 0.96, 2.11),
    (Feature::SeveralMedia, "smoke", 1.13, 1.13),
    (Feature::Boundaries, "smoke", 2.78, 2.78),
    (Feature::EnvironmentNextEvent, "smoke", 1.60, 3.39),
    (Feature::Rayleigh, "smoke", 1.06, 1.06),
    (Feature::Surfaces, "smoke", 3.36, 19.89),
    (Feature::EquiAngular, "smoke", 3.35, 20.46),
    (Feature::SharedPaths, "smoke", 0.55, 3.26),
    (Feature::IndependentSamples, "smoke", 0.98, 1.28),
    (Feature::Chromatic, "absorption", 2.19, 2.18),
    (Feature::Boundaries, "absorption", 1.74, 1.73),
    (Feature::Surfaces, "absorption", 1.46, 2136.20),
    (Feature::EquiAngular, "absorption", 1.45, 2154.89),
    (Feature::Scattering, "absorption", 0.49, 702.22),
    (Feature::IndependentSamples, "absorption", 0.98, 2.49),
    (Feature::FlownEmission, "fire", 0.39, 7.58),
];

/// What keeping a feature costs on the scene of the bench where it costs most, if it was measured to cost anything:
/// the scene, and how many times worse seconds times relMSE become.
pub(super) fn cost(feature: Feature) -> Option<(&'static str, f64)> {
    let rows = MEASURED.iter().filter(|row| row.0 == feature);
    let worst = rows.max_by(|a, b| a.3.total_cmp(&b.3))?;
    (worst.3 >= NOTICEABLE).then_some((worst.1, worst.3))
}

/// What the bench tells from noise.
const NOTICEABLE: f64 = 1.05;
