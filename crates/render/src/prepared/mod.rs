//! Prepared scenes: files with a scene and its tree, so that renders need not read particles, transform
//! them, or build the tree.
//!
//! Many renders of one scene, such as the parts of an image in many processes, would otherwise repeat
//! this work. Images do not depend on whether their scene was prepared.
//!
//! # Format
//!
//! Numbers are little-endian, except in the columns.
//!
//! | bytes | |
//! |---|---|
//! | 18 | `spherule-prepared` and a line feed |
//! | 4 | version of the format |
//! | 8 | length of the header |
//! | | the header, by [postcard](https://postcard.jamesmunns.com): version of the program, byte order, the scene as text without its spheres, its identity, coordinate transform and camera, lengths of the columns |
//! | | the columns, in the byte order of the processor that wrote them: blocks of spheres, ids, nodes, materials, colors, the spheres that the camera sees and their nodes, the environment's picture |
//! | 32 | BLAKE3 hash of all bytes before it |
//!
//! The hash detects missing or changed bytes, and such files are refused. Files that are forged, with a
//! valid hash, are refused too if their columns are not valid spheres or trees, and take no more memory
//! than their length.

mod read;
mod write;

pub use read::{PreparedError, is_prepared, read};
pub use write::write;

use crate::bvh::builders::Builder;
use crate::scene::{Identity, Scene};
use crate::world::{OmittedSpheres, Parts, Placement, Transform, World, WorldError};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The first bytes of the files.
const MAGIC: [u8; 18] = *b"spherule-prepared\n";

/// Version of the format.
const FORMAT: u32 = 1;

/// Version of the program, since other versions may have other columns.
const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// A number whose bytes show the byte order.
const ORDER: u32 = 0x0102_0304;

/// A scene whose spheres are in the order of a tree, without the spheres in the user's coordinates.
#[derive(Clone, Debug)]
pub struct PreparedScene {
    /// The scene without its spheres. Settings may be changed before [`PreparedScene::build`].
    pub scene: Scene,
    /// Identity of the scene with its spheres.
    pub identity: Identity,
    /// Names and values for the metadata of images, in addition to settings.
    pub metadata: Vec<(String, String)>,
    /// The builder of the tree.
    pub builder: Builder,
    /// Image size for which the camera was placed, in pixels.
    size: [u32; 2],
    parts: Parts,
}

impl PreparedScene {
    /// Returns the number of spheres.
    pub fn sphere_count(&self) -> usize {
        self.parts.spheres.len()
    }

    /// Builds the world of the prepared scene.
    ///
    /// # Errors
    /// The aspect of the image has changed, and the camera is fitted or parallel; or a setting is out
    /// of range.
    pub fn build(mut self) -> Result<(Scene, World), PrepareError> {
        if !self.parts.place(&self.scene, self.size)? {
            return Err(PrepareError::Aspect(self.size));
        }
        let world = World::complete(&self.scene, self.parts);
        Ok((self.scene, world))
    }
}

/// Reasons why a prepared scene cannot be rendered, or a scene cannot be prepared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PrepareError {
    /// The camera was placed for another image.
    #[error(
        "was prepared for {} x {} pixels, and its camera depends on the aspect ratio: use --size with the \
         same ratio, or prepare it again", .0[0], .0[1]
    )]
    Aspect([u32; 2]),
    /// The scene has data that scene files do not support.
    #[error("cannot be prepared: {0}")]
    Scene(String),
    /// A setting is out of range, or the camera sees nothing.
    #[error(transparent)]
    World(#[from] WorldError),
    /// The file cannot be written.
    #[error("cannot be written: {0}")]
    Write(#[from] std::io::Error),
}

/// The content of a file except for the columns.
#[derive(Serialize, Deserialize)]
struct Header {
    scene: String,
    identity: Identity,
    metadata: Vec<(String, String)>,
    builder: Builder,
    transform: Transform,
    placement: Placement,
    omitted: OmittedSpheres,
    lengths: Lengths,
}

/// Number of rows of each column, and storage of materials and colors.
#[derive(Serialize, Deserialize)]
struct Lengths {
    spheres: u64,
    nodes: u64,
    /// Material id of all spheres; `None` if each has its own.
    material: Option<u32>,
    colors: ColorLengths,
    /// Spheres that the camera sees and their nodes, if it does not see all.
    visible: Option<(u64, u64)>,
    picture: Option<EnvironmentPicture>,
}

#[derive(Serialize, Deserialize)]
enum ColorLengths {
    None,
    Rows,
    /// Codes, with the table of colors.
    Coded(Vec<[f32; 3]>),
}

/// The environment's picture without its pixels.
#[derive(Serialize, Deserialize)]
struct EnvironmentPicture {
    width: u32,
    height: u32,
    up: DVec3,
    rotation: f64,
    scale: f32,
}

#[cfg(test)]
mod tests;
