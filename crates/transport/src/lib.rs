//! Light transport of Spherule: what kernels read, what rays hit, how surfaces scatter, and the paths that light takes.
//!
//! This is a part of the crate `spherule`, which has the public interface: use that. Anything here may change in any release.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

// Exact ray queries on spheres.
pub use spherule_core::internals::{
    bodies, body_rows, body_tree, bvh, capsules, cones, elementary, ellipsoids, exact, intersect,
    lanes, ray, spheres, translucency, vec3,
};

// Particle files, and what their readers share with scene files.
pub use spherule_particles::internals::{memory, suggest};

// What users write, and pictures.
pub use spherule_image::{Image, color, image};
pub use spherule_scene::{Scene, scene, settings};

// Vocabulary: knows nothing of scenes.
pub mod sampling;

// The pipeline, in order.
pub mod world;

pub mod trace;

pub mod integrator;
pub mod shade;

pub mod film;

pub use world::World;
