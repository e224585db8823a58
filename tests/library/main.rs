//! Tests of the library: images, traversals, BVHs, queries and readers, compared with closed forms and
//! oracles.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod bodies;
mod layers;
mod outlines;
mod random_scenes;
mod readers;
mod resume;
mod scenes;
mod slices;
mod split;
mod stress;
mod translucency;
mod truths;
