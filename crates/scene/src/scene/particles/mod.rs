//! Spheres from particle files: radii, colors, selections, and copies of the periodic cell.
//!
//! The package `spherule-particles` reads files into a [`ParticleFrame`]; here it becomes [`Particles`],
//! whose spheres have radii and colors.

mod arrows;
mod boundary;
mod contents;
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

pub use arrows::{ArrowCentering, ArrowSizes, Arrows, VectorColumns};
pub use boundary::{Boundary, Outside};
pub use contents::{AddedBodies, FirstFrame, Particles};
pub use first_frame::TrajectoryReader;
pub use model::Model;
pub use orientation::{Orientation, UpReason};
pub use periodic::PeriodicError;
pub use polyhedra::{Coordination, Polyhedra};
pub use radii::accept_radii_expression;
pub use select::{Fault, MoleculeCensus, Selection};
pub use spheres::{of_frame, of_frame_in};
pub use spherule_particles::{
    AlignBy, BondRules, BondSource, Bonds, Cell, Codes, Columns, Element, Format, FrameChoice,
    FrameCount, Frames, Kind, Kinds, LengthUnit, NumberColumn, OpenFile, ParticleFrame, Radii,
    ReadOptions, ReadProgress, Role, Shapes, SharedNames, TextColumn, Trails, count_frames,
    read_frame, read_frame_after,
};
pub use style::{
    Applied, ArrowStyle, Category, ColorEnd, ColorEnds, Coloring, ColumnColors, ColumnSummary,
    ColumnValues, ElementColors, GHOST, Legend, NumberColors, Opacity, PROPERTIES, ParticleStyle,
    Properties, SelectedStyle, SharedColors, TypeMaterial, TypeStyle,
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

#[cfg(test)]
mod tests;
