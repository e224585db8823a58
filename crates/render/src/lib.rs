//! The renderer of Spherule: renders of worlds, their error, their files, and what is drawn over images.
//!
//! This is the implementation of the crate `spherule`, which has the public interface: use that. Anything here may
//! change in any release. Worlds and the paths of light are `spherule-transport`'s; the modules here, in the order of
//! the data:
//!
//! ```text
//! noise, render, denoise      tiles, their error, and rounds over them
//! layers, overlay, compose    images, and the scenes that they are of
//! checkpoint, prepared, split files
//! ```

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

// Exact ray queries on spheres.
pub use spherule_core as query;
pub use spherule_core::internals::{
    bodies, body_rows, body_tree, bvh, capsules, cones, elementary, ellipsoids, exact, intersect,
    lanes, ray, spheres, translucency, vec3,
};

// Particle files, and what their readers share with scene files.
pub use spherule_particles::internals::{memory, suggest};

// What users write, and images.
#[cfg(feature = "drawing")]
pub use spherule_image::graphics;
pub use spherule_image::{Image, atomic, color, image, video};
pub use spherule_scene::{Scene, scene, settings};

// Paths of light.
pub use spherule_transport::{film, integrator, sampling, shade, trace, world};

pub mod checkpoint;
#[cfg(feature = "drawing")]
pub mod compose;
pub mod denoise;
pub mod layers;
pub mod noise;
pub mod overlay;
pub mod prepared;
pub mod render;
pub mod split;

mod sealed;

pub use spherule_core::SphereTree;
pub use world::World;
