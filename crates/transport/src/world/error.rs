//! Reasons why a scene cannot be rendered.

use crate::memory::Shortage;
use crate::settings::InvalidSetting;
use crate::spheres::Spheres;

/// Reasons why a scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// Rows are 32-bit numbers, a few of which are reserved.
    #[error("too many spheres: {0}, but at most {max} fit; render a part of them", max = Spheres::MAX)]
    TooManySpheres(usize),
    /// Not enough memory for the columns and the construction of the tree.
    #[error("{0} spheres need {1}; render fewer of them")]
    Memory(usize, Shortage),
    /// Not enough memory for the light distribution of an environment map.
    #[error("the environment's picture needs {0}; use a smaller one")]
    Environment(Shortage),
    /// A glass sphere is cut; caps are opaque.
    #[error(
        "a slice cuts sphere {0}, which is of glass, but flat caps are opaque; use the mode remove or hide, or another material"
    )]
    Glass(u32),
    /// A fitted camera without spheres.
    #[error(
        "the camera has nothing to frame: the scene has no spheres, or slices cut all of them away; give it spheres, or give the camera `eye` and `target`"
    )]
    NothingToFit,
    /// The camera is closer to its target than double precision resolves, or similar.
    #[error("the camera at {eye:?} sees nothing: {why}")]
    Camera {
        /// Position in the scene's coordinates.
        eye: [f64; 3],
        /// The reason, and how to fix it.
        why: &'static str,
    },
    /// A setting is out of range.
    #[error(transparent)]
    Setting(#[from] InvalidSetting),
    /// A row of a column is invalid; scenes from files are checked before.
    #[error("{0}")]
    Invalid(String),
}
