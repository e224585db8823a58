//! Tests of compressed files.

use super::*;
use bzip2::write::BzEncoder;
use flate2::write::GzEncoder;
use std::io::Write;

/// `# x y z r`, `1 2 3 4` and `5.5 6 7 8`, compressed by the usual programs; with zstd in two frames.
const PACKED: [(&str, &[u8]); 4] = [
    ("gzip", include_bytes!("../../../../../../tests/data/rows.txt.gz")),
    ("bzip2", include_bytes!("../../../../../../tests/data/rows.txt.bz2")),
    ("xz", include_bytes!("../../../../../../tests/data/rows.txt.xz")),
    ("zstd", include_bytes!("../../../../../../tests/data/rows.txt.zst")),
];

fn gzip(content: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(content).expect("memory");
    encoder.finish().expect("memory")
}

fn bzip2(content: &[u8]) -> Vec<u8> {
    let mut encoder = BzEncoder::new(Vec::new(), bzip2::Compression::fast());
    encoder.write_all(content).expect("memory");
    encoder.finish().expect("memory")
}

fn zstd(content: &[u8]) -> Vec<u8> {
    ruzstd::encoding::compress_to_vec(content, ruzstd::encoding::CompressionLevel::Fastest)
}

#[test]
fn files_are_unpacked_whatever_their_names() {
    for (name, bytes) in PACKED {
        let read = particles(bytes);
        assert_eq!(read.spheres.x, [1.0, 5.5], "{name}");
        assert_eq!(read.spheres.radius, [4.0, 8.0], "{name}");
    }
}

#[test]
fn long_files_and_several_parts_are_unpacked() {
    let rows: Vec<String> = (0..40_000).map(|row| format!("{row}.5 {} 3\n", row * row)).collect();
    let text = rows.concat();
    let (first, second) = text.as_bytes().split_at(text.len() / 3);
    for pack in [gzip, bzip2, zstd] {
        let frame = frame([pack(first), pack(second)].concat());
        assert_eq!((frame.len(), frame.x[39_999]), (40_000, 39_999.5));
        assert_eq!(frame.y[39_999], 39_999.0 * 39_999.0);
    }
}

#[test]
fn binary_files_are_unpacked_too() {
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n\
               property float y\nproperty float z\nend_header\n";
    let numbers = [1.0_f32, 2.0, 3.0].map(f32::to_le_bytes).concat();
    assert_eq!(frame(gzip(&[ply.as_bytes(), &numbers].concat())).z, [3.0]);
    let gsd = gsd::example();
    assert_eq!(frame(zstd(&gsd)), frame(&gsd));
    // A compressed file may be longer than its content.
    let mut stored = GzEncoder::new(Vec::new(), flate2::Compression::none());
    stored.write_all(&gsd).expect("memory");
    assert_eq!(frame(stored.finish().expect("memory")), frame(&gsd));
}

#[test]
fn files_that_are_cut_off_or_packed_twice_are_refused() {
    for (name, bytes) in PACKED {
        for length in [8, bytes.len() / 2, bytes.len() - 9] {
            let (_, _, message) = fault(&bytes[..length]);
            assert!(message.contains(name), "{name} {length}: {message}");
        }
    }
    let twice = fault(gzip(&bzip2(b"1 2 3\n"))).2;
    assert_eq!(twice, "is compressed twice (bzip2, then gzip)");
    let rows: Vec<String> = (0..100_000).map(|row| format!("{row} 2.5 3\n")).collect();
    let whole = gzip(rows.concat().as_bytes());
    let message = fault(&whole[..whole.len() / 2]).2;
    assert!(message.contains("cannot be read at line"), "{message}");
}
