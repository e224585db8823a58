//! Measurements of Spherule: run time and error, comparison with exact arithmetic, and reports.
//!
//! - [`mod@bench`]: benchmarks of `spherule bench`, each with a [`report::Report`].
//! - [`stress`]: intersection tests compared with exact arithmetic in numerically hard cases.
//! - [`paper`]: the recursive ray tracer of "Optimizing Ray Tracing", as a baseline.
//! - [`workload`]: spheres and rays for measurements of traversal.
//! - [`report`]: tables and plots, and their conversion to files.
//!
//! This crate is internal to the program; anything here may change in any release.

#![forbid(unsafe_code)]

pub mod bench;
pub mod paper;
pub mod report;
pub mod stress;
pub mod workload;
