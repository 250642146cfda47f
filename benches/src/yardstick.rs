//! Scenes to measure efficiency by: small, made from formulas, and in files that peers can read as well.
//!
//! | name | what it is |
//! |---|---|
//! | `cloud` | 256³ voxels, 86 % of them empty, up to 40 mean free paths a unit, strongly forward, sun and sky |
//! | `ground` | the same cloud above a ground |
//! | `fog` | a ball of homogeneous fog under a constant sky |
//! | `smoke` | 128³ voxels whose extinction differs fourfold between colours |
//! | `absorption` | 128³ voxels that only absorb, before a constant sky |
//! | `fire` | 48 × 96 × 48 voxels that shine as black bodies do, and scatter a little |
//! | `box-fog` | a room full of fog with a lamp in it |
//!
//! All but the last and `ground` are also plain numbers ([`Yardstick`]), for whoever brings a tracker of their own.

use std::fmt::Write as _;

use crate::noise::{Ball, fractal};

/// Columns and rows of the pictures.
pub const RESOLUTION: usize = 128;
/// Names of all scenes.
pub const NAMES: [&str; 6] = ["cloud", "fog", "smoke", "absorption", "fire", "box-fog"];

/// What the cloud of `ground` is above.
const GROUND: &str = "AttributeBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ 0.4 0.35 0.3 ]\n\
    Shape \"trianglemesh\" \"point3 P\" [ -6 -0.6 -6 6 -0.6 -6 6 -0.6 6 -6 -0.6 6 ]\n    \
    \"integer indices\" [ 0 2 1 0 3 2 ]\nAttributeEnd\n";

/// A room full of fog, whose surfaces are beyond plain numbers.
pub const BOX_FOG: &str = include_str!("../../tests/peers/scenes/box-fog.pbrt");

/// Samples at the centres of the cells of a box, its longest edge a unit long, around the origin.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Cells along x, y, z.
    pub dims: [usize; 3],
    /// Density, x fastest, at most one.
    pub density: Vec<f32>,
    /// Temperature \[K\]; empty where nothing shines.
    pub kelvin: Vec<f32>,
}

/// Where there is matter.
#[derive(Clone, Debug)]
pub enum Matter {
    /// A homogeneous ball around the origin, of density one.
    Ball {
        /// Its radius.
        radius: f32,
    },
    /// A grid. From the outermost samples to the faces of the box it is constant.
    Cells(Cells),
}

/// A scene in plain numbers.
#[derive(Clone, Debug)]
pub struct Yardstick {
    /// Its name.
    pub name: &'static str,
    /// Where the camera is; it looks at the origin, y up.
    pub eye: [f32; 3],
    /// Field of view \[degrees\].
    pub fov: f32,
    /// Density by place.
    pub matter: Matter,
    /// Absorption at density one by colour \[1/length\].
    pub sigma_a: [f32; 3],
    /// Scattering at density one by colour \[1/length\].
    pub sigma_s: [f32; 3],
    /// Mean cosine.
    pub g: f32,
    /// A distant light: the direction towards it, and its irradiance.
    pub sun: Option<([f32; 3], [f32; 3])>,
    /// Radiance of the sky.
    pub sky: [f32; 3],
    /// Factor on the radiance of black bodies of spectra that are one at their peaks.
    pub glow: f32,
    /// Surfaces in pbrt's language, beyond plain numbers.
    pub surfaces: &'static str,
}

impl Yardstick {
    /// The scene of a name, its grid `coarser` times coarser than it should be; `None` for what is not plain numbers.
    pub fn named(name: &str, coarser: usize) -> Option<Self> {
        match name {
            "cloud" => Some(Self::cloud(256 / coarser)),
            "ground" => Some(Self::ground(256 / coarser)),
            "fog" => Some(Self::fog()),
            "smoke" => Some(Self::smoke(128 / coarser)),
            "absorption" => Some(Self::absorption(128 / coarser)),
            "fire" => Some(Self::fire(48 / coarser)),
            _ => None,
        }
    }

