//! Spheres and rays that walks and builders are measured on: no light, no materials.
//!
//! `spherule bench` and the harness in `tools/peers` measure on the same spheres, seen from the same
//! place, with the same light and the same random directions.

mod rays;
mod spheres;
mod view;

pub use rays::{Class, Views};
pub use spheres::{SphereScene, WorkloadError};
pub use view::{LIGHT, View, above};
