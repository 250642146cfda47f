//! Named spectra of matter: the refractive indices of glasses, and the complex ones of metals.
//!
//! Copper, silver, gold: [Johnson, Christy 1972], by photon energy. Aluminium: [Palik 1985], by wavelength.
//! Glasses: the d line (587.6 nm) of the maker's catalogue [Schott], for nothing here disperses.

use super::super::SceneError;
use super::super::color::{Piecewise, coefficient};
use super::diagnostics::Diagnostics;
use super::param::{Param, Text, Type, Values};
use super::params::Params;
use super::suggest::nearest;

/// h c in eV nm: wavelength = this / energy.
const ENERGY: f64 = 1_239.841_984;

/// Which part of a complex refractive index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Optical {
    /// The real part.
    Eta,
    /// The extinction coefficient.
    K,
}

/// A metal's complex refractive index: rows of the abscissa, η and k.
#[derive(Clone, Copy, Debug)]
pub(super) struct Metal {
    /// The abscissa is a photon energy \[eV\], rising, and not a wavelength \[nm\].
    by_energy: bool,
    rows: &'static [[f64; 3]],
}

/// pbrt's default conductor.
#[rustfmt::skip]
pub(super) const COPPER: Metal = Metal { by_energy: true, rows: &[
    [1.51, 0.26, 5.180], [1.64, 0.24, 4.665], [1.76, 0.21, 4.205], [1.88, 0.22, 3.747],
    [2.01, 0.30, 3.205], [2.13, 0.70, 2.704], [2.26, 1.02, 2.577], [2.38, 1.18, 2.608],
    [2.50, 1.22, 2.564], [2.63, 1.25, 2.483], [2.75, 1.24, 2.397], [2.88, 1.25, 2.305],
    [3.00, 1.28, 2.207], [3.12, 1.32, 2.116], [3.25, 1.33, 2.045], [3.37, 1.36, 1.975],
] };

#[rustfmt::skip]
const SILVER: Metal = Metal { by_energy: true, rows: &[
    [1.51, 0.04, 5.727], [1.64, 0.03, 5.242], [1.76, 0.04, 4.838], [1.88, 0.05, 4.483],
    [2.01, 0.06, 4.152], [2.13, 0.05, 3.858], [2.26, 0.06, 3.586], [2.38, 0.05, 3.324],
    [2.50, 0.05, 3.093], [2.63, 0.05, 2.869], [2.75, 0.04, 2.657], [2.88, 0.04, 2.462],
    [3.00, 0.05, 2.275], [3.12, 0.05, 2.070], [3.25, 0.05, 1.864], [3.37, 0.07, 1.657],
] };

#[rustfmt::skip]
const GOLD: Metal = Metal { by_energy: true, rows: &[
    [1.51, 0.16, 5.083], [1.64, 0.14, 4.542], [1.76, 0.13, 4.103], [1.88, 0.14, 3.697],
    [2.01, 0.21, 3.272], [2.13, 0.29, 2.863], [2.26, 0.43, 2.455], [2.38, 0.62, 2.081],
    [2.50, 1.04, 1.833], [2.63, 1.31, 1.849], [2.75, 1.38, 1.914], [2.88, 1.45, 1.948],
    [3.00, 1.46, 1.958], [3.12, 1.47, 1.952], [3.25, 1.46, 1.933], [3.37, 1.48, 1.895],
] };

#[rustfmt::skip]
const ALUMINIUM: Metal = Metal { by_energy: false, rows: &[
    [350.0, 0.375, 4.24], [400.0, 0.490, 4.86], [450.0, 0.618, 5.47], [500.0, 0.769, 6.08],
    [550.0, 0.958, 6.69], [600.0, 1.20, 7.26], [650.0, 1.47, 7.79], [700.0, 1.83, 8.31],
    [750.0, 2.40, 8.62], [800.0, 2.80, 8.45],
] };

const METALS: [(&str, Metal, Optical); 8] = [
    ("metal-Ag-eta", SILVER, Optical::Eta),
    ("metal-Ag-k", SILVER, Optical::K),
    ("metal-Al-eta", ALUMINIUM, Optical::Eta),
    ("metal-Al-k", ALUMINIUM, Optical::K),
    ("metal-Au-eta", GOLD, Optical::Eta),
    ("metal-Au-k", GOLD, Optical::K),
    ("metal-Cu-eta", COPPER, Optical::Eta),
    ("metal-Cu-k", COPPER, Optical::K),
];

/// pbrt's F glasses are Schott's SF.
const GLASSES: [(&str, f64); 7] = [
    ("glass-BAF10", 1.6700),
    ("glass-BK7", 1.5168),
    ("glass-F10", 1.7283),
    ("glass-F11", 1.7847),
    ("glass-F5", 1.6727),
    ("glass-FK51A", 1.4866),
    ("glass-LASF9", 1.8503),
];

