//! Surfaces that light meets: what they are made of, and the light that they send out.

use glam::DAffine3;

use super::{Place, Shape, Texture};

/// Index of a material in [`Scene::materials`](super::Scene::materials).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub usize);

/// A surface with matter, or one that shines, or both.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Its geometry, in the world (in an [`Object`]: in the object's space).
    pub shape: Shape,
    /// The normal is the shape's turned around. It points to the outside of dielectrics and to where
    /// one-sided lights shine. (For meshes the order of vertices already says all, and this is false.)
    pub flipped: bool,
    /// What it is made of; `None` is nothing: light passes.
    pub material: Option<MaterialId>,
    /// Light that it sends out.
    pub emission: Option<AreaEmission>,
    /// Where it is described.
    pub place: Place,
}

/// Light of the same radiance from every point of a surface into every direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaEmission {
    /// Radiance per channel \[W/(m² sr)\], not negative.
    pub radiance: [f64; 3],
    /// Whether the back shines too.
    pub two_sided: bool,
}

/// Surfaces that are placed as a whole, perhaps many times. They do not shine, as in pbrt.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name in the scene.
    pub name: String,
    /// What it consists of.
    pub surfaces: Vec<Surface>,
}

/// An object placed in the world. (Media boundaries of objects are copied into
/// [`Scene::boundaries`](super::Scene::boundaries) for each instance.)
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index of the object in [`Scene::objects`](super::Scene::objects).
    pub object: usize,
    /// From the object's space to the world: invertible, perhaps mirrored or sheared.
    pub object_to_world: DAffine3,
    /// Where it is described.
    pub place: Place,
}

/// What a surface is made of.
#[derive(Clone, Debug)]
pub struct Material {
    /// The law of reflection.
    pub kind: MaterialKind,
    /// Where it is described.
    pub place: Place,
}

/// How a surface reflects and transmits. Angles and sides are those of the surface's normal.
#[derive(Clone, Debug)]
pub enum MaterialKind {
    /// Lambert's law.
    Diffuse {
        /// Reflectance by colour, in [0, 1].
        reflectance: Texture,
    },
    /// A boundary between transparent matters.
    Dielectric {
        /// Refractive index behind the normal over that in front of it, positive.
        eta: f64,
        /// Widths of the GGX distribution along u and v, 0 for smooth.
        alpha: [f64; 2],
    },
    /// A pane so thin that it has no inside: light passes without a bend.
    ThinDielectric {
        /// Refractive index of the pane, positive.
        eta: f64,
    },
    /// A metal.
    Conductor {
        /// Refractive index by colour, relative to what is in front.
        eta: [f64; 3],
        /// Extinction coefficient of the complex index by colour.
        k: [f64; 3],
        /// Widths of the GGX distribution along u and v, 0 for smooth.
        alpha: [f64; 2],
    },
}
