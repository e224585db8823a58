//! Tests of arrays in containers: frames in NPZ, structures of arrays, half-precision numbers.

use crate::common::{File, file};
use spherule_particles::{
    Columns, FrameChoice, Frames, ParticleFrame, ReadOptions, count_frames, read_frame,
};
use std::io::{Cursor, Write};
use zip::CompressionMethod;
use zip::write::SimpleFileOptions;

/// An array of this type and shape.
fn array(kind: &str, shape: &str, bytes: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {kind}, 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), bytes].concat()
}

fn doubles(values: impl IntoIterator<Item = f64>) -> Vec<u8> {
    values.into_iter().flat_map(f64::to_le_bytes).collect()
}

fn counted(count: u32) -> Vec<u8> {
    doubles((0..count).map(f64::from))
}

fn archive(arrays: &[(&str, Vec<u8>)], method: CompressionMethod) -> File {
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in arrays {
        let options = SimpleFileOptions::default().compression_method(method);
        writer.start_file(format!("{name}.npy"), options).expect("a file");
        writer.write_all(bytes).expect("bytes");
    }
    file(writer.finish().expect("an archive").get_ref())
}

fn all_columns() -> ReadOptions {
    ReadOptions {
        columns: Columns { rest: Some(1000), ..Columns::default() },
        ..ReadOptions::default()
    }
}

#[test]
fn archives_have_frames() {
    let arrays = [
        ("position", array("'<f8'", "(3, 2, 3)", &counted(18))),
        ("radius", array("'<f8'", "(2,)", &doubles([1.0, 2.0]))),
        ("q", array("'<f8'", "(3, 2)", &counted(6))),
        ("velocity", array("'<f8'", "(3, 2, 3)", &counted(18))),
        ("box", array("'<f8'", "(3, 6)", &doubles([5.0, 6.0, 7.0, 0.0, 0.0, 0.0].repeat(3)))),
        ("species", array("'<U2'", "(2,)", b"N\0\0\0a\0\0\0C\0\0\0l\0\0\0")),
    ];
    for method in [CompressionMethod::Stored, CompressionMethod::Deflated] {
        let file = archive(&arrays, method);
        assert_eq!(count_frames(&file.path, &ReadOptions::default()).expect("frames"), 3);
        let frames = Frames::open(&file.path, &all_columns()).expect("frames");
        let frames: Vec<ParticleFrame> = frames.collect::<Result<_, _>>().expect("frames");
        assert_eq!(frames.len(), 3);
        for (at, frame) in (0_u32..).zip(&frames) {
            let first = f64::from(6 * at);
            assert_eq!(
                (&frame.x[..], &frame.z[..]),
                (&[first, first + 3.0][..], &[first + 2.0, first + 5.0][..])
            );
            assert_eq!(frame.radius, [1.0, 2.0]);
            let column = |name: &str| {
                let found = frame.numbers.iter().find(|column| column.name == name);
                &found.unwrap_or_else(|| panic!("no {name}")).values[..]
            };
            assert_eq!(column("q"), [f64::from(2 * at), f64::from(2 * at + 1)]);
            assert_eq!(column("velocity_y"), [first + 1.0, first + 4.0]);
            assert_eq!(frame.cell.map(|cell| cell.vectors[1].y), Some(6.0));
            assert_eq!(frame.kinds.table.len(), 2);
            assert!(frame.warnings.is_empty(), "{:?}", frame.warnings);
        }
        let last = ReadOptions { frame: FrameChoice::Index(2), ..ReadOptions::default() };
        assert_eq!(read_frame(&file.path, &last).expect("a frame").x, [12.0, 15.0]);
    }
}

#[test]
fn structures_have_arrays_and_half_precision_numbers() {
    let kind = "[('pos', '<f2', (3,)), ('', '|V2'), ('radius', '>f2'), ('q', '<f8', (2,))]";
    let half = |value: u16| value.to_le_bytes();
    let row = |x: u16, q: f64| {
        [
            &[half(x), half(0x4000), half(0xC200), half(0)].concat()[..],
            &[0x38, 0],
            &doubles([q, 1.0]),
        ]
        .concat()
    };
    let file = file(array(kind, "(2,)", &[row(0x3C00, 5.0), row(0x3555, 6.0)].concat()));
    let frame = read_frame(&file.path, &all_columns()).expect("a frame");
    assert_eq!(frame.x, [1.0, 1365.0 / 4096.0]);
    assert_eq!((frame.y[1], frame.z[1], &frame.radius[..]), (2.0, -3.0, &[0.5, 0.5][..]));
    let names: Vec<&str> = frame.numbers.iter().map(|column| column.name.as_str()).collect();
    assert_eq!((names, &frame.numbers[0].values[..]), (vec!["q_1", "q_2"], &[5.0, 6.0][..]));
}
