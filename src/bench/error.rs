//! Why a measurement failed.

use crate::image::ImageError;
use crate::paper::Unsupported;
use crate::render::RenderError;
use crate::scene::FileError;
use crate::scene::generate::GenerateError;
use crate::suggest;
use crate::workload::WorkloadError;
use crate::world::WorldError;
use std::io;
use std::path::PathBuf;

/// Why a measurement failed.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// There is no scene of that name.
    #[error("there is no scene \"{name}\" to measure; {}", suggest::help(name, known.split(", "), "there are"))]
    UnknownScene {
        /// As it was asked for.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A scene file.
    #[error("{0}")]
    Scene(Box<FileError>),
    /// A scene that cannot be rendered.
    #[error("{0}: {1}")]
    World(String, WorldError),
    /// Settings that no render has.
    #[error("{0}")]
    Render(#[from] RenderError),
    /// Spheres that cannot be made.
    #[error("{0}: {1}")]
    Generate(String, GenerateError),
    /// The same, of those that rays and builders are measured on.
    #[error("{0}")]
    Workload(#[from] WorkloadError),
    /// The system does not give so many.
    #[error("cannot start {0} threads: {1}; ask for fewer")]
    Threads(usize, rayon::ThreadPoolBuildError),
    /// A reference that is to be kept.
    #[error("{}: cannot be written: {}", .0.display(), .1)]
    Write(PathBuf, io::Error),
    /// The same, as a picture.
    #[error("{0}")]
    Image(#[from] ImageError),
    /// A measurement whose scenes cannot be chosen.
    #[error("the paper's tables have scenes of their own; leave out --scenes")]
    OwnScenes,
    /// A scene that the paper's tracer does not render.
    #[error("{0}")]
    Unsupported(#[from] Unsupported),
    /// Two ways to the same result have come to different ones.
    #[error("{0}: the times mean nothing; please report this fault of the program")]
    Differ(String),
}

impl From<FileError> for BenchError {
    fn from(error: FileError) -> Self {
        Self::Scene(Box::new(error))
    }
}
