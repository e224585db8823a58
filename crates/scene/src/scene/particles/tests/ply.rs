//! Tests of PLY.

use super::*;
use crate::scene::linear_from_srgb;

const PROPERTIES: &str = "comment made by hand\nelement camera 1\nproperty uchar a\n\
                          property list uchar short b\nelement vertex 2\nproperty double x\n\
                          property float y\nproperty short z\nproperty uchar red\n\
                          property uchar green\nproperty uchar blue\nproperty float radius\n\
                          property int q\nelement face 1\nproperty list uchar int vertex_indices\n\
                          end_header\n";

fn header(format: &str) -> String {
    format!("ply\nformat {format} 1.0\n{PROPERTIES}")
}

/// The same file in binary; `order` reverses the bytes of a number, or keeps them.
fn binary(format: &str, order: fn(Vec<u8>) -> Vec<u8>) -> Vec<u8> {
    let mut bytes = header(format).into_bytes();
    bytes.extend([9, 2]);
    bytes.extend([1_i16, 2].map(|item| order(item.to_le_bytes().into())).concat());
    for (x, y, z, color, radius, q) in
        [(0.1_f64, 2.5_f32, -3_i16, [255, 0, 128], 0.5_f32, -7_i32), (1.0, 2.0, 3, [0; 3], 0.25, 8)]
    {
        bytes.extend(order(x.to_le_bytes().into()));
        bytes.extend(order(y.to_le_bytes().into()));
        bytes.extend(order(z.to_le_bytes().into()));
        bytes.extend(color);
        bytes.extend(order(radius.to_le_bytes().into()));
        bytes.extend(order(q.to_le_bytes().into()));
    }
    bytes
}

fn little() -> Vec<u8> {
    binary("binary_little_endian", |bytes| bytes)
}

#[test]
fn points_are_the_same_in_text_and_binary() {
    let text = format!(
        "{}9 2 1 2\n0.1 2.5 -3 255 0 128 0.5 -7\n1 2 3 0 0 0 .25 8\n3 0 0 1\n",
        header("ascii")
    );
    let big = binary("binary_big_endian", |bytes| bytes.into_iter().rev().collect());
    let windows = text.replace('\n', "\r\n").into_bytes();
    let old = text.replace('\n', "\r").into_bytes();
    let old_binary =
        little().into_iter().map(|byte| if byte == b'\n' { b'\r' } else { byte }).collect();
    for content in [text.into_bytes(), windows, old, little(), old_binary, big] {
        let frame = frame_with(content, &columns("q")).expect("a frame");
        assert_eq!(frame.position(0), DVec3::new(0.1, 2.5, -3.0));
        assert_eq!(
            (&frame.radius[..], &frame.numbers[0].values[..]),
            (&[0.5, 0.25][..], &[-7.0, 8.0][..])
        );
        let gray = linear_from_srgb(128.0 / 255.0);
        assert_eq!(frame.color[0].to_array(), [1.0, 0.0, gray]);
        assert_eq!(frame.title, "made by hand");
    }
}

#[test]
fn lists_of_vertices_are_passed_over() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\nelement vertex 2\nproperty list uchar int view\nproperty float x\n\
             property float y\nproperty float z\nproperty list uchar short tags\nproperty uchar q\nend_header\n"
        )
    };
    let text = header("ascii") + "2 5 6 1 2 3 0 7\n0 4 5 6 1 9 8\n";
    let mut binary = header("binary_little_endian").into_bytes();
    let place = |place: [f32; 3]| place.map(f32::to_le_bytes).concat();
    binary.extend([&[2, 5, 0, 0, 0, 6, 0, 0, 0][..], &place([1.0, 2.0, 3.0]), &[0, 7]].concat());
    binary.extend([&[0][..], &place([4.0, 5.0, 6.0]), &[1, 9, 0, 8]].concat());
    for content in [text.clone().into_bytes(), binary.clone()] {
        let frame = frame_with(content, &columns("q")).expect("a frame");
        assert_eq!((&frame.x[..], &frame.z[..]), (&[1.0, 4.0][..], &[3.0, 6.0][..]));
        assert_eq!(frame.numbers[0].values, [7.0, 8.0]);
        assert_eq!(frame.columns, ["x", "y", "z", "q"]);
    }
    assert_eq!(fault(&binary[..binary.len() - 1]).2, "ends before its last vertex");
    assert_eq!(fault(text.replace("0 4 5 6 1 9 8", "0 4 5")).2, "a vertex has 6 numbers");
}

#[test]
fn faulty_files_are_refused() {
    let text = |from: &str, to: &str| format!("{}1 2 3", header("ascii").replace(from, to));
    for (content, message) in [
        (text("end_header", "end"), "not a line of a PLY header"),
        ("ply\nformat ascii 1.0\n".to_owned(), "the header does not end: no line is `end_header`"),
        (text("vertex 2", "vertex many"), "`many` is not a whole number"),
        (text("property double x", "property complex x"), "an unknown type of numbers"),
        (text("element vertex 2", "element point 2"), "has no vertices"),
        (text("element camera 1\n", ""), "a property before any element"),
        (text("ascii", "base64"), "an unknown format"),
        (text("camera 1", "camera 0"), "a vertex has 8 numbers"),
        (header("ascii") + "1\n", "the file ends after 0 of 2 vertices"),
    ] {
        assert_eq!(fault(&content).2, message, "{content}");
    }
    let whole = little();
    assert_eq!(fault(&whole[..whole.len() - 1]).2, "ends before its last vertex");
    assert!(fault(text("double x", "double u")).2.starts_with("no column is named `x`"));
}

#[test]
fn absurd_claims_end_soon() {
    let empty = "ply\nformat binary_little_endian 1.0\nelement a 18446744073709551615\n\
                 element vertex 18446744073709551615\nproperty float x\nproperty float y\n\
                 property float z\nend_header\n";
    assert_eq!(fault(empty).2, "ends before its last vertex");
    let text = empty.replace("binary_little_endian", "ascii");
    assert_eq!(fault(text).2, "the file ends after 0 of 18446744073709551615 vertices");
}

#[test]
fn numbers_of_all_types_have_their_size() {
    let numbers: [([&str; 2], Vec<u8>, f64); 8] = [
        (["char", "int8"], (-3_i8).to_le_bytes().into(), -3.0),
        (["uchar", "uint8"], 200_u8.to_le_bytes().into(), 200.0),
        (["short", "int16"], (-300_i16).to_le_bytes().into(), -300.0),
        (["ushort", "uint16"], 60_000_u16.to_le_bytes().into(), 60_000.0),
        (["int", "int32"], (-70_000_i32).to_le_bytes().into(), -70_000.0),
        (["uint", "uint32"], 4_000_000_000_u32.to_le_bytes().into(), 4e9),
        (["float", "float32"], 1.5_f32.to_le_bytes().into(), 1.5),
        (["double", "float64"], 0.1_f64.to_le_bytes().into(), 0.1),
    ];
    for (names, bytes, value) in numbers {
        for name in names {
            let header = format!(
                "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty {name} q\n\
                 property uchar x\nproperty uchar y\nproperty uchar z\nend_header\n"
            );
            let rows = [&bytes[..], &[1, 2, 3], &bytes, &[4, 5, 6]].concat();
            let frame = frame_with([header.into_bytes(), rows].concat(), &columns("q"));
            let frame = frame.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(frame.numbers[0].values, [value; 2], "{name}");
            assert_eq!(frame.z, [3.0, 6.0], "{name}");
        }
    }
}
