//! What a scene needs, and what is therefore skipped.
//!
//! The table decides which kernel runs; `woodcock explain` prints it. `--keep NAME` keeps a skipped feature,
//! to measure what skipping gains and to prove that it changes nothing: the same bits where the note says so,
//! the same mean otherwise.

use std::fmt;

use super::gains;

/// A piece of work that not every scene needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// Majorants, tentative collisions and look-ups.
    Tracking,
    /// A weight per colour in flights and shadow rays.
    Chromatic,
    /// Parameters of each lane's own medium.
    SeveralMedia,
    /// Search among boundary surfaces.
    Boundaries,
    /// Shadow rays to lights.
    NextEvent,
    /// Shadow rays to the environment.
    EnvironmentNextEvent,
    /// Rayleigh's phase function.
    Rayleigh,
    /// A lens.
    Lens,
    /// Surfaces with matter or light, and the scalar path tracer that meets them.
    Surfaces,
    /// Surfaces and lamps of any kind and number, in double precision: what is no [room](woodcock_core::room).
    DetailedSurfaces,
    /// Hits on surfaces that wait in a queue, while packets track the media among them.
    SurfaceQueue,
    /// Lights at places, and pictures of the sky.
    LocalLights,
    /// Light from within media.
    Emission,
    /// Media that change colour from place to place, scatter by other laws than two, or shine where there are several.
    DetailedMedia,
    /// Distances sampled by how near a light is.
    EquiAngular,
    /// Directions after a collision, and all that comes of them.
    Scattering,
    /// Flights that pass a medium by chance.
    FreePassage,
    /// Light from within media found by the flights of camera rays, where combs of points would find it.
    FlownEmission,
    /// Shadow rays however little they would bring.
    FaintShadowRays,
    /// One estimate of what passes along a shadow ray, however much it would bring.
    SingleEstimates,
    /// Paths that carry all colours.
    SharedPaths,
    /// First choices drawn apart from those of other samples.
    IndependentSamples,
    /// A grid's samples in bricks, where they are, with a byte for each that settles most decisions.
    Bricks,
    /// A grid's samples in one table, however large.
    DenseGrid,
}

impl Feature {
    /// All of them, in the order of the table.
    pub const ALL: [Self; 24] = [
        Self::Tracking,
        Self::Chromatic,
        Self::SeveralMedia,
        Self::Boundaries,
        Self::NextEvent,
        Self::EnvironmentNextEvent,
        Self::Rayleigh,
        Self::Lens,
        Self::Surfaces,
        Self::DetailedSurfaces,
        Self::SurfaceQueue,
        Self::LocalLights,
        Self::Emission,
        Self::DetailedMedia,
        Self::EquiAngular,
        Self::Scattering,
        Self::FreePassage,
        Self::FlownEmission,
        Self::FaintShadowRays,
        Self::SingleEstimates,
        Self::SharedPaths,
        Self::IndependentSamples,
        Self::Bricks,
        Self::DenseGrid,
    ];

    /// Its name on the command line and in statistics.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Tracking => "tracking",
            Self::Chromatic => "chromatic",
            Self::SeveralMedia => "several-media",
            Self::Boundaries => "boundaries",
            Self::NextEvent => "next-event",
            Self::EnvironmentNextEvent => "environment-next-event",
            Self::Rayleigh => "rayleigh",
            Self::Lens => "lens",
            Self::Surfaces => "surfaces",
            Self::DetailedSurfaces => "detailed-surfaces",
            Self::SurfaceQueue => "surface-queue",
            Self::LocalLights => "local-lights",
            Self::Emission => "emission",
            Self::DetailedMedia => "detailed-media",
            Self::EquiAngular => "equi-angular",
            Self::Bricks => "bricks",
            Self::DenseGrid => "dense-grid",
            Self::Scattering => "scattering",
            Self::FreePassage => "free-passage",
            Self::FlownEmission => "flown-emission",
            Self::FaintShadowRays => "faint-shadow-rays",
            Self::SingleEstimates => "single-estimates",
            Self::SharedPaths => "shared-paths",
            Self::IndependentSamples => "independent-samples",
        }
    }

    /// Whether `--keep` can keep it where a scene does not need it.
    pub const fn can_be_kept(self) -> bool {
        !matches!(
            self,
            Self::NextEvent
                | Self::Lens
                | Self::SurfaceQueue
                | Self::LocalLights
                | Self::Emission
                | Self::DetailedMedia
        )
    }

    /// The feature of a name that `--keep` takes.
    pub fn kept(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|f| f.can_be_kept() && f.name() == name)
    }
}

