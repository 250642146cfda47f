//! Meshes: `trianglemesh`, `bilinearmesh` and `plymesh`.

use glam::{DMat3, DVec2, DVec3};

use super::super::{BilinearMesh, SceneError, TriangleMesh, ply};
use super::directive::At;
use super::param::{Param, Type};
use super::params::Params;
use super::reader::Reader;
use super::state::affine;

/// How far a corner of a planar patch may lie outside of the plane, over the patch's size: what single
/// precision makes of coordinates some way from the origin.
const FLAT: f64 = 1e-5;

/// A mesh in the world (or its object's space), its faces in the order that their normals ask for.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub(super) positions: Vec<DVec3>,
    pub(super) normals: Vec<DVec3>,
    pub(super) uv: Vec<DVec2>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Corners of bilinear patches at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
    pub(super) quads: Vec<[u32; 4]>,
    /// Which triangles, then patches, have another order than in the file, so that (u, v) by order differ; empty if
    /// none has.
    pub(super) turned: Vec<bool>,
}

impl Mesh {
    /// The area of all faces \[length²\].
    pub(super) fn area(&self) -> f64 {
        let at = |i: u32| self.positions[i as usize];
        let triangle = |&[a, b, c]: &[u32; 3]| {
            let [a, b, c] = [a, b, c].map(at);
            0.5 * (b - a).cross(c - a).length()
        };
        let patch = |corners: &[u32; 4]| patch_area(corners.map(at));
        let triangles: f64 = self.triangles.iter().map(triangle).sum();
        triangles + self.quads.iter().map(patch).sum::<f64>()
    }

    /// All faces as triangles. `Err`: the number of a patch that is not planar.
    pub(super) fn flattened(&self) -> Result<Vec<[u32; 3]>, usize> {
        for (i, corners) in self.quads.iter().enumerate() {
            if !planar(corners.map(|c| self.positions[c as usize])) {
                return Err(i);
            }
        }
        Ok(self.halved())
    }

    /// All faces as triangles, patches that are not planar being bent along a diagonal.
    pub(super) fn halved(&self) -> Vec<[u32; 3]> {
        let halves = self.quads.iter();
        let halves = halves.flat_map(|&[a, b, c, d]| [[a, b, d], [a, d, c]]);
        self.triangles.iter().copied().chain(halves).collect()
    }

    /// The same with (u, v) written out that otherwise follow from the order of corners, if faces were turned.
    pub(super) fn with_parameters(self) -> Self {
        if self.turned.is_empty() || !self.uv.is_empty() {
            return self;
        }
        let mut own = Self::default();
        let mut corner = |index: u32, u: f64, v: f64| {
            let i = index as usize;
            own.positions.push(self.positions[i]);
            own.normals.extend(self.normals.get(i));
            own.uv.push(DVec2::new(u, v));
            (own.positions.len() - 1) as u32
        };
        // Turned faces have their second and third corners exchanged.
        let (triangles, quads) = self.turned.split_at(self.triangles.len());
        let faces = self.triangles.iter().zip(triangles);
        own.triangles = faces
            .map(|(&[a, b, c], &turned)| {
                let (v, w) = if turned { (1.0, 0.0) } else { (0.0, 1.0) };
                [corner(a, 0.0, 0.0), corner(b, 1.0, v), corner(c, 1.0, w)]
            })
            .collect();
        let faces = self.quads.iter().zip(quads);
        own.quads = faces
            .map(|(&[a, b, c, d], &turned)| {
                let (u, v) = if turned { (0.0, 1.0) } else { (1.0, 0.0) };
                let start = [corner(a, 0.0, 0.0), corner(b, u, v)];
                [start[0], start[1], corner(c, v, u), corner(d, 1.0, 1.0)]
            })
            .collect();
        own
    }

    /// The triangles alone.
    pub(super) fn triangle_mesh(&self) -> TriangleMesh {
        TriangleMesh {
            positions: self.positions.clone(),
            indices: self.triangles.clone(),
            normals: self.normals.clone(),
            uv: self.uv.clone(),
        }
    }

    /// The patches alone.
    pub(super) fn bilinear_mesh(&self) -> BilinearMesh {
        BilinearMesh {
            positions: self.positions.clone(),
            indices: self.quads.clone(),
            normals: self.normals.clone(),
            uv: self.uv.clone(),
        }
    }
}