impl Metal {
    /// The mean over each channel's response.
    pub(super) fn project(self, which: Optical) -> [f64; 3] {
        let pair = |&[at, eta, k]: &[f64; 3]| {
            let wavelength = if self.by_energy { ENERGY / at } else { at };
            (wavelength, if which == Optical::Eta { eta } else { k })
        };
        let mut pairs: Vec<(f64, f64)> = self.rows.iter().map(pair).collect();
        if self.by_energy {
            pairs.reverse();
        }
        // The responses of saturated channels are negative in places.
        coefficient(&Piecewise(&pairs)).map(|c| c.max(0.0))
    }
}

/// A part of a metal's index, given by name, by colour or by pairs; copper's by default.
pub(super) fn metal(
    params: &Params,
    name: &'static str,
    which: Optical,
    diagnostics: &mut Diagnostics,
) -> Result<[f64; 3], SceneError> {
    let Some(param) = params.find(name, &[Type::Rgb, Type::Spectrum])? else {
        return Ok(COPPER.project(which));
    };
    let Some(text) = spectrum_name(param) else {
        let given = params.coefficient(name, diagnostics)?;
        return Ok(given.unwrap_or_else(|| COPPER.project(which)));
    };
    if let Some((_, metal, which)) = METALS.iter().find(|(known, ..)| *known == text.text) {
        return Ok(metal.project(*which));
    }
    let names = METALS.map(|(name, ..)| name);
    diagnostics.refuse(unsupported(text, &names))?;
    Ok(COPPER.project(which))
}

/// A glass's index, given by name or by a constant spectrum.
pub(super) fn glass(param: &Param, diagnostics: &mut Diagnostics) -> Result<f64, SceneError> {
    let Some(text) = spectrum_name(param) else {
        let pairs = super::color::pairs(param)?;
        if let Some(value) = Piecewise(&pairs).constant() {
            return Ok(value);
        }
        let message =
            "this refractive index changes with the wavelength, which is not yet supported";
        diagnostics.refuse(
            SceneError::at(&param.valued, message)
                .help("give one \"float eta\", or the name of a glass"),
        )?;
        return Ok(1.5);
    };
    if let Some((_, eta)) = GLASSES.iter().find(|(known, _)| *known == text.text) {
        let message = format!("{} has its index {eta} of 587.6 nm everywhere", text.text);
        diagnostics.warn(
            SceneError::at(&text.place, message).help("rendering is not spectral: no dispersion"),
        );
        return Ok(*eta);
    }
    diagnostics.refuse(unsupported(text, &GLASSES.map(|(name, _)| name)))?;
    Ok(1.5)
}

fn spectrum_name(param: &Param) -> Option<&Text> {
    match &param.values {
        Values::Strings(names) if param.ty == Type::Spectrum => names.first(),
        _ => None,
    }
}

fn unsupported(text: &Text, names: &[&str]) -> SceneError {
    let message = format!("named spectrum \"{}\" is not yet supported", text.text);
    let error = SceneError::at(&text.place, message);
    match nearest(&text.text, names.iter().copied()) {
        Some(near) => error.help(format!("did you mean \"{near}\"?")),
        None => error.help(format!("supported here are {}", names.join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reflectance head-on: ((η − 1)² + k²) / ((η + 1)² + k²).
    fn reflectance(metal: Metal) -> [f64; 3] {
        let (eta, k) = (metal.project(Optical::Eta), metal.project(Optical::K));
        [0, 1, 2].map(|i| {
            let kk = k[i] * k[i];
            ((eta[i] - 1.0).powi(2) + kk) / ((eta[i] + 1.0).powi(2) + kk)
        })
    }

    #[test]
    fn metals_have_their_colours() {
        // The reflectance by wavelength, projected afterwards (numerically, elsewhere): what spectral rendering would
        // show. An index projected first comes within 4 %.
        let known = [
            (COPPER, [0.912, 0.623, 0.518]),
            (GOLD, [1.007, 0.733, 0.359]),
            (SILVER, [0.989, 0.984, 0.978]),
            (ALUMINIUM, [0.913, 0.921, 0.924]),
        ];
        for (metal, expected) in known {
            let found = reflectance(metal);
            for (f, e) in found.iter().zip(expected) {
                assert!((f - e).abs() < 0.04, "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn tables_cover_what_is_visible() {
        for (name, metal, _) in METALS {
            let at = |row: &[f64; 3]| {
                if metal.by_energy {
                    ENERGY / row[0]
                } else {
                    row[0]
                }
            };
            let ends = [metal.rows.first(), metal.rows.last()].map(|row| row.map_or(0.0, at));
            assert!(
                ends[0].min(ends[1]) <= 380.0 && ends[0].max(ends[1]) >= 780.0,
                "{name}"
            );
            assert!(metal.rows.windows(2).all(|w| w[0][0] < w[1][0]), "{name}");
        }
    }
}
