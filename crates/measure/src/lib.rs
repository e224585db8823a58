//! Measurements of Spherule: run time and error, comparison with exact arithmetic, and reports.
//!
//! - [`mod@bench`]: benchmarks of `spherule bench`, each with a [`report::Report`].
//! - [`stress`]: intersection tests compared with exact arithmetic in numerically hard cases.
//! - [`workload`]: spheres and rays for measurements of traversal.
//! - [`random_scene()`]: scenes for comparisons, as files.
//! - [`report`]: tables and plots, and their conversion to files.
//!
//! This crate is internal to the program; anything here may change in any release.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

#[allow(clippy::disallowed_methods, reason = "fits of timings, which no image shows")]
pub mod bench;
mod random_scene;
#[allow(clippy::disallowed_methods, reason = "scales of plots, which no image shows")]
pub mod report;
pub mod stress;
pub mod workload;

pub use random_scene::{random_scene, random_scene_of_all_bodies};