/// Whether four corners lie in a plane, but for rounding.
fn planar([a, b, c, d]: [DVec3; 4]) -> bool {
    let (u, v, w) = (b - a, c - a, d - a);
    let size = u.length().max(v.length()).max(w.length());
    // The volume of the corner over the base: the height of d.
    let base = u.cross(v).length();
    let across = (d - b).cross(d - c).length();
    let volume = w.dot(u.cross(v)).abs();
    volume <= FLAT * size * base.max(across)
}

/// Area of a bilinear patch: exact for planar parallelograms, else by 4 × 4 Gauss–Legendre points.
fn patch_area([a, b, c, d]: [DVec3; 4]) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
    ];
    let mut sum = 0.0;
    for (u, wu) in NODES {
        for (v, wv) in NODES {
            let du = (b - a) * (1.0 - v) + (d - c) * v;
            let dv = (c - a) * (1.0 - u) + (d - b) * u;
            sum += wu * wv * du.cross(dv).length();
        }
    }
    sum
}

impl Reader<'_> {
    pub(super) fn triangle_mesh(&mut self, at: &At, params: &Params) -> Result<Mesh, SceneError> {
        let (mut mesh, points) = vertices(params, "trianglemesh")?;
        let count = mesh.positions.len();
        mesh.triangles = match params.list("indices", Type::Integer)? {
            Some((values, param)) => faces(values, count, param, "triangles")?,
            None if count == 3 => vec![[0, 1, 2]],
            None => {
                let message = "this trianglemesh has no \"integer indices\"";
                return Err(SceneError::at(&points, message)
                    .help("they may only be left out for a single triangle"));
            }
        };
        params.ignore("S", &[Type::Vector3])?;
        params.ignore("faceIndices", &[Type::Integer])?;
        self.opaque(params)?;
        params.finish(&mut self.diagnostics)?;
        self.to_world(at, mesh)
    }

    pub(super) fn bilinear_mesh(&mut self, at: &At, params: &Params) -> Result<Mesh, SceneError> {
        let (mut mesh, points) = vertices(params, "bilinearmesh")?;
        let count = mesh.positions.len();
        mesh.quads = match params.list("indices", Type::Integer)? {
            Some((values, param)) => faces(values, count, param, "patches")?,
            None if count == 4 => vec![[0, 1, 2, 3]],
            None => {
                let message = "this bilinearmesh has no \"integer indices\"";
                return Err(SceneError::at(&points, message)
                    .help("they may only be left out for a single patch"));
            }
        };
        params.ignore("faceIndices", &[Type::Integer])?;
        let instead = "lights are of one radiance";
        params.unsupported("emissionfilename", instead, &mut self.diagnostics)?;
        self.opaque(params)?;
        params.finish(&mut self.diagnostics)?;
        self.to_world(at, mesh)
    }

    pub(super) fn ply_mesh(&mut self, at: &At, params: &Params) -> Result<Mesh, SceneError> {
        let Some(filename) = params.string("filename")?.cloned() else {
            let message = "this plymesh has no \"string filename\"";
            return Err(SceneError::at(params.place(), message));
        };
        for name in ["displacement", "edgelength"] {
            let instead = "displacement is not supported";
            params.unsupported(name, instead, &mut self.diagnostics)?;
        }
        self.opaque(params)?;
        params.finish(&mut self.diagnostics)?;
        let path = self.resolve(&filename.text);
        let bytes = self.load_at(&path, &filename.place)?;
        let mesh = ply::read(&bytes, self.limits.max_memory).map_err(|reason| {
            let message = format!("{}: {reason}", path.display());
            SceneError::at(&filename.place, message)
        })?;
        let mesh = Mesh {
            positions: mesh.positions,
            normals: mesh.normals,
            uv: mesh.uv,
            triangles: mesh.triangles,
            // From the order around the face to that of (u, v).
            quads: mesh
                .quads
                .iter()
                .map(|&[a, b, c, d]| [a, b, d, c])
                .collect(),
            turned: Vec::new(),
        };
        self.to_world(at, mesh)
    }

    /// Brings a mesh to the world, each face in the order that makes its normal point to `outside`.
    ///
    /// pbrt takes the normal from the order in the mesh's own space, turned by `ReverseOrientation`, unless there are
    /// normals at the vertices (turned likewise), which then decide on the side.
    fn to_world(&self, at: &At, mut mesh: Mesh) -> Result<Mesh, SceneError> {
        let [to_world, to_object] = affine(&self.state.transforms[0], &at.place)?;
        for position in &mut mesh.positions {
            *position = to_world.transform_point3(*position);
            if !position.as_vec3().is_finite() {
                let message = "a vertex of this mesh is not finite in the world";
                return Err(SceneError::at(&at.place, message));
            }
        }
        let reversed = self.state.reverse_orientation;
        bring_normals(&mut mesh.normals, to_object.matrix3, reversed);
        // A mirror turns the cross product of a face's edges around, but not what is outside.
        let turn = (to_world.matrix3.determinant() < 0.0) != reversed;
        let Mesh {
            positions,
            normals,
            triangles,
            quads,
            ..
        } = &mut mesh;
        let at = |i: u32| positions[i as usize];
        let disagrees = |normal: DVec3, corners: &[u32]| {
            let shading: DVec3 = corners
                .iter()
                .filter_map(|&i| normals.get(i as usize))
                .sum();
            (if turn { -normal } else { normal }).dot(shading) < 0.0
        };
        let mut turned = Vec::with_capacity(triangles.len() + quads.len());
        for triangle in triangles {
            let [a, b, c] = triangle.map(at);
            turned.push(turn != disagrees((b - a).cross(c - a), triangle));
            if turned.last() == Some(&true) {
                triangle.swap(1, 2);
            }
        }
        for quad in quads {
            let [a, b, c, d] = quad.map(at);
            turned.push(turn != disagrees((b + d - a - c).cross(c + d - a - b), quad));
            if turned.last() == Some(&true) {
                quad.swap(1, 2);
            }
        }
        if !turned.contains(&true) {
            turned.clear();
        }
        mesh.turned = turned;
        Ok(mesh)
    }
}

