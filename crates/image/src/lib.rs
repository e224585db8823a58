//! Pictures of Spherule: colors and color maps, image files, videos and tone curves, and drawing with letters and lines.
//!
//! This is a part of the crate `spherule`, which has the public interface: use that. Anything here may change in any release.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

use spherule_core::internals::elementary;
use spherule_particles::internals::{memory, suggest};

pub mod color;

#[cfg(feature = "drawing")]
pub mod graphics;

pub mod atomic;
pub mod image;
pub mod video;

pub use image::Image;