    /// A cumulus under sun and sky on a grid of `side`³.
    pub fn cloud(side: usize) -> Self {
        let balls = [
            Ball::new([0.0, -0.17, 0.0], 0.24),
            Ball::new([-0.2, -0.2, 0.06], 0.17),
            Ball::new([0.21, -0.19, -0.05], 0.18),
            Ball::new([0.06, 0.02, 0.02], 0.2),
            Ball::new([-0.1, -0.02, -0.12], 0.15),
            Ball::new([0.02, 0.17, 0.02], 0.13),
            Ball::new([0.16, -0.05, 0.16], 0.13),
        ];
        let density = |p: [f32; 3]| {
            let depth = balls.iter().map(|ball| ball.depth(p)).fold(-1.0, f32::max);
            // Below, the condensation level cuts it off.
            let depth = depth.min(4.0 * (p[1] + 0.33));
            if depth < -0.55 {
                return 0.0;
            }
            let billows = fractal(p.map(|c| c * 9.0), 5) - 0.5;
            (4.0 * (depth + 0.1 + 0.9 * billows)).clamp(0.0, 1.0)
        };
        Self {
            name: "cloud",
            eye: [0.3, 0.15, -1.9],
            fov: 27.0,
            matter: Matter::Cells(Cells::new([side; 3], density)),
            sigma_a: [0.04; 3],
            sigma_s: [39.96; 3],
            g: 0.85,
            sun: Some(([-0.6, 0.7, -0.5], [5.0, 4.6, 4.0])),
            sky: [0.25, 0.4, 0.7],
            glow: 0.0,
            surfaces: "",
        }
    }

    /// The cloud above a ground.
    pub fn ground(side: usize) -> Self {
        Self {
            name: "ground",
            eye: [0.3, 0.4, -2.6],
            fov: 34.0,
            surfaces: GROUND,
            ..Self::cloud(side)
        }
    }

    /// A ball of fog under a constant sky.
    pub fn fog() -> Self {
        Self {
            name: "fog",
            eye: [0.0, 0.4, -3.6],
            fov: 32.0,
            matter: Matter::Ball { radius: 1.0 },
            sigma_a: [0.2; 3],
            sigma_s: [1.8; 3],
            g: 0.3,
            sun: None,
            sky: [0.8, 0.9, 1.0],
            glow: 0.0,
            surfaces: "",
        }
    }

    /// Smoke on a grid of `side`³ that is four times as opaque in blue as in red.
    pub fn smoke(side: usize) -> Self {
        let sigma_t = [4.0, 8.0, 16.0];
        let albedo = [0.9, 0.85, 0.8];
        Self {
            name: "smoke",
            eye: [0.2, 0.3, -1.9],
            fov: 30.0,
            matter: Matter::Cells(Cells::new([side; 3], puffs)),
            sigma_a: [0, 1, 2].map(|c| sigma_t[c] * (1.0 - albedo[c])),
            sigma_s: [0, 1, 2].map(|c| sigma_t[c] * albedo[c]),
            g: 0.4,
            sun: None,
            sky: [0.8, 0.9, 1.0],
            glow: 0.0,
            surfaces: "",
        }
    }

    /// What only absorbs, on a grid of `side`³, up to five mean free paths before a constant sky.
    pub fn absorption(side: usize) -> Self {
        Self {
            name: "absorption",
            sigma_a: [8.6; 3],
            sigma_s: [0.0; 3],
            ..Self::smoke(side)
        }
    }

    /// A fire on a grid twice as high as `side`.
    pub fn fire(side: usize) -> Self {
        let dims = [side, 2 * side, side];
        // From 0 at the foot to 1 on top; how far from the flickering axis, in widths of the flame.
        let flame = |p: [f32; 3]| {
            let height = p[1] + 0.5;
            let sway = fractal([3.0 * p[1], 0.3, 7.7], 2) - 0.5;
            let away = ((p[0] - 0.2 * sway * height).powi(2) + p[2] * p[2]).sqrt();
            let width = 0.27 * (1.05 - height) * (0.6 + 2.0 * height).min(1.0);
            let tongues = fractal([14.0 * p[0], 5.0 * p[1], 14.0 * p[2]], 4) - 0.5;
            (height, 1.0 - away / width.max(0.02) + 1.6 * tongues)
        };
        let mut cells = Cells::new(dims, |p| {
            let (height, depth) = flame(p);
            // Nothing near the faces, where readers of grids differ.
            let foot = (20.0 * height - 1.0).clamp(0.0, 1.0);
            foot * (1.5 * depth).clamp(0.0, 1.0) * (1.0 - 0.5 * height)
        });
        let hot = Cells::new(dims, |p| {
            let (height, depth) = flame(p);
            600.0 + 1300.0 * depth.clamp(0.0, 1.0).sqrt() * (1.0 - 0.4 * height)
        });
        cells.kelvin = hot.density;
        Self {
            name: "fire",
            eye: [0.2, 0.2, -2.1],
            fov: 28.0,
            matter: Matter::Cells(cells),
            sigma_a: [12.0; 3],
            sigma_s: [4.0; 3],
            g: 0.3,
            sun: None,
            sky: [0.02, 0.03, 0.05],
            glow: 1500.0,
            surfaces: "",
        }
    }

