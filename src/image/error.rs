//! What can go wrong with a picture file, and the mend.

use super::Format;
use crate::memory::Shortage;
use crate::scene::Settings;
use std::{
    io,
    path::{Path, PathBuf},
};

/// Why a picture could not be made, read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The file cannot be opened or read.
    #[error("cannot read the picture {path:?}: {reason}; name a file that exists and may be read")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: io::Error,
    },
    /// The first bytes are of no format that is read here.
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
        /// What its first bytes say it is.
        format: Format,
        /// What is wrong, where, and what would be right.
        reason: String,
    },
    /// The suffix of the destination names no format that is written here.
    #[error(
        "the suffix of {path:?} names no format; end the name in {}",
        Format::written_suffixes()
    )]
    UnknownSuffix {
        /// The destination.
        path: PathBuf,
    },
    /// The destination cannot be written; what was there before is untouched.
    #[error("cannot write {path:?}: {reason}")]
    Write {
        /// The destination.
        path: PathBuf,
        /// What the system said, or what to do first.
        reason: io::Error,
    },
    /// The format cannot hold the picture.
    #[error(
        "cannot write the picture as {format}: {reason}; choose another format or a smaller picture"
    )]
    Encode {
        /// The format that was asked for.
        format: Format,
        /// What the encoder said.
        reason: String,
    },
    /// Only EXR files hold more channels than colors.
    #[error("cannot write layers: {format} has no room for them; choose EXR")]
    Layers {
        /// The format that was asked for.
        format: Format,
    },
    /// A channel that no file can hold.
    #[error("the channel {name:?} cannot be written: {reason}")]
    Channel {
        /// The channel's name.
        name: String,
        /// What is wrong, and what would be right.
        reason: String,
    },
    /// The number of pixels is not the product of width and height, or it is 0.
    #[error(
        "a picture of {width} x {height} cannot have {count} pixels; give width * height of them, \
         at least one"
    )]
    Shape {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// Pixels that are there.
        count: usize,
    },
    /// More pixels than memory holds.
    #[error(
        "a picture of {width} x {height} is too large{}; make it smaller",
        .shortage.as_ref().map_or(String::new(), |shortage| format!(": it needs {shortage}"))
    )]
    Memory {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The memory that is lacking, if it is known.
        shortage: Option<Shortage>,
    },
    /// The exposure is not in its range.
    #[error(
        "an exposure of {0} stops makes no picture; give a number from {least} to {most}, 0 for \
         none",
        least = Settings::EXPOSURES.start(), most = Settings::EXPOSURES.end()
    )]
    Exposure(f64),
    /// An entry of the metadata that files cannot hold.
    #[error("the metadata entry {key:?} cannot be written: {reason}")]
    Metadata {
        /// The entry's key.
        key: String,
        /// What is wrong, and what would be right.
        reason: &'static str,
    },
}

impl ImageError {
    pub(super) fn malformed(path: &Path, format: Format, reason: String) -> Self {
        Self::Malformed { path: path.to_owned(), format, reason }
    }
}
