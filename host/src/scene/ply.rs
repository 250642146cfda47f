//! PLY meshes: ascii and both binary orders; vertices with optional normals and (u, v), faces as triangles, as
//! quadrilaterals, or as polygons cut into fans. Everything else in the file is stepped over.
//!
//! Source: G. Turk, "The PLY Polygon File Format", 1994. Nothing is allocated that the file's own
//! length does not vouch for.

use glam::{DVec2, DVec3};

/// A mesh as the file has it.
#[derive(Debug, Default, PartialEq)]
pub(super) struct PlyMesh {
    pub(super) positions: Vec<DVec3>,
    /// One per vertex, or none at all.
    pub(super) normals: Vec<DVec3>,
    /// One per vertex, or none at all.
    pub(super) uv: Vec<DVec2>,
    /// All within `positions`.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Faces of four corners, in their order around the face; all within `positions`.
    pub(super) quads: Vec<[u32; 4]>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Result<Self, String> {
        Ok(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            other => return Err(format!("unknown property type {other:?}")),
        })
    }
}

#[derive(Debug)]
struct Property {
    name: String,
    ty: Scalar,
    /// Type of the length in front of a list.
    list: Option<Scalar>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

/// Reads a mesh. `max_memory` \[bytes\] bounds what it may take.
///
/// # Errors
/// A sentence without a place: PLY files are mostly binary.
pub(super) fn read(bytes: &[u8], max_memory: u64) -> Result<PlyMesh, String> {
    let (encoding, elements, body) = header(bytes)?;
    let mut values = Values {
        encoding,
        rest: body,
    };
    let mut mesh = PlyMesh::default();
    let most = usize::try_from(max_memory / 12).unwrap_or(usize::MAX);
    let mut seen_vertices = false;
    for element in &elements {
        // A property takes at least a byte, in ascii two: what is promised beyond that is not there.
        if element.count > body.len() && !element.properties.is_empty() {
            let Element { name, count, .. } = element;
            return Err(format!(
                "{count} elements {name:?} do not fit into the file"
            ));
        }
        match element.name.as_str() {
            "vertex" => {
                vertices(element, &mut values, &mut mesh)?;
                seen_vertices = true;
            }
            "face" => faces(element, &mut values, &mut mesh, most)?,
            _ => skip(element, &mut values)?,
        }
    }
    if !seen_vertices {
        return Err("there is no element vertex".to_owned());
    }
    let count = mesh.positions.len();
    let outside = |i: &&u32| **i as usize >= count;
    let corners = mesh.triangles.iter().flatten();
    if let Some(i) = corners.chain(mesh.quads.iter().flatten()).find(outside) {
        return Err(format!("a face refers to vertex {i} of {count}"));
    }
    Ok(mesh)
}

fn header(bytes: &[u8]) -> Result<(Encoding, Vec<Element>, &[u8]), String> {
    let mut rest = bytes;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    if header_line(&mut rest)? != "ply" {
        return Err("not a PLY file: it does not begin with \"ply\"".to_owned());
    }
    loop {
        let line = header_line(&mut rest)?;
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words.as_slice() {
            ["end_header"] => break,
            ["format", name, "1.0"] => {
                encoding = Some(match *name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    other => return Err(format!("unknown encoding {other:?}")),
                });
            }
            ["element", name, count] => elements.push(Element {
                name: (*name).to_owned(),
                count: count
                    .parse()
                    .map_err(|_| format!("{count:?} is no number of elements"))?,
                properties: Vec::new(),
            }),
            ["property", ..] => {
                let property = property(&words)?;
                let element = elements.last_mut().ok_or("a property before any element")?;
                element.properties.push(property);
            }
            ["comment" | "obj_info", ..] | [] => {}
            _ => return Err(format!("unknown header line {line:?}")),
        }
    }
    let encoding = encoding.ok_or("the header names no format 1.0")?;
    Ok((encoding, elements, rest))
}

fn property(words: &[&str]) -> Result<Property, String> {
    match words {
        [_, "list", length, ty, name] => {
            let length = Scalar::named(length)?;
            if matches!(length, Scalar::F32 | Scalar::F64) {
                return Err(format!("the length of list {name:?} is not an integer"));
            }
            Ok(Property {
                name: (*name).to_owned(),
                ty: Scalar::named(ty)?,
                list: Some(length),
            })
        }
        [_, ty, name] => Ok(Property {
            name: (*name).to_owned(),
            ty: Scalar::named(ty)?,
            list: None,
        }),
        _ => Err(format!("unknown header line {:?}", words.join(" "))),
    }
}

/// The next line of the header, without its end; at most 4 KiB.
fn header_line<'a>(rest: &mut &'a [u8]) -> Result<&'a str, String> {
    let window = &rest[..rest.len().min(4096)];
    let length = window
        .iter()
        .position(|&b| b == b'\n')
        .ok_or("the header has no end")?;
    let line = std::str::from_utf8(&rest[..length]).map_err(|_| "the header is not text")?;
    *rest = &rest[length + 1..];
    Ok(line.trim_end_matches('\r'))
}

