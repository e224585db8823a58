//! Exact ray queries on spheres, on a GPU.
//!
//! The device answers for each ray which sphere it certainly hits first, that it certainly hits none, or that it
//! does not know; the processor decides what it does not know, and computes all distances. So hits are those of
//! `spherule-core`, bit for bit, on every device whose arithmetic keeps the promises of WGSL, which is tested when a
//! [`Device`] is opened.
//!
//! - [`Adapters`]: what this machine has.
//! - [`Device`]: one of them, open, and what a [`Probe`] of its arithmetic has found.
//! - [`Integrator`]: follows whole paths of renders of a world, whose tree is on the device, as far as it can.
//! - [`DeviceTree`]: a renderer's tree on a device; [`DeviceSpheres`]: a [`spherule_core::SphereTree`].
//!
//! A device that is lost, or that has too little memory, ends no query: the processor answers it.

#![forbid(unsafe_code)]

#[cfg(test)]
mod bounds;
mod caustics;
mod columns;
mod device;
mod error;
mod film;
mod job;
mod lights;
mod materials;
mod nodes;
mod paths;
mod probe;
mod sky;
mod spheres;
mod stages;
mod times;
mod tree;

pub use device::{AdapterSummary, Adapters, Device};
pub use error::DeviceError;
#[doc(hidden)]
pub use paths::FirstStages;
pub use paths::Integrator;
pub use probe::{Fma, Operation, Probe, Subnormals};
pub use spheres::DeviceSpheres;
#[doc(hidden)]
pub use times::{QueryStage, QueryTimes};
pub use tree::{Answered, DeviceTree};
