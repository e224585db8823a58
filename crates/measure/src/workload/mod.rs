//! Spheres and rays for measurements of traversal and construction, without lights and materials.
//!
//! `spherule bench` and the harness in `tools/peers` use the same spheres, camera, light direction and
//! random directions.

mod rays;
mod spheres;
mod view;

pub use rays::{Class, Views};
pub use spheres::{SphereScene, WorkloadError};
pub use view::{LIGHT, View, above};
