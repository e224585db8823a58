//! Scenes of Spherule: what users write, in files or in code, the settings of renders, and particles as spheres.
//!
//! This is a part of the crate `spherule`, which has the public interface: use that. Anything here may change in any release.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

use spherule_core::internals::elementary;
use spherule_image::{atomic, color, image};
use spherule_particles::internals::{memory, suggest};

pub mod scene;
pub mod settings;

pub use scene::Scene;