/// What became of a feature.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Decision {
    /// The scene needs it.
    Needed,
    /// The scene does not, and it costs nothing.
    Skipped,
    /// The scene does not, but `--keep` asked for it.
    Kept,
}

/// A row of the table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Need {
    /// Which work.
    pub feature: Feature,
    /// What became of it.
    pub decision: Decision,
    /// Why.
    pub reason: String,
}

/// What a scene needs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Needs(pub Vec<Need>);

impl Needs {
    /// Enters a feature, and says whether its code runs.
    pub(super) fn decide(
        &mut self,
        feature: Feature,
        needed: bool,
        keep: &[Feature],
        reason: impl Into<String>,
    ) -> bool {
        let decision = match (needed, keep.contains(&feature)) {
            (true, _) => Decision::Needed,
            (false, true) => Decision::Kept,
            (false, false) => Decision::Skipped,
        };
        let runs = decision != Decision::Skipped;
        self.0.push(Need {
            feature,
            decision,
            reason: reason.into(),
        });
        runs
    }

    /// Whether all that runs can run in packets.
    pub(super) fn in_packets(&self) -> bool {
        let queued = self.runs(Feature::SurfaceQueue) || !self.runs(Feature::Surfaces);
        queued && !self.needs_scalars_but_for_surfaces()
    }

    /// Whether something other than surfaces that runs can run in scalar code only.
    pub(super) fn needs_scalars_but_for_surfaces(&self) -> bool {
        let scalar = [
            Feature::LocalLights,
            Feature::DetailedMedia,
            Feature::EquiAngular,
        ];
        scalar.into_iter().any(|feature| self.runs(feature))
    }

    /// Whether packets trace a path for each colour, grey.
    pub(crate) fn colours_apart(&self) -> bool {
        self.in_packets() && self.runs(Feature::Chromatic) && !self.runs(Feature::SharedPaths)
    }

    /// Whether the code of a feature runs.
    pub fn runs(&self, feature: Feature) -> bool {
        self.0
            .iter()
            .any(|n| n.feature == feature && n.decision != Decision::Skipped)
    }

    /// The names of the features whose code runs.
    pub fn running(&self) -> Vec<String> {
        self.names(|d| *d != Decision::Skipped)
    }

    /// The names of the features that are skipped.
    pub fn skipped(&self) -> Vec<String> {
        self.names(|d| *d == Decision::Skipped)
    }

    fn names(&self, wanted: impl Fn(&Decision) -> bool) -> Vec<String> {
        let named = self.0.iter().filter(|n| wanted(&n.decision));
        named.map(|n| n.feature.name().to_owned()).collect()
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:<24}{:<10}why", "feature", "decision")?;
        for need in &self.0 {
            let decision = match need.decision {
                Decision::Needed => "needed",
                Decision::Skipped => "skipped",
                Decision::Kept => "kept",
            };
            let name = need.feature.name();
            write!(f, "{name:<24}{decision:<10}{}", need.reason)?;
            let skipped = need.decision == Decision::Skipped;
            if let Some((scene, cost)) = gains::cost(need.feature).filter(|_| skipped) {
                write!(f, " (measured: gains {cost:.2}x on `{scene}`)")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
