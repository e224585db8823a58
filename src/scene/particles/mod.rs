//! Spheres from particle files: radii, colors, selections, and copies of the periodic cell.
//!
//! The package `spherule-particles` reads files into a [`ParticleFrame`]; here it becomes [`Particles`],
//! whose spheres have radii and colors.

mod looks;
mod periodic;
mod radii;
mod select;
mod spheres;

pub use looks::{Coloring, ColumnColors, ElementColors, Legend, Looks, TypeLook, TypeMaterial};
pub use periodic::PeriodicError;
pub use select::{Fault, Selection};
pub use spheres::Particles;
pub use spherule_particles::{
    Cell, Codes, Columns, Element, Format, FrameChoice, FrameCount, Frames, Kind, Kinds,
    LengthUnit, NumberColumn, ParticleFrame, Radii, ReadOptions, ReadProgress, Role, SharedNames,
    TextColumn, count_frames, read_frame,
};

use super::FileError;
use std::path::Path;

/// Reads the spheres of the frame that the options choose, of a file or, for the path `-`, of
/// standard input.
///
/// # Errors
///
/// The file cannot be read, is cut off, or holds something that is not a particle.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Particles, FileError> {
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
) -> Result<Particles, FileError> {
    spheres::spheres(path, frame, options)
}

#[cfg(test)]
mod tests;
