mod columns;
mod crystals;
mod frames;
mod gsd;
mod lammps;
mod molecules;
mod numpy;
mod packings;
mod ply;
mod text;
mod undrawn;
mod xyz;

use super::*;
use glam::DVec3;

/// Reads a file with this content.
fn read_with(content: impl AsRef<[u8]>, options: &ReadOptions) -> Result<Particles, FileError> {
    in_file(content, |path| read(path, options))
}

fn in_file<T>(content: impl AsRef<[u8]>, look: impl FnOnce(&Path) -> T) -> T {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("particles");
    std::fs::write(&path, content).expect("a file");
    look(&path)
}

fn particles(content: impl AsRef<[u8]>) -> Particles {
    read_with(content, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Line, column and message of what is wrong with a content.
fn fault(content: impl AsRef<[u8]>) -> (usize, usize, String) {
    match read_with(content, &ReadOptions::default()) {
        Err(error) => (error.line().unwrap_or(0), error.column().unwrap_or(0), error.message),
        Ok(read) => panic!("this is accepted: {read:?}"),
    }
}

/// The frame that the options choose of a file with this content.
fn frame_with(
    content: impl AsRef<[u8]>,
    options: &ReadOptions,
) -> Result<ParticleFrame, FileError> {
    in_file(content, |path| read_frame(path, options))
}

fn frame(content: impl AsRef<[u8]>) -> ParticleFrame {
    frame_with(content, &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The options with columns as a command line has them.
fn columns(columns: &str) -> ReadOptions {
    let columns = columns.parse().expect("columns");
    ReadOptions { columns, ..ReadOptions::default() }
}

fn at_frame(frame: &str) -> ReadOptions {
    ReadOptions { frame: frame.parse().expect("a frame"), ..ReadOptions::default() }
}

/// All x of all frames.
fn frames(content: impl AsRef<[u8]>) -> Vec<Vec<f64>> {
    in_file(content, |path| {
        let frames = Frames::open(path, &ReadOptions::default()).expect("frames");
        frames.map(|frame| frame.expect("a frame").x).collect()
    })
}

/// Names of the kinds of all rows, with the symbols of their elements.
fn kinds(frame: &ParticleFrame) -> Vec<(&str, &str)> {
    let kind = |row| frame.kinds.kind(row).expect("a kind");
    let symbol = |kind: &Kind| kind.element.map_or("-", Element::symbol);
    (0..frame.len()).map(|row| (kind(row).name.as_str(), symbol(kind(row)))).collect()
}
