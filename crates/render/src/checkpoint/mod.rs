//! Files that store an unfinished render, with everything needed to resume it to the same bytes.
//!
//! # Format
//!
//! Numbers are little-endian.
//!
//! | bytes | |
//! |---|---|
//! | 20 | `spherule-checkpoint` and a line feed |
//! | 4 | version of the format |
//! | 8 | length of the head |
//! | | the head, by [postcard](https://postcard.jamesmunns.com): version of the program, identity of the scene, the command, caption, the render without its sums |
//! | 4, ... | length and bytes of each block: the sums of 64 tiles, compressed |
//! | 32 | BLAKE3 hash of all that comes before |
//!
//! If any byte is missing or changed, the hash does not match, and the file is refused before its
//! content is used. A forged file with a valid hash is refused too if its content is not a valid
//! render, and takes no more memory than its length justifies.
//!
//! A file is written beside the one that it replaces and takes its name in one step (see
//! [`crate::atomic`]): whenever the program is killed, either the old file or the new one is complete.

mod blocks;
mod lock;
mod read;
mod write;

pub use lock::{Lock, LockError, is_locked};
pub use read::{CheckpointError, inspect, read};
pub use write::write;

use crate::layers::{Features, Layer};
use crate::scene::Identity;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::ops::Range;

/// The first bytes of checkpoints.
const MAGIC: [u8; 20] = *b"spherule-checkpoint\n";

/// Version of the format.
const FORMAT: u32 = 8;

/// The program that writes: another may make other bytes of the same samples.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// Origin of a render: the scene and the command that started it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Origin {
    /// The scene.
    pub scene: Identity,
    /// The folder in which the command was given; empty if there was none.
    pub folder: OsString,
    /// The arguments of the command; empty if the render was started from code.
    pub arguments: Vec<OsString>,
    /// Metadata and layers of the image, to write it without the scene.
    pub caption: Caption,
}

/// Data of an image besides its pixels: metadata and layers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Caption {
    /// The scene's title; empty if there is none.
    pub title: String,
    /// Looks of the scene: names and values.
    pub looks: Vec<(String, String)>,
    /// True if something is drawn over the image that takes the scene: a cell, a background.
    pub drawn_over: bool,
    /// The drawing of the scene's annotations, in the bytes of `graphics::Drawing`.
    pub annotations: Vec<u8>,
    /// The layers that are wanted.
    pub layers: Vec<Layer>,
    /// The tiles whose features are known, by their numbers.
    pub tiles: Range<u32>,
    /// The features of their pixels, as [`crate::layers::features`] gives them.
    pub features: Vec<Features>,
}

#[cfg(test)]
mod tests;
