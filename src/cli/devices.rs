//! Devices that trace rays, the processor or a GPU (`--device`), and the list of GPUs (`info --devices`).

#[cfg(feature = "gpu")]
mod gpu;
#[cfg(not(feature = "gpu"))]
mod without;

#[cfg(feature = "gpu")]
pub(super) use self::gpu::{Attached, list, open};
#[cfg(not(feature = "gpu"))]
pub(super) use self::without::{ADVICE, Attached, list};

use serde::Serialize;

/// A device, and what it did.
#[derive(Debug, Serialize)]
pub(super) struct DeviceSummary {
    pub(super) name: String,
    /// Number of rays.
    pub(super) rays: u64,
    /// Number of rays that the processor decided.
    pub(super) unknown: u64,
    /// Number of paths that the device followed, whose rays are among the others.
    pub(super) paths: u64,
    /// Number of paths that the processor followed, for the device did not know their radiance.
    pub(super) unknown_paths: u64,
}
