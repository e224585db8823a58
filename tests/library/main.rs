//! The library: pictures, walks, trees, queries and readers beside closed forms, oracles and one another.

#[path = "../common/mod.rs"]
mod common;

mod adaptive;
mod layers;
mod readers;
mod resume;
mod scenes;
mod slices;
mod split;
mod stress;
mod truths;
