//! Spheres from particle files: radii, colors, selections, and copies of the periodic cell.
//!
//! The package `spherule-particles` reads files into a [`ParticleFrame`]; here it becomes [`Particles`],
//! whose spheres have radii and colors.

mod boundary;
mod ellipsoids;
mod first_frame;
mod model;
mod orientation;
mod periodic;
mod polyhedra;
mod radii;
mod select;
mod spheres;
mod style;

pub use boundary::{AddedBodies, Boundary, Outside};
pub use first_frame::{FirstFrame, TrajectoryReader};
pub use model::Model;
pub use orientation::{Orientation, UpReason};
pub use periodic::PeriodicError;
pub use polyhedra::{Coordination, Polyhedra};
pub use radii::accept_radii_expression;
pub use select::{Fault, MoleculeCensus, Selection};
pub use spheres::Particles;
pub use spherule_particles::{
    AlignBy, BondRules, BondSource, Bonds, Cell, Codes, Columns, Element, Format, FrameChoice,
    FrameCount, Frames, Kind, Kinds, LengthUnit, NumberColumn, OpenFile, ParticleFrame, Radii,
    ReadOptions, ReadProgress, Role, Shapes, SharedNames, TextColumn, Trails, count_frames,
    read_frame, read_frame_after,
};
pub use style::{
    Applied, ArrowCentering, ArrowSizes, ArrowStyle, Arrows, Category, ColorEnd, ColorEnds,
    Coloring, ColumnColors, ColumnSummary, ColumnValues, ElementColors, GHOST, Legend,
    NumberColors, Opacity, PROPERTIES, ParticleStyle, Properties, SelectedStyle, SharedColors,
    TypeMaterial, TypeStyle, VectorColumns,
};

use super::FileError;
use std::path::Path;

/// Reads the spheres of one frame, chosen by the options, of a file, or of standard input if the path
/// is `-`. What is guessed of a file with several frames is that of the first one: see [`FirstFrame`].
///
/// # Errors
///
/// The file cannot be read, is cut off, or holds something that is not a particle.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Particles, FileError> {
    TrajectoryReader::default().read(path, options, None)
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
    of_frame_in(path, frame, options, None)
}

/// Converts a frame to spheres as [`of_frame`], with the choices by the first frame, if there are several.
///
/// # Errors
///
/// The same.
pub fn of_frame_in(
    path: &Path,
    frame: ParticleFrame,
    options: &ReadOptions,
    first_frame: Option<FirstFrame>,
) -> Result<Particles, FileError> {
    spheres::spheres(path, frame, options, first_frame)
}

#[cfg(test)]
mod tests;
