//! Spheres from particle files: radii, colors, selections, and copies of the periodic cell.
//!
//! The package `spherule-particles` reads files into a [`ParticleFrame`]; here it becomes [`Particles`],
//! whose spheres have radii and colors.

mod ellipsoids;
mod model;
mod orientation;
mod periodic;
mod radii;
mod select;
mod spheres;
mod style;

pub use model::Model;
pub use orientation::{Orientation, UpReason};
pub use periodic::PeriodicError;
pub use select::{Fault, Selection};
pub use spheres::Particles;
pub use spherule_particles::{
    AlignBy, BondRules, BondSource, Bonds, Cell, Codes, Columns, Element, Format, FrameChoice,
    FrameCount, Frames, Kind, Kinds, LengthUnit, NumberColumn, ParticleFrame, Radii, ReadOptions,
    ReadProgress, Role, Shapes, SharedNames, TextColumn, Trails, count_frames, read_frame,
};
pub use style::{
    ArrowCentering, ArrowSizes, ArrowStyle, Arrows, Category, Coloring, ColumnColors,
    ElementColors, GHOST, Legend, Opacity, ParticleStyle, TypeMaterial, TypeStyle, VectorColumns,
};

use super::FileError;
use std::path::Path;

/// Reads the spheres of one frame, chosen by the options, of a file, or of standard input if the path
/// is `-`.
///
/// # Errors
///
/// The file cannot be read, is cut off, or holds something that is not a particle.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Particles, FileError> {
    of_frame(path, read_frame(path, options)?, options)
}

/// Converts a frame that was read from `path` to spheres, ignoring the options' choice of a frame.
///
/// # Errors
///
/// It holds no particles, or lacks the radii that are asked for.
pub fn of_frame(
    path: &Path,
    frame: ParticleFrame,
    options: &ReadOptions,
) -> Result<Particles, FileError> {
    spheres::spheres(path, frame, options)
}

#[cfg(test)]
mod tests;
