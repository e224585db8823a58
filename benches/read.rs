//! Readers of particle files on one thread, in bytes per second: `cargo bench --bench read`. Files of a
//! million particles each are written to a temporary folder first.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use spherule_render::scene::particles::{Format, ReadOptions, read_frame};
use std::fs::File;
use std::hint::black_box;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Particles in each file, which has 35 to 80 MB.
const COUNT: u64 = 1_000_000;

/// Returns a pseudorandom coordinate of a particle, 0 to 100.
fn coordinate(seed: u64) -> f64 {
    let mixed = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (mixed >> 11) as f64 / (1_u64 << 53) as f64 * 100.0
}

/// Writes a file of a format.
fn write(path: &Path, format: Format) -> std::io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    match format {
        Format::LammpsDump => write!(
            file,
            "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{COUNT}\nITEM: BOX BOUNDS pp pp pp\n\
             0 100\n0 100\n0 100\nITEM: ATOMS id type x y z\n"
        )?,
        Format::Gro => write!(file, "title\n{COUNT}\n")?,
        Format::Xyz => write!(file, "{COUNT}\ncomment\n")?,
        Format::Csv => writeln!(file, "type,x,y,z")?,
        _ => (),
    }
    for row in 0..COUNT {
        let [x, y, z] = [3 * row, 3 * row + 1, 3 * row + 2].map(coordinate);
        let name = ["OW", "HW1", "HW2"][row as usize % 3];
        let (symbol, number) = (&name[..1], row % 100_000);
        match format {
            Format::LammpsDump => writeln!(file, "{row} {} {x:.6} {y:.6} {z:.6}", row % 3 + 1)?,
            Format::Gro => {
                writeln!(file, "{number:>5}SOL  {name:>5}{number:>5}{x:>8.3}{y:>8.3}{z:>8.3}")?;
            }
            Format::Pdb => writeln!(
                file,
                "ATOM  {number:>5} {name:>4} SOL A{:>4}    {x:>8.3}{y:>8.3}{z:>8.3}  1.00  0.00\
                 {symbol:>12}",
                row % 10_000
            )?,
            Format::Csv => writeln!(file, "{symbol},{x:.8},{y:.8},{z:.8}")?,
            _ => writeln!(file, "{symbol} {x:.8} {y:.8} {z:.8}")?,
        }
    }
    if format == Format::Gro {
        writeln!(file, "100 100 100")?;
    }
    file.flush()
}

fn read(criterion: &mut Criterion) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut group = criterion.benchmark_group("read");
    group.sample_size(10);
    for format in [Format::Csv, Format::Xyz, Format::LammpsDump, Format::Gro, Format::Pdb] {
        let path = folder.path().join(format.name());
        write(&path, format).expect("a file");
        let bytes = path.metadata().expect("a file").len();
        group.throughput(Throughput::Bytes(bytes));
        group.bench_with_input(BenchmarkId::from_parameter(format.name()), &path, |bench, path| {
            bench.iter(|| {
                let frame = read_frame(black_box(path), &ReadOptions::default()).expect("a frame");
                assert_eq!(frame.len() as u64, COUNT);
                frame
            });
        });
    }
    group.finish();
}

criterion_group!(benches, read);
criterion_main!(benches);
