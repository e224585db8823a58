//! The other tests of this folder in one program, a quarter of their size: `tools/gpu-check` takes it to other machines.

#![allow(clippy::duplicate_mod, reason = "each of them includes `common`")]

// By their paths, for `common` is beside them.
#[path = "devices.rs"]
mod devices;
#[path = "hits.rs"]
mod hits;
#[path = "loss.rs"]
mod loss;
#[path = "paths/main.rs"]
mod paths;
#[path = "stages.rs"]
mod stages;
