//! From index space to world space and back.

use super::VdbError;
use super::bytes::Cursor;
use glam::{DAffine3, DMat3, DMat4, DVec3};

/// How a grid lies in the world. Index (i, j, k) is the *centre* of voxel (i, j, k).
#[derive(Debug, Clone, PartialEq)]
pub struct Transform {
    /// OpenVDB's name of the map, for instance `UniformScaleMap`.
    pub type_name: String,
    map: Map,
}

#[derive(Debug, Clone, PartialEq)]
enum Map {
    Linear {
        forward: DAffine3,
        inverse: DAffine3,
    },
    Frustum(Frustum),
}

/// A tapered box: the lateral scale grows linearly with depth, then an affine map follows.
#[derive(Debug, Clone, PartialEq)]
struct Frustum {
    /// Corner of the index-space box \[voxels\].
    min: DVec3,
    /// Extents of the index-space box \[voxels\].
    size: DVec3,
    /// Relative growth of the lateral scale per unit of depth, (1/taper − 1)/depth.
    gamma: f64,
    /// Depth of the unit frustum \[1\].
    depth: f64,
    forward: DAffine3,
    inverse: DAffine3,
}

impl Frustum {
    fn to_world(&self, index: DVec3) -> DVec3 {
        let mut p = index - self.min;
        p.z *= self.depth / self.size.z;
        let scale = (self.gamma * p.z + 1.0) / self.size.x;
        p.x = (p.x - 0.5 * self.size.x) * scale;
        p.y = (p.y - 0.5 * self.size.y) * scale;
        self.forward.transform_point3(p)
    }

    fn to_index(&self, world: DVec3) -> DVec3 {
        let mut p = self.inverse.transform_point3(world);
        let scale = self.size.x / (self.gamma * p.z + 1.0);
        p.x = p.x * scale + 0.5 * self.size.x;
        p.y = p.y * scale + 0.5 * self.size.y;
        p.z *= self.size.z / self.depth;
        p + self.min
    }
}

impl Transform {
    /// An affine map; `None` where it is singular or not finite.
    #[cfg(feature = "nvdb")]
    pub(crate) fn of_affine(type_name: &str, forward: DAffine3) -> Option<Self> {
        let (forward, inverse) = inverted(forward)?;
        Some(Self {
            type_name: type_name.to_owned(),
            map: Map::Linear { forward, inverse },
        })
    }

    /// The 4×4 matrix from index to world space (column vectors), or `None` for a frustum, which is not linear.
    #[must_use]
    pub fn index_to_world(&self) -> Option<DMat4> {
        match &self.map {
            Map::Linear { forward, .. } => Some(DMat4::from(*forward)),
            Map::Frustum(_) => None,
        }
    }

    /// The linear map from index to world space, or `None` for a frustum.
    #[must_use]
    pub fn affine(&self) -> Option<DAffine3> {
        match &self.map {
            Map::Linear { forward, .. } => Some(*forward),
            Map::Frustum(_) => None,
        }
    }

    /// World position of a point in index space.
    #[must_use]
    pub fn to_world(&self, index: DVec3) -> DVec3 {
        match &self.map {
            Map::Linear { forward, .. } => forward.transform_point3(index),
            Map::Frustum(frustum) => frustum.to_world(index),
        }
    }

    /// Index-space position of a point in the world; not finite on the plane where a frustum's rays meet.
    #[must_use]
    pub fn to_index(&self, world: DVec3) -> DVec3 {
        match &self.map {
            Map::Linear { inverse, .. } => inverse.transform_point3(world),
            Map::Frustum(frustum) => frustum.to_index(world),
        }
    }
}

/// A linear map and its inverse; `None` where it is not finite or not invertible.
fn inverted(forward: DAffine3) -> Option<(DAffine3, DAffine3)> {
    let columns = forward.matrix3;
    let volume = columns.x_axis.length() * columns.y_axis.length() * columns.z_axis.length();
    let determinant = columns.determinant().abs();
    let inverse = forward.inverse();
    // 1e-12: beyond that the axes are parallel to within the accuracy of the inverse.
    let sound = forward.is_finite() && inverse.is_finite() && determinant > 1e-12 * volume;
    sound.then_some((forward, inverse))
}

fn invertible(cursor: &Cursor<'_>, forward: DAffine3) -> Result<(DAffine3, DAffine3), VdbError> {
    inverted(forward).ok_or_else(|| cursor.damaged("the transform is singular or not finite"))
}

/// OpenVDB multiplies row vectors from the left, so its sixteen numbers read as our columns.
fn affine(cursor: &mut Cursor<'_>) -> Result<DAffine3, VdbError> {
    let m = DMat4::from_cols_array(&cursor.f64s("a transform matrix")?);
    if m.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err(cursor.damaged("the transform matrix is not affine"));
    }
    Ok(DAffine3::from_mat4(m))
}

fn frustum(cursor: &mut Cursor<'_>) -> Result<Map, VdbError> {
    const WHAT: &str = "a frustum transform";
    let min = DVec3::from_array(cursor.f64s(WHAT)?);
    let max = DVec3::from_array(cursor.f64s(WHAT)?);
    let [taper, depth] = cursor.f64s(WHAT)?;
    let second = cursor.string(WHAT)?;
    if second != "AffineMap" {
        return Err(cursor.damaged(format!("a frustum transform is followed by `{second}`")));
    }
    let linear = affine(cursor)?;
    let (forward, inverse) = invertible(cursor, linear)?;
    let size = max - min;
    let gamma = (1.0 / taper - 1.0) / depth;
    if !(size.is_finite() && size.min_element() > 0.0 && gamma.is_finite() && depth.is_finite()) {
        return Err(cursor.damaged("the frustum transform is degenerate"));
    }
    Ok(Map::Frustum(Frustum {
        min,
        size,
        gamma,
        depth,
        forward,
        inverse,
    }))
}

/// Reads a transform: the name of its map, then the map.
pub(crate) fn read(cursor: &mut Cursor<'_>) -> Result<Transform, VdbError> {
    const WHAT: &str = "a transform";
    let start = cursor.offset();
    let type_name = cursor.string("the name of a transform")?;
    let linear = match type_name.as_str() {
        // The scale maps store four more vectors that follow from the first: skipped.
        "UniformScaleMap" | "ScaleMap" => {
            let scale = DVec3::from_array(cursor.f64s(WHAT)?);
            cursor.f64s::<12>(WHAT)?;
            DAffine3::from_scale(scale)
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let translation = DVec3::from_array(cursor.f64s(WHAT)?);
            let scale = DVec3::from_array(cursor.f64s(WHAT)?);
            cursor.f64s::<12>(WHAT)?;
            DAffine3::from_mat3_translation(DMat3::from_diagonal(scale), translation)
        }
        "TranslationMap" => DAffine3::from_translation(DVec3::from_array(cursor.f64s(WHAT)?)),
        "AffineMap" | "UnitaryMap" => affine(cursor)?,
        "NonlinearFrustumMap" => {
            let map = frustum(cursor)?;
            return Ok(Transform { type_name, map });
        }
        _ => {
            return Err(VdbError::Unsupported {
                offset: start,
                what: format!("the transform `{type_name}` is not one of OpenVDB's"),
            });
        }
    };
    let (forward, inverse) = invertible(cursor, linear)?;
    Ok(Transform {
        type_name,
        map: Map::Linear { forward, inverse },
    })
}
