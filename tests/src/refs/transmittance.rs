//! Twelve analytic densities with four rays each: optical depth and what follows from it.
//!
//! [`crate::fixtures`] turns them into media. Uncertainty of the numbers: 10⁻¹³ absolute.

use serde::Deserialize;

/// A density by formula, as a function of position [1/length].
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "field", content = "params", rename_all = "snake_case")]
pub enum Field {
    /// s0 + k · x.
    Linear {
        /// Extinction at the origin [1/length].
        s0: f64,
        /// Its gradient [1/length²].
        k: [f64; 3],
    },
    /// s0 · e^(−z/H).
    ExponentialZ {
        /// Extinction at z = 0 [1/length].
        s0: f64,
        /// Scale height \[length\].
        #[serde(rename = "H")]
        height: f64,
    },
    /// s0 · e^(−(|x| − Rp)/H): an atmosphere around a ball at the origin.
    Planet {
        /// Extinction at the ground [1/length].
        s0: f64,
        /// Scale height \[length\].
        #[serde(rename = "H")]
        height: f64,
        /// Radius of the ground \[length\].
        #[serde(rename = "Rp")]
        ground: f64,
    },
    /// A · e^(−|x − c|²/2s²).
    Gaussian {
        /// Peak extinction [1/length].
        #[serde(rename = "A")]
        peak: f64,
        /// Centre.
        c: [f64; 3],
        /// Standard deviation \[length\].
        s: f64,
    },
    /// A sum of Gaussians.
    ThreeGaussians {
        /// Peak [1/length], centre, standard deviation \[length\] of each.
        blobs: Vec<(f64, [f64; 3], f64)>,
    },
    /// A · (1 + B sin(k · x + φ)).
    PlaneWave {
        /// Mean extinction [1/length].
        #[serde(rename = "A")]
        mean: f64,
        /// Relative amplitude, at most 1.
        #[serde(rename = "B")]
        amplitude: f64,
        /// Wave vector [1/length].
        k: [f64; 3],
        /// Phase at the origin.
        phi: f64,
    },
    /// A · (1 + B sin(kx + p₁) sin(ky + p₂) sin(kz + p₃)).
    SineProduct {
        /// Mean extinction [1/length].
        #[serde(rename = "A")]
        mean: f64,
        /// Relative amplitude, at most 1.
        #[serde(rename = "B")]
        amplitude: f64,
        /// Wave number [1/length].
        k: f64,
        /// Phase per axis.
        p: [f64; 3],
    },
    /// A where ⌊x/h⌋ + ⌊y/h⌋ + ⌊z/h⌋ is even, else B.
    Checkerboard {
        /// Extinction of even cells [1/length].
        #[serde(rename = "A")]
        even: f64,
        /// Extinction of odd cells [1/length].
        #[serde(rename = "B")]
        odd: f64,
        /// Edge of a cell \[length\].
        h: f64,
    },
    /// Trilinear between values that sit at whole coordinates, on [0, 4]³.
    TrilinearGrid {
        /// Factor of the dimensionless grid [1/length].
        scale: f64,
        /// Values at (i, j, k), filled in from the file's one grid.
        #[serde(skip)]
        grid: Grid,
    },
    /// Constant in unit cells, on [0, 5]³.
    NearestGrid {
        /// Factor of the dimensionless grid [1/length].
        scale: f64,
        /// Values of the cells [i, i+1) × [j, j+1) × [k, k+1), filled in from the file's one grid.
        #[serde(skip)]
        grid: Grid,
    },
    /// A · max(0, 1 − |x − c|/R).
    Cone {
        /// Peak extinction [1/length].
        #[serde(rename = "A")]
        peak: f64,
        /// Centre.
        c: [f64; 3],
        /// Radius beyond which there is nothing \[length\].
        #[serde(rename = "R")]
        radius: f64,
    },
    /// A where r₁ < |x − c| < r₂, else 0.
    ThinShell {
        /// Extinction within the shell [1/length].
        #[serde(rename = "A")]
        inside: f64,
        /// Centre.
        c: [f64; 3],
        /// Inner radius \[length\].
        r1: f64,
        /// Outer radius \[length\].
        r2: f64,
    },
}

/// Dimensionless values at (i, j, k), x first.
pub type Grid = [[[f64; 5]; 5]; 5];

/// A ray through a field and what is known along it.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f64; 3],
    /// Unit direction.
    pub dir: [f64; 3],
    /// How far it goes \[length\].
    #[serde(rename = "L")]
    pub t_max: f64,
    /// τ, the optical depth of [0, t_max].
    #[serde(rename = "tau")]
    pub optical_depth: f64,
    /// T = e^−τ.
    #[serde(rename = "T")]
    pub transmittance: f64,
    /// Optical depth of the first quarter, half and three quarters of the length.
    #[serde(rename = "tau_quarters")]
    pub quarter_depths: [f64; 3],
    /// ∫ e^−τ(t) dt = E min(flight, t_max) \[length\].
    pub mean_free_flight: f64,
    /// ∫ σ_t(t) e^−τ(t) (1 + x(t)) dt: radiance where the source function is 1 + the first coordinate.
    pub emission: f64,
    /// ∫ σ_t² dt [1/length].
    #[serde(rename = "tau2")]
    pub squared_integral: f64,
}

/// A field, where it is bounded, and its rays.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Case {
    /// The density.
    #[serde(flatten)]
    pub field: Field,
    /// Lower and upper corner of the box that the majorant covers; everywhere if there is none.
    #[serde(rename = "box")]
    pub bounds: Option<[[f64; 3]; 2]>,
    /// σ̄, an upper bound of the extinction over the box [1/length].
    pub majorant: f64,
    /// Rays inside the box.
    pub rays: Vec<Ray>,
}

/// Reads the table.
///
/// # Panics
/// When the file does not match these types.
pub fn load() -> Vec<Case> {
    #[derive(Deserialize)]
    struct File {
        grid: Grid,
        cases: Vec<Case>,
    }
    let mut file: File = super::parse(
        "transmittance",
        include_str!("../../refs/transmittance.json"),
    );
    for case in &mut file.cases {
        if let Field::TrilinearGrid { grid, .. } | Field::NearestGrid { grid, .. } = &mut case.field
        {
            *grid = file.grid;
        }
    }
    file.cases
}