fn vertices(element: &Element, values: &mut Values<'_>, mesh: &mut PlyMesh) -> Result<(), String> {
    let find = |name: &str| {
        let scalar = |p: &Property| p.name == name && p.list.is_none();
        element.properties.iter().position(scalar)
    };
    let [Some(x), Some(y), Some(z)] = ["x", "y", "z"].map(find) else {
        return Err("vertices have no x, y, z".to_owned());
    };
    let normal = match ["nx", "ny", "nz"].map(find) {
        [Some(x), Some(y), Some(z)] => Some([x, y, z]),
        _ => None,
    };
    // Names of several exporters; pbrt knows the same.
    let pairs = [
        ["u", "v"],
        ["s", "t"],
        ["texture_u", "texture_v"],
        ["texture_s", "texture_t"],
    ];
    let uv = pairs.iter().find_map(|names| match names.map(find) {
        [Some(u), Some(v)] => Some([u, v]),
        _ => None,
    });
    let mut row = vec![0.0; element.properties.len()];
    for i in 0..element.count {
        for (value, property) in row.iter_mut().zip(&element.properties) {
            match property.list {
                None => *value = values.scalar(property.ty)?,
                Some(length) => values.skip_list(length, property.ty)?,
            }
        }
        let position = DVec3::new(row[x], row[y], row[z]);
        if !position.is_finite() {
            return Err(format!("vertex {i} is not finite: {position}"));
        }
        mesh.positions.push(position);
        if let Some([x, y, z]) = normal {
            let normal = DVec3::new(row[x], row[y], row[z]);
            if !normal.is_finite() {
                return Err(format!("the normal of vertex {i} is not finite: {normal}"));
            }
            mesh.normals.push(normal);
        }
        if let Some([u, v]) = uv {
            let uv = DVec2::new(row[u], row[v]);
            if !uv.is_finite() {
                return Err(format!("the (u, v) of vertex {i} is not finite: {uv}"));
            }
            mesh.uv.push(uv);
        }
    }
    Ok(())
}

fn faces(
    element: &Element,
    values: &mut Values<'_>,
    mesh: &mut PlyMesh,
    most: usize,
) -> Result<(), String> {
    let indices = |p: &Property| {
        ["vertex_indices", "vertex_index"].contains(&p.name.as_str()) && p.list.is_some()
    };
    if !element.properties.iter().any(indices) {
        return Err("faces have no list vertex_indices".to_owned());
    }
    for i in 0..element.count {
        for property in &element.properties {
            match property.list {
                Some(length) if indices(property) => {
                    let corners = values.length(length)?;
                    if corners < 3 {
                        return Err(format!("face {i} has {corners} corners"));
                    }
                    let first = values.index(property.ty)?;
                    let mut last = values.index(property.ty)?;
                    if corners == 4 {
                        let third = values.index(property.ty)?;
                        let fourth = values.index(property.ty)?;
                        mesh.quads.push([first, last, third, fourth]);
                    } else {
                        for _ in 2..corners {
                            let next = values.index(property.ty)?;
                            mesh.triangles.push([first, last, next]);
                            last = next;
                            if mesh.triangles.len() > most {
                                break;
                            }
                        }
                    }
                    if mesh.triangles.len() + 2 * mesh.quads.len() > most {
                        return Err("the mesh exceeds the memory limit".to_owned());
                    }
                }
                Some(length) => values.skip_list(length, property.ty)?,
                None => values.scalar(property.ty).map(|_| ())?,
            }
        }
    }
    Ok(())
}

fn skip(element: &Element, values: &mut Values<'_>) -> Result<(), String> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            match property.list {
                None => values.scalar(property.ty).map(|_| ())?,
                Some(length) => values.skip_list(length, property.ty)?,
            }
        }
    }
    Ok(())
}

/// The body, taken value by value.
struct Values<'a> {
    encoding: Encoding,
    rest: &'a [u8],
}

impl Values<'_> {
    fn scalar(&mut self, ty: Scalar) -> Result<f64, String> {
        if self.encoding == Encoding::Ascii {
            return self.word();
        }
        Ok(match ty {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes in little-endian order.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let (bytes, rest) = self
            .rest
            .split_first_chunk::<N>()
            .ok_or("the file ends too early")?;
        self.rest = rest;
        let mut bytes = *bytes;
        if self.encoding == Encoding::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn word(&mut self) -> Result<f64, String> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace());
        let rest = &self.rest[start.ok_or("the file ends too early")?..];
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let (word, rest) = rest.split_at(end.unwrap_or(rest.len()));
        self.rest = rest;
        let text = std::str::from_utf8(word).map_err(|_| "a value is not text")?;
        let shown: String = text.chars().take(40).collect();
        text.parse()
            .map_err(|_| format!("expected a number, found {shown:?}"))
    }

    fn length(&mut self, ty: Scalar) -> Result<u32, String> {
        let length = self.scalar(ty)?;
        if length < 0.0 || length > f64::from(u32::MAX) || length.fract() != 0.0 {
            return Err(format!("a list has {length} entries"));
        }
        Ok(length as u32)
    }

    fn index(&mut self, ty: Scalar) -> Result<u32, String> {
        let index = self.scalar(ty)?;
        if !(0.0..=f64::from(u32::MAX)).contains(&index) || index.fract() != 0.0 {
            return Err(format!("{index} is no index of a vertex"));
        }
        Ok(index as u32)
    }

    fn skip_list(&mut self, length: Scalar, ty: Scalar) -> Result<(), String> {
        for _ in 0..self.length(length)? {
            self.scalar(ty)?;
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "ply_tests.rs"]
mod tests;