    /// Extinction at density one by colour \[1/length\].
    pub fn sigma_t(&self) -> [f32; 3] {
        [0, 1, 2].map(|c| self.sigma_a[c] + self.sigma_s[c])
    }

    /// The scene in pbrt's language. A grid that does not shine is in the file of [`volume`](Self::volume).
    pub fn text(&self) -> String {
        let list = |values: &[f32]| {
            let mut text = String::new();
            for value in values {
                // Writing to a string cannot fail.
                let _ = write!(text, "{value} ");
            }
            text
        };
        let [x, y, z] = self.eye;
        let mut text = format!(
            "Scale -1 1 1  # The peer's cameras are right-handed.\n\
            LookAt {x} {y} {z}   0 0 0   0 1 0\n\
            Camera \"perspective\" \"float fov\" {}\n\
            Film \"rgb\" \"integer xresolution\" {RESOLUTION} \"integer yresolution\" {RESOLUTION}\n\
            PixelFilter \"box\"\n\
            Integrator \"volpath\"\n\n\
            WorldBegin\n\
            LightSource \"infinite\" \"rgb L\" [ {}]\n",
            self.fov,
            list(&self.sky),
        );
        if let Some((towards, irradiance)) = &self.sun {
            text += &format!(
                "LightSource \"distant\" \"point3 from\" [ {}] \"point3 to\" [ 0 0 0 ] \"rgb L\" [ {}]\n",
                list(towards),
                list(irradiance),
            );
        }
        let optics = format!(
            "    \"rgb sigma_a\" [ {}] \"rgb sigma_s\" [ {}] \"float g\" {}\n",
            list(&self.sigma_a),
            list(&self.sigma_s),
            self.g,
        );
        let name = self.name;
        text += &match &self.matter {
            Matter::Ball { .. } => {
                format!("MakeNamedMedium \"{name}\" \"string type\" \"homogeneous\"\n{optics}")
            }
            Matter::Cells(cells) => {
                let [a, b, c] = cells.corner();
                if cells.kelvin.is_empty() {
                    let [sx, sy, sz] = [a, b, c].map(|corner| -2.0 * corner);
                    format!(
                        "AttributeBegin\nTranslate {a} {b} {c} Scale {sx} {sy} {sz}\n\
                        MakeNamedMedium \"{name}\" \"string type\" \"vol\" \"string filename\" \"{name}.vol\"\n\
                        {optics}AttributeEnd\n"
                    )
                } else {
                    let [nx, ny, nz] = cells.dims;
                    format!(
                        "MakeNamedMedium \"{name}\" \"string type\" \"uniformgrid\"\n\
                        {optics}    \"integer nx\" {nx} \"integer ny\" {ny} \"integer nz\" {nz}\n    \
                        \"point3 p0\" [ {a} {b} {c} ] \"point3 p1\" [ {} {} {} ]\n    \
                        \"float Lescale\" {} \"float density\" [ {}]\n    \"float temperature\" [ {}]\n",
                        -a,
                        -b,
                        -c,
                        self.glow,
                        list(&cells.density),
                        list(&cells.kelvin),
                    )
                }
            }
        };
        let shape = match &self.matter {
            Matter::Ball { radius } => format!("Shape \"sphere\" \"float radius\" {radius}\n"),
            Matter::Cells(cells) => {
                let [a, b, c] = cells.corner();
                let mut points = String::new();
                for [x, y, z] in [
                    [a, b, c],
                    [-a, b, c],
                    [-a, -b, c],
                    [a, -b, c],
                    [a, b, -c],
                    [-a, b, -c],
                    [-a, -b, -c],
                    [a, -b, -c],
                ] {
                    points += &list(&[x, y, z]);
                }
                format!(
                    "Shape \"trianglemesh\" \"point3 P\" [ {points}]\n    \"integer indices\" \
                    [ 0 2 1 0 3 2 4 5 6 4 6 7 0 1 5 0 5 4 3 7 6 3 6 2 0 4 7 0 7 3 1 2 6 1 6 5 ]\n"
                )
            }
        };
        text + &format!(
            "AttributeBegin\nMaterial \"interface\"\nMediumInterface \"{name}\" \"\"\n{shape}AttributeEnd\n"
        ) + self.surfaces
    }

