//! Named values of files and grids: a name, a type's name, a size, bytes.

use super::VdbError;
use super::bytes::{Budget, Cursor};
use std::collections::BTreeMap;
use std::fmt;

/// Metadata by name.
pub type Metadata = BTreeMap<String, MetaEntry>;

/// One metadata entry.
#[derive(Debug, Clone, PartialEq)]
pub struct MetaEntry {
    /// OpenVDB's name of the type, for instance `vec3i`.
    pub type_name: String,
    /// The value.
    pub value: MetaValue,
}

/// The value of a metadata entry.
#[derive(Debug, Clone, PartialEq)]
pub enum MetaValue {
    /// `bool`.
    Bool(bool),
    /// `string`.
    Text(String),
    /// `int32`, `int64` and their vectors.
    Integers(Vec<i64>),
    /// `float`, `double`, their vectors, quaternions and matrices (row by row).
    Reals(Vec<f64>),
    /// A type this reader does not know; only its size \[bytes\] is kept.
    Unknown(u32),
}

impl fmt::Display for MetaValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fn list<T: fmt::Display>(f: &mut fmt::Formatter<'_>, values: &[T]) -> fmt::Result {
            if let [single] = values {
                return write!(f, "{single}");
            }
            f.write_str("[")?;
            for (n, value) in values.iter().enumerate() {
                let comma = if n == 0 { "" } else { ", " };
                write!(f, "{comma}{value}")?;
            }
            f.write_str("]")
        }
        match self {
            Self::Bool(value) => write!(f, "{value}"),
            Self::Text(value) => f.write_str(value),
            Self::Integers(values) => list(f, values),
            Self::Reals(values) => list(f, values),
            Self::Unknown(size) => write!(f, "({size} bytes)"),
        }
    }
}

#[derive(Clone, Copy)]
enum Scalar {
    I32,
    I64,
    F32,
    F64,
}

/// Scalar type and count of a fixed-size type.
fn layout(type_name: &str) -> Option<(Scalar, usize)> {
    Some(match type_name {
        "int32" => (Scalar::I32, 1),
        "int64" => (Scalar::I64, 1),
        "float" => (Scalar::F32, 1),
        "double" => (Scalar::F64, 1),
        "vec2i" => (Scalar::I32, 2),
        "vec2s" => (Scalar::F32, 2),
        "vec2d" => (Scalar::F64, 2),
        "vec3i" => (Scalar::I32, 3),
        "vec3s" => (Scalar::F32, 3),
        "vec3d" => (Scalar::F64, 3),
        "vec4i" => (Scalar::I32, 4),
        "vec4s" | "quats" => (Scalar::F32, 4),
        "vec4d" | "quatd" => (Scalar::F64, 4),
        "mat3s" => (Scalar::F32, 9),
        "mat3d" => (Scalar::F64, 9),
        "mat4s" => (Scalar::F32, 16),
        "mat4d" => (Scalar::F64, 16),
        _ => return None,
    })
}

fn value(cursor: &mut Cursor<'_>, type_name: &str, size: u32) -> Result<MetaValue, VdbError> {
    const WHAT: &str = "a metadata value";
    let expect = |cursor: &Cursor<'_>, bytes: usize| {
        if size as usize == bytes {
            return Ok(());
        }
        Err(cursor.damaged(format!(
            "metadata of type `{type_name}` takes {size} bytes instead of {bytes}"
        )))
    };
    match type_name {
        "bool" => {
            expect(cursor, 1)?;
            return Ok(MetaValue::Bool(cursor.u8(WHAT)? != 0));
        }
        "string" => {
            let bytes = cursor.take(size as usize, WHAT)?;
            return Ok(MetaValue::Text(String::from_utf8_lossy(bytes).into_owned()));
        }
        _ => {}
    }
    let Some((scalar, count)) = layout(type_name) else {
        cursor.take(size as usize, WHAT)?;
        return Ok(MetaValue::Unknown(size));
    };
    let width = match scalar {
        Scalar::I32 | Scalar::F32 => 4,
        Scalar::I64 | Scalar::F64 => 8,
    };
    expect(cursor, count * width)?;
    let mut integers = Vec::new();
    let mut reals = Vec::new();
    for _ in 0..count {
        match scalar {
            Scalar::I32 => integers.push(i64::from(cursor.i32(WHAT)?)),
            Scalar::I64 => integers.push(cursor.i64(WHAT)?),
            Scalar::F32 => reals.push(f64::from(f32::from_le_bytes(cursor.array(WHAT)?))),
            Scalar::F64 => reals.push(cursor.f64(WHAT)?),
        }
    }
    Ok(if integers.is_empty() {
        MetaValue::Reals(reals)
    } else {
        MetaValue::Integers(integers)
    })
}

/// Reads a metadata block: a count, then that many entries.
pub(super) fn read(cursor: &mut Cursor<'_>, budget: &mut Budget) -> Result<Metadata, VdbError> {
    let count = cursor.u32("the metadata count")?;
    // Name, type and size take at least twelve bytes: a lying count ends here, not after a walk through the file.
    cursor.need(u64::from(count) * 12, "the metadata")?;
    let mut metadata = Metadata::new();
    for _ in 0..count {
        let start = cursor.offset();
        let name = cursor.string("a metadata name")?;
        if name.is_empty() {
            return Err(cursor.damaged("a metadata entry has an empty name"));
        }
        let type_name = cursor.string("a metadata type")?;
        let size = cursor.u32("a metadata size")?;
        let value = value(cursor, &type_name, size)?;
        // Text may double when made UTF-8, numbers when widened; the rest is the map's overhead.
        budget.charge(3 * (cursor.offset() - start) + 256, "metadata")?;
        metadata.insert(name, MetaEntry { type_name, value });
    }
    Ok(metadata)
}
