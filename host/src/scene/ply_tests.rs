//! Unit tests of the PLY reader.

use super::*;

const HEADER: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

fn ascii() -> Vec<u8> {
    let body = "0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3\n";
    format!("ply\nformat ascii 1.0\ncomment x\n{HEADER}{body}").into_bytes()
}

fn binary(big: bool) -> Vec<u8> {
    let name = if big { "big" } else { "little" };
    let mut file = format!("ply\r\nformat binary_{name}_endian 1.0\n{HEADER}").into_bytes();
    let put = |bytes: [u8; 4]| {
        let mut bytes = bytes;
        if big {
            bytes.reverse();
        }
        bytes
    };
    for p in [
        [0.0_f32, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ] {
        p.iter().for_each(|c| file.extend(put(c.to_le_bytes())));
        file.push(9);
    }
    file.push(4);
    (0..4_i32).for_each(|i| file.extend(put(i.to_le_bytes())));
    file
}

#[test]
fn three_encodings_are_one_mesh() {
    let mesh = read(&ascii(), 1 << 20).expect("ascii");
    assert_eq!(mesh.quads, [[0, 1, 2, 3]]);
    assert!(mesh.triangles.is_empty() && mesh.normals.is_empty() && mesh.uv.is_empty());
    assert_eq!(mesh.positions[2], DVec3::new(1.0, 1.0, 0.0));
    assert_eq!(read(&binary(false), 1 << 20).expect("little"), mesh);
    assert_eq!(read(&binary(true), 1 << 20).expect("big"), mesh);
}

#[test]
fn vertices_may_have_normals_and_parameters() {
    for (u, v) in [("u", "v"), ("s", "t"), ("texture_u", "texture_v")] {
        let file = format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float {u}\n\
             property float y\nproperty float nx\nproperty float ny\nproperty float nz\n\
             property float z\nproperty float {v}\nelement face 2\n\
             property list uchar int vertex_index\nend_header\n\
             0 .5 0 0 0 1 0 .25\n1 1 0 0 0 2 0 0\n1 0 1 0 1 0 0 0\n0 0 1 0 0 1 0 0\n\
             0 0 2 0 0 1 0 0\n3 0 1 2\n5 0 1 2 3 4\n"
        );
        let mesh = read(file.as_bytes(), 1 << 20).expect("mesh");
        assert_eq!(mesh.triangles.len(), 4, "a triangle and a fan of three");
        assert_eq!(mesh.triangles[3], [0, 3, 4]);
        assert_eq!(mesh.uv[0], DVec2::new(0.5, 0.25));
        assert_eq!(mesh.normals[2], DVec3::Y);
        assert_eq!((mesh.uv.len(), mesh.normals.len()), (5, 5));
        assert!(read(file.replace(" .25", " nan").as_bytes(), 1 << 20).is_err());
        assert!(read(file.replace("0 0 2 0 0", "0 0 inf 0 0").as_bytes(), 1 << 20).is_err());
    }
}

#[test]
fn every_cut_is_an_error() {
    for file in [binary(false), binary(true)] {
        for length in 0..file.len() {
            assert!(read(&file[..length], 1 << 20).is_err(), "{length}");
        }
    }
}

#[test]
fn lies_about_sizes_are_errors() {
    let text = String::from_utf8(ascii()).expect("text");
    for (from, to) in [
        ("vertex 4", "vertex 400000000000"),
        ("face 1", "face 2"),
        ("\n4 0 1 2 3", "\n4000000000 0 1 2 3"),
        ("\n4 0 1 2 3", "\n2 0 1"),
        ("\n4 0 1 2 3", "\n3 0 1 4"),
        ("\n4 0 1 2 3", "\n3 0 1 -1"),
        ("1 1 0 9", "1 nan 0 9"),
        ("float x", "list float float x"),
    ] {
        let changed = text.replace(from, to);
        assert_ne!(changed, text);
        assert!(read(changed.as_bytes(), 1 << 20).is_err(), "{to}");
    }
    assert!(read(&ascii(), 12).is_err(), "memory limit");
}