    /// Name and bytes of the volume that the scene's text asks for: Mitsuba's format, single precision.
    pub fn volume(&self) -> Option<(String, Vec<u8>)> {
        let Matter::Cells(cells) = &self.matter else {
            return None;
        };
        if !cells.kelvin.is_empty() {
            return None;
        }
        let mut bytes = b"VOL\x03".to_vec();
        let [nx, ny, nz] = cells.dims.map(|n| n as i32);
        for number in [1, nx, ny, nz, 1] {
            bytes.extend(number.to_le_bytes());
        }
        for number in [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.reserve_exact(4 * cells.density.len());
        bytes.extend(cells.density.iter().flat_map(|value| value.to_le_bytes()));
        Some((format!("{}.vol", self.name), bytes))
    }
}

impl Cells {
    /// A density at the centres of cells.
    pub fn new([nx, ny, nz]: [usize; 3], value: impl Fn([f32; 3]) -> f32) -> Self {
        let longest = nx.max(ny).max(nz) as f32;
        let centre = |i: usize, n: usize| (i as f32 + 0.5 - 0.5 * n as f32) / longest;
        let mut density = Vec::with_capacity(nx * ny * nz);
        for z in 0..nz {
            for y in 0..ny {
                let row = (0..nx).map(|x| value([centre(x, nx), centre(y, ny), centre(z, nz)]));
                density.extend(row);
            }
        }
        Self {
            dims: [nx, ny, nz],
            density,
            kelvin: Vec::new(),
        }
    }

    /// The lower corner of the box; the upper one is opposite.
    pub fn corner(&self) -> [f32; 3] {
        let longest = self.dims.into_iter().max().unwrap_or(1) as f32;
        self.dims.map(|n| -0.5 * n as f32 / longest)
    }

    /// Makes the voxel where the density is largest, nearest to the middle, `factor` times as dense; the rest of the cells
    /// keeps its density. Returns the new largest density.
    pub fn spike(&mut self, factor: f32) -> f32 {
        let [nx, ny, nz] = self.dims;
        let middle = (nz / 2 * ny + ny / 2) * nx + nx / 2;
        let near = |i: usize| i.abs_diff(middle);
        let largest = self.density.iter().copied().fold(0.0, f32::max);
        let places = (0..self.density.len()).filter(|i| self.density[*i] == largest);
        if let Some(place) = places.min_by_key(|i| near(*i)) {
            self.density[place] *= factor;
        }
        largest * factor
    }
}

/// Puffs of smoke in the middle of a unit cube.
fn puffs(p: [f32; 3]) -> f32 {
    let depth = Ball::new([0.0; 3], 0.46).depth(p);
    if depth <= 0.0 {
        return 0.0;
    }
    let wisps = fractal(p.map(|c| 6.0 * c + 40.0), 4);
    (2.0 * depth.sqrt() * (2.4 * wisps - 0.85)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(scene: &Yardstick) -> &Cells {
        match &scene.matter {
            Matter::Cells(cells) => cells,
            Matter::Ball { .. } => panic!("{} has cells", scene.name),
        }
    }

    #[test]
    fn the_cloud_is_as_empty_as_it_should_be() {
        let cloud = Yardstick::cloud(64);
        let density = &cells(&cloud).density;
        let empty = density.iter().filter(|d| **d == 0.0).count() as f64 / density.len() as f64;
        assert!((0.85..0.87).contains(&empty), "{empty}");
        assert!(density.contains(&1.0));
    }

    #[test]
    fn optical_depths_of_the_absorber_reach_from_a_tenth_to_five() {
        let scene = Yardstick::absorption(64);
        let cells = cells(&scene);
        let depth = |x: usize, y: usize| {
            let column = (0..64).map(|z| cells.density[(z * 64 + y) * 64 + x]);
            column.sum::<f32>() / 64.0 * scene.sigma_a[0]
        };
        let depths = (0..64 * 64).map(|i| depth(i % 64, i / 64));
        let largest = depths.clone().fold(0.0, f32::max);
        assert!((4.0..5.5).contains(&largest), "{largest}");
        assert!(depths.filter(|d| (0.1..1.0).contains(d)).count() > 200);
    }

    #[test]
    fn a_spike_is_one_voxel() {
        let mut spiked = Yardstick::cloud(32);
        let before = cells(&spiked).density.clone();
        let Matter::Cells(cells) = &mut spiked.matter else {
            panic!("a cloud has cells")
        };
        assert_eq!(cells.spike(100.0), 100.0);
        let changed = cells.density.iter().zip(&before).filter(|(a, b)| a != b);
        assert_eq!(changed.count(), 1);
    }
}
