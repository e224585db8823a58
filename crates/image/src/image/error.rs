//! Errors of image files.

use super::Format;
use super::tone::EXPOSURES;
use crate::memory::Shortage;
use std::{
    io,
    path::{Path, PathBuf},
};

/// The reason why an image could not be created, read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be opened or read.
    #[error("cannot read the picture {path:?}: {reason}; name a file that exists and is readable")]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        reason: io::Error,
    },
    /// The first bytes belong to no supported format.
    #[error("{path:?} is not a picture of a known format; convert it to {}", Format::read_names())]
    UnknownContent {
        /// The file.
        path: PathBuf,
    },
    /// The content is cut off, damaged, not supported, or claims an absurd size.
    #[error("cannot read {path:?} as {format}: {reason}")]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Format of its first bytes.
        format: Format,
        /// The error, its position, and how to fix it.
        reason: String,
    },
    /// The suffix of the destination belongs to no format that can be written.
    #[error("unknown format of {path:?}; use the suffix {}", Format::written_suffixes(others))]
    UnknownSuffix {
        /// The destination.
        path: PathBuf,
        /// Suffixes of other files that may be there, such as pages and videos.
        others: &'static [&'static str],
    },
    /// The destination cannot be written; what was there before is untouched.
    #[error("cannot write {path:?}: {reason}")]
    Write {
        /// The destination.
        path: PathBuf,
        /// Error of the system, or how to fix it.
        reason: io::Error,
    },
    /// The format cannot store the image.
    #[error(
        "cannot write the picture as {format}: {reason}; choose another format or a smaller picture"
    )]
    Encode {
        /// The requested format.
        format: Format,
        /// Error of the encoder.
        reason: String,
    },
    /// Only EXR files can store additional channels.
    #[error("cannot write layers: {format} does not support them; choose EXR")]
    Layers {
        /// The requested format.
        format: Format,
    },
    /// A channel that no file can store.
    #[error("the channel {name:?} cannot be written: {reason}")]
    Channel {
        /// The channel's name.
        name: String,
        /// The error, and how to fix it.
        reason: String,
    },
    /// The number of pixels is 0, or not the product of width and height.
    #[error(
        "a picture of {width} x {height} cannot have {count} pixels; give width * height of them, \
         at least one"
    )]
    Shape {
        /// Width of the image in pixels.
        width: u32,
        /// Height of the image in pixels.
        height: u32,
        /// Actual number of pixels.
        count: usize,
    },
    /// More pixels than fit into memory.
    #[error(
        "a picture of {width} x {height} is too large{}; make it smaller",
        .shortage.as_ref().map_or(String::new(), |shortage| format!(": it needs {shortage}"))
    )]
    Memory {
        /// Width of the image in pixels.
        width: u32,
        /// Height of the image in pixels.
        height: u32,
        /// The missing memory, if it is known.
        shortage: Option<Shortage>,
    },
    /// The exposure is out of range.
    #[error(
        "invalid exposure of {0} stops; give a number from {least} to {most}, 0 for \
         none",
        least = EXPOSURES.start(), most = EXPOSURES.end()
    )]
    Exposure(f64),
    /// An entry of the metadata that files cannot store.
    #[error("the metadata entry {key:?} cannot be written: {reason}")]
    Metadata {
        /// The entry's key.
        key: String,
        /// The error, and how to fix it.
        reason: &'static str,
    },
}

impl ImageError {
    /// Returns the error where files with other suffixes may be, too.
    #[must_use]
    pub fn or_suffixes(self, others: &'static [&'static str]) -> Self {
        match self {
            Self::UnknownSuffix { path, .. } => Self::UnknownSuffix { path, others },
            other => other,
        }
    }

    pub(super) fn malformed(path: &Path, format: Format, reason: String) -> Self {
        Self::Malformed { path: path.to_owned(), format, reason }
    }
}
