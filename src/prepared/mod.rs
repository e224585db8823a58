//! Files that hold a scene with its tree: renders that open them need not read particles, place them, or
//! build.
//!
//! Many renders of one scene, such as the parts of a picture that many processes render, otherwise do
//! the same work each before the first ray. Nothing of a picture depends on which way its scene came.
//!
//! # Format
//!
//! Numbers are little-endian, but for the columns.
//!
//! | bytes | |
//! |---|---|
//! | 18 | `spherule-prepared` and a line feed |
//! | 4 | version of the format |
//! | 8 | length of the head |
//! | | the head, by [postcard](https://postcard.jamesmunns.com): version of the program, order of bytes, the scene without its spheres in words, its identity, where its spheres and its camera are, lengths of the columns |
//! | | the columns, in the order of bytes of the processor that wrote them: blocks of spheres, ids, nodes, materials, colors, the spheres that the camera sees and their nodes, the environment's picture |
//! | 32 | BLAKE3 hash of all that comes before |
//!
//! Whatever byte is missing or another one, the hash tells, and the file is refused. A file that was
//! made to deceive, hash and all, is refused too if its columns are no spheres or no tree, and takes no
//! more memory than its own length.

mod read;
mod write;

pub use read::{PreparedError, is_prepared, read};
pub use write::write;

use crate::bvh::builders::Builder;
use crate::scene::{Identity, Scene};
use crate::world::{Frame, LeftOut, Parts, Placement, World, WorldError};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The first bytes of such files.
const MAGIC: [u8; 18] = *b"spherule-prepared\n";

/// Version of the format.
const FORMAT: u32 = 1;

/// The program that writes: another may have other columns.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// Tells in which order the bytes of a number are.
const ORDER: u32 = 0x0102_0304;

/// A scene whose spheres are in the order of a tree, without the spheres in the user's coordinates.
#[derive(Clone, Debug)]
pub struct PreparedScene {
    /// The scene without its spheres. Settings may be changed before [`PreparedScene::build`].
    pub scene: Scene,
    /// Identity of the scene with its spheres.
    pub identity: Identity,
    /// Names and values that the files of pictures are to list, besides settings.
    pub looks: Vec<(String, String)>,
    /// The builder of the tree.
    pub builder: Builder,
    /// Size of the picture for which the camera was placed, in pixels.
    size: [u32; 2],
    parts: Parts,
}

impl PreparedScene {
    /// Builds the world, which is the one of the scene that was written.
    ///
    /// # Errors
    /// The picture's aspect is another one, and the camera frames the spheres or is parallel; or a
    /// setting is out of its range.
    pub fn build(mut self) -> Result<(Scene, World), PrepareError> {
        if !self.parts.place(&self.scene, self.size)? {
            return Err(PrepareError::Aspect(self.size));
        }
        let world = World::complete(&self.scene, self.parts);
        Ok((self.scene, world))
    }
}

/// Why a prepared scene cannot be rendered, or a scene not be prepared.
#[derive(Debug, thiserror::Error)]
pub enum PrepareError {
    /// The camera was placed for another picture.
    #[error(
        "was prepared for {} x {} pixels, and its camera depends on their aspect: give --size the same \
         aspect, or prepare it for the other one", .0[0], .0[1]
    )]
    Aspect([u32; 2]),
    /// The scene has what no file of a scene can say.
    #[error("cannot be prepared: {0}")]
    Scene(String),
    /// A setting is out of range, or the camera sees nothing.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The file cannot be written.
    #[error("cannot be written: {0}")]
    Write(#[from] std::io::Error),
}

/// All of a file but for the columns.
#[derive(Serialize, Deserialize)]
struct Head {
    scene: String,
    identity: Identity,
    looks: Vec<(String, String)>,
    builder: Builder,
    frame: Frame,
    placement: Placement,
    left_out: LeftOut,
    lengths: Lengths,
}

/// Rows of each column, and how the looks of spheres are told.
#[derive(Serialize, Deserialize)]
struct Lengths {
    spheres: u64,
    nodes: u64,
    /// Number of the material of all spheres; `None` if each has its own.
    material: Option<u32>,
    colors: ColorLengths,
    /// Spheres that the camera sees and their nodes, if it does not see all.
    seen: Option<(u64, u64)>,
    sky: Option<Sky>,
}

#[derive(Serialize, Deserialize)]
enum ColorLengths {
    None,
    Rows,
    /// With the table of colors.
    Coded(Vec<[f32; 3]>),
}

/// The environment's picture but for its pixels.
#[derive(Serialize, Deserialize)]
struct Sky {
    width: u32,
    height: u32,
    up: DVec3,
    rotation: f64,
    scale: f32,
}

#[cfg(test)]
mod tests;
