//! Files that hold an unfinished render: all that it takes to go on to the same bytes.
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
//! | | the head, by [postcard](https://postcard.jamesmunns.com): version of the program, identity of the scene, the command, the render without its sums |
//! | 4, ... | length and bytes of each block: the sums of 64 tiles, compressed |
//! | 32 | BLAKE3 hash of all that comes before |
//!
//! Whatever byte is missing or another one, the hash tells, and the file is refused; nothing of it is
//! believed before. A file that was made to deceive, hash and all, is refused too if it says what no
//! render is, and takes no more memory than it is entitled to by its own length.
//!
//! A file is written beside the one that it replaces and takes its name in one step (see
//! [`crate::atomic`]): whenever the program is killed, the old one is whole, or the new one.

mod blocks;
mod lock;
mod read;
mod write;

pub use lock::{Lock, LockError};
pub use read::{CheckpointError, read};
pub use write::write;

use crate::scene::Identity;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;

/// What such files begin with.
const MAGIC: [u8; 20] = *b"spherule-checkpoint\n";

/// Version of the format.
const FORMAT: u32 = 1;

/// The program that writes: another may make other bytes of the same samples.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// Bytes of the hash at the end.
const HASH: u64 = 32;

/// Where a render comes from: what it takes to begin it again.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// What is rendered.
    pub scene: Identity,
    /// The folder in which the command was given; empty if there was none.
    pub folder: OsString,
    /// What the command says, in its own words; empty if a render comes from code.
    pub arguments: Vec<OsString>,
}

#[cfg(test)]
mod tests;
