//! Media by the name of a measured material.

use super::super::SceneError;
use super::diagnostics::Diagnostics;
use super::params::Params;
use super::suggest::nearest;

/// A measured material: reduced scattering and absorption by colour \[1/mm\].
type Measured = (&'static str, [f64; 3], [f64; 3]);

/// Of one word: [Jensen 2001]; the others, and drinks: [Narasimhan 2006]. pbrt has the same.
#[rustfmt::skip]
const MEASURED: [Measured; 47] = [
    ("Apple", [2.29, 2.39, 1.97], [0.003_0, 0.003_4, 0.046]),
    ("Apple Juice", [0.000_136_12, 0.000_158_36, 0.000_227], [0.012_957, 0.023_741, 0.052_184]),
    ("Budweiser Beer", [2.435_6e-5, 2.407_9e-5, 1.056_4e-5], [0.011_492, 0.024_911, 0.057_786]),
    ("Cappuccino Powder", [1.843_6, 2.585_1, 2.166_2], [35.844, 49.547, 61.084]),
    ("Chardonnay", [1.798_2e-5, 1.375_8e-5, 1.202_3e-5], [0.010_782, 0.011_855, 0.023_997]),
    ("Chicken1", [0.15, 0.21, 0.38], [0.015, 0.077, 0.19]),
    ("Chicken2", [0.19, 0.25, 0.32], [0.018, 0.088, 0.20]),
    ("Clorox", [0.002_403_5, 0.003_137_3, 0.003_991], [0.003_354_2, 0.014_892, 0.026_297]),
    ("Coke", [8.905_3e-5, 8.372e-5, 0.0], [0.100_14, 0.165_03, 0.246_8]),
    ("Coors Light Beer", [5.092_2e-5, 4.301e-5, 0.0], [0.006_164, 0.013_984, 0.034_983]),
    ("Cranberry Juice", [0.000_104_02, 0.000_116_46, 7.813_9e-5], [0.039_437, 0.094_223, 0.124_26]),
    ("Cream", [7.38, 5.47, 3.15], [0.000_2, 0.002_8, 0.016_3]),
    ("Espresso", [0.723_78, 0.845_57, 1.024_7], [4.798_4, 6.575_1, 8.849_3]),
    ("Gatorade", [0.002_457_4, 0.003_007, 0.003_732_5], [0.024_794, 0.019_289, 0.008_878]),
    ("Grape Juice", [5.382e-5, 0.0, 0.0], [0.104_04, 0.239_58, 0.293_25]),
    ("Head & Shoulders Shampoo", [0.023_805, 0.028_804, 0.034_306], [0.084_621, 0.156_88, 0.203_65]),
    ("Ketchup", [0.18, 0.07, 0.03], [0.061, 0.97, 1.45]),
    ("Lemon Tea Powder", [0.040_224, 0.045_264, 0.051_081], [2.428_8, 4.575_7, 7.212_7]),
    ("Lowfat Chocolate Milk", [0.649_25, 0.839_16, 1.105_7], [0.011_5, 0.036_8, 0.156_4]),
    ("Lowfat Milk", [0.891_87, 1.513_6, 2.532], [0.002_875, 0.005_75, 0.011_5]),
    ("Lowfat Soy Milk", [0.305_76, 0.342_33, 0.616_64], [0.001_437_5, 0.007_187_5, 0.035_937]),
    ("Marble", [2.19, 2.62, 3.00], [0.002_1, 0.004_1, 0.007_1]),
    ("Merlot", [2.112_9e-5, 0.0, 0.0], [0.116_32, 0.251_91, 0.294_34]),
    ("Mint Mocha Coffee", [0.316_02, 0.385_38, 0.481_31], [3.772, 5.822_8, 7.82]),
    ("Orange Powder", [0.000_156_17, 0.000_174_82, 0.000_176_2], [0.001_449, 0.003_441, 0.007_863]),
    ("Pacific Ocean Surface Water", [0.000_176_4, 0.000_320_95, 0.000_196_17], [0.031_845, 0.031_324, 0.030_147]),
    ("Pepsi", [6.169_7e-5, 4.256_4e-5, 0.0], [0.091_641, 0.141_58, 0.207_29]),
    ("Pink Lemonade Powder", [0.000_121_03, 0.000_130_73, 0.000_125_28], [0.001_165, 0.002_366, 0.003_195]),
    ("Potato", [0.68, 0.70, 0.55], [0.002_4, 0.009_0, 0.12]),
    ("Reduced Milk", [2.485_8, 3.166_9, 4.521_4], [0.002_555_6, 0.005_111_1, 0.012_778]),
    ("Regular Chocolate Milk", [1.458_5, 2.128_9, 2.952_7], [0.010_063, 0.043_125, 0.143_75]),
    ("Regular Milk", [4.551_3, 5.829_4, 7.136], [0.001_533_3, 0.004_6, 0.019_933]),
    ("Regular Soy Milk", [0.592_23, 0.738_66, 1.469_3], [0.001_916_7, 0.009_583_3, 0.065_167]),
    ("Ruby Grapefruit Juice", [0.011_002, 0.010_927, 0.011_036], [0.085_867, 0.183_14, 0.252_62]),
    ("Salt Powder", [0.027_333, 0.032_451, 0.031_979], [0.284_15, 0.325_7, 0.341_48]),
    ("Shampoo", [0.000_717_6, 0.000_830_3, 0.000_901_6], [0.014_107, 0.045_693, 0.061_717]),
    ("Skimmilk", [0.70, 1.22, 1.90], [0.001_4, 0.002_5, 0.014_2]),
    ("Skin1", [0.74, 0.88, 1.01], [0.032, 0.17, 0.48]),
    ("Skin2", [1.09, 1.59, 1.79], [0.013, 0.070, 0.145]),
    ("Spectralon", [11.6, 20.4, 14.9], [0.0, 0.0, 0.0]),
    ("Sprite", [6.030_6e-6, 6.413_9e-6, 6.550_4e-6], [0.001_886, 0.001_830_8, 0.002_002_5]),
    ("Strawberry Shampoo", [0.000_156_71, 0.000_159_47, 1.518e-5], [0.014_49, 0.057_96, 0.075_823]),
    ("Sugar Powder", [0.000_222_72, 0.000_255_13, 0.000_271], [0.012_638, 0.031_051, 0.050_124]),
    ("Suisse Mocha Powder", [2.797_9, 3.545_2, 4.336_5], [17.502, 27.004, 35.433]),
    ("White Grapefruit Juice", [0.228_26, 0.239_98, 0.327_48], [0.013_8, 0.018_831, 0.056_781]),
    ("White Zinfandel", [1.750_1e-5, 1.906_9e-5, 1.288e-5], [0.012_072, 0.016_184, 0.019_843]),
    ("Wholemilk", [2.55, 3.21, 3.77], [0.001_1, 0.002_4, 0.014]),
];

/// The coefficients (absorption, scattering) of a `preset`; one length of the world is a millimetre before `scale`.
///
/// Scattering is the reduced one, so that it goes with an isotropic phase function.
pub(super) fn preset(
    params: &Params,
    diagnostics: &mut Diagnostics,
) -> Result<Option<[[f64; 3]; 2]>, SceneError> {
    let Some(text) = params.string("preset")? else {
        return Ok(None);
    };
    let found = MEASURED.iter().find(|(name, ..)| *name == text.text);
    if let Some((_, sigma_s, sigma_a)) = found {
        return Ok(Some([*sigma_a, *sigma_s]));
    }
    let names = MEASURED.map(|(name, ..)| name);
    let error = SceneError::at(&text.place, format!("unknown preset \"{}\"", text.text));
    diagnostics.refuse(match nearest(&text.text, names) {
        Some(near) => error.help(format!("did you mean \"{near}\"?")),
        None => error.help(format!("there are {}", names.join(", "))),
    })?;
    Ok(None)
}
