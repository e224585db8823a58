//! Errors of measurements.

use crate::workload::WorkloadError;
use spherule_paper::Unsupported;
use spherule_render::image::ImageError;
use spherule_render::render::RenderError;
use spherule_render::scene::FileError;
use spherule_render::scene::generate::GenerateError;
use spherule_render::suggest;
use spherule_render::world::WorldError;
use std::io;
use std::path::PathBuf;

/// An error of a measurement.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// No scene has this name.
    #[error("there is no scene \"{name}\" to measure; {}", suggest::help(name, known.split(", "), "there are"))]
    UnknownScene {
        /// The name as given.
        name: String,
        /// All names.
        known: String,
    },
    /// A scene file could not be read.
    #[error("{0}")]
    Scene(Box<FileError>),
    /// A scene cannot be rendered.
    #[error("{0}: {1}")]
    World(String, WorldError),
    /// The settings are invalid.
    #[error("{0}")]
    Render(#[from] RenderError),
    /// Spheres could not be generated.
    #[error("{0}: {1}")]
    Generate(String, GenerateError),
    /// The spheres of a workload could not be generated.
    #[error("{0}")]
    Workload(#[from] WorkloadError),
    /// The system could not start the threads.
    #[error("cannot start {0} threads: {1}; use fewer threads")]
    Threads(usize, rayon::ThreadPoolBuildError),
    /// A reference image could not be written.
    #[error("{}: cannot be written: {}", .0.display(), .1)]
    Write(PathBuf, io::Error),
    /// An image could not be encoded or written.
    #[error("{0}")]
    Image(#[from] ImageError),
    /// The measurement has fixed scenes.
    #[error("the paper's tables have fixed scenes; remove --scenes")]
    OwnScenes,
    /// The paper's tracer does not support the scene.
    #[error("{0}")]
    Unsupported(#[from] Unsupported),
    /// A device is not there, or fails.
    #[error("{0}")]
    Device(String),
    /// Results that must be equal are not.
    #[error("{0}; the times are meaningless; please report this bug")]
    Differ(String),
}

impl From<FileError> for BenchError {
    fn from(error: FileError) -> Self {
        Self::Scene(Box::new(error))
    }
}