/// Normals under a map whose inverse has this linear part. Where that overflows, their length is given up.
pub(super) fn bring_normals(normals: &mut [DVec3], inverse: DMat3, reversed: bool) {
    let transposed = inverse.transpose();
    for normal in normals {
        let mut brought = transposed * *normal;
        if !brought.is_finite() {
            brought = (transposed * normal.normalize_or_zero()).normalize_or_zero();
        }
        *normal = if reversed { -brought } else { brought };
    }
}

/// `P`, `N` and `uv`, and where the points are.
fn vertices(params: &Params, what: &str) -> Result<(Mesh, super::super::Place), SceneError> {
    let Some((coordinates, points)) = params.list("P", Type::Point3)? else {
        let message = format!("this {what} has no \"point3 P\"");
        return Err(SceneError::at(params.place(), message));
    };
    let (triples, _) = coordinates.as_chunks::<3>();
    let count = triples.len();
    let mut mesh = Mesh {
        positions: triples.iter().map(|&p| DVec3::from_array(p)).collect(),
        ..Mesh::default()
    };
    if let Some((values, param)) = params.list("N", Type::Normal)? {
        let (triples, _) = values.as_chunks::<3>();
        one_each(triples.len(), count, "normals", param)?;
        mesh.normals = triples.iter().map(|&n| DVec3::from_array(n)).collect();
    }
    if let Some((values, param)) = params.list("uv", Type::Point2)? {
        let (pairs, _) = values.as_chunks::<2>();
        one_each(pairs.len(), count, "pairs (u, v)", param)?;
        mesh.uv = pairs.iter().map(|&uv| DVec2::from_array(uv)).collect();
    }
    Ok((mesh, points.valued.clone()))
}

fn one_each(found: usize, vertices: usize, what: &str, param: &Param) -> Result<(), SceneError> {
    if found == vertices {
        return Ok(());
    }
    let message = format!("{found} {what} for {vertices} vertices");
    Err(SceneError::at(&param.valued, message))
}

/// Indices in groups of `N`, all within the vertices.
fn faces<const N: usize>(
    values: &[f64],
    vertices: usize,
    param: &Param,
    what: &str,
) -> Result<Vec<[u32; N]>, SceneError> {
    let (groups, rest) = values.as_chunks::<N>();
    if !rest.is_empty() {
        let message = format!("{} indices cannot be grouped into {what}", values.len());
        return Err(SceneError::at(&param.valued, message));
    }
    let within = |v: &f64| *v >= 0.0 && *v < vertices as f64;
    if let Some(i) = values.iter().position(|v| !within(v)) {
        let message = format!("index {} names none of the {vertices} vertices", values[i]);
        return Err(SceneError::at(&param.nth(i), message));
    }
    Ok(groups.iter().map(|g| g.map(|v| v as u32)).collect())
}
