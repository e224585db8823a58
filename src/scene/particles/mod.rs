//! Readers for files of particles.
//!
//! ```text
//! file or standard input -> unpacked, by how it begins                  source
//!    -> format, by how the content begins                               sniff
//!    -> lines -> fields -> roles, by the names of columns               lines, fields, schema
//!    -> ParticleFrame, frame by frame, in columns, in the file's units  one file per format
//!    -> Particles: spheres with radii and colors, nothing else          spheres
//! ```
//!
//! Every reader streams: it keeps columns, never the file, and believes no count that the file
//! claims. Rows whose numbers are not finite, or whose radius is not more than 0, are dropped and
//! counted in a warning; anything that is no number at all is an error with its line. A further
//! format is a [`Format`], a sign to tell it by in `sniff`, and a `FrameReader`.

mod aliases;
mod alternates;
mod builder;
mod categories;
mod cif;
mod csv;
mod element;
mod extra;
mod fields;
mod foreign;
mod frame;
mod gro;
mod gsd;
mod header;
mod lammps;
mod line;
mod lines;
mod looks;
mod naming;
mod number;
mod numpy;
mod options;
mod pdb;
mod periodic;
mod ply;
mod progress;
mod radii;
mod reader;
mod scalar;
mod schema;
mod select;
mod shared_names;
mod sniff;
mod source;
mod spheres;
mod text;
mod undrawn;
mod units;
mod utf16;
mod xyz;

pub use categories::{Codes, Kind, Kinds, TextColumn};
pub use element::Element;
pub use frame::{Cell, LengthUnit, NumberColumn, ParticleFrame};
pub use looks::{Coloring, ColumnColors, ElementColors, Legend, Looks, TypeLook, TypeMaterial};
pub use options::{Columns, Format, FrameChoice, Radii, ReadOptions, Role};
pub use periodic::PeriodicError;
pub use progress::ReadProgress;
pub use reader::{FrameCount, Frames, count_frames, read_frame};
pub use select::{Fault, Selection};
pub use shared_names::SharedNames;
pub use spheres::Particles;
pub(super) use spheres::listed;

use super::SceneError;
use std::path::Path;

/// Reads the spheres of the frame that the options choose, of a file or, for the path `-`, of
/// standard input.
///
/// # Errors
///
/// The file cannot be read, is cut off, or holds something that is not a particle.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Particles, SceneError> {
    of_frame(path, read_frame(path, options)?, options)
}

/// Makes spheres of a frame that was read from `path`; whatever frame the options choose.
///
/// # Errors
///
/// It holds no particles, or the radii that are asked for are not there.
pub fn of_frame(
    path: &Path,
    frame: ParticleFrame,
    options: &ReadOptions,
) -> Result<Particles, SceneError> {
    spheres::spheres(path, frame, options)
}

#[cfg(test)]
mod tests;
