//! Counts of what a device did.

use serde::Serialize;

/// A device, and what it did.
#[derive(Debug, Serialize)]
pub(in crate::cli) struct DeviceSummary {
    pub(in crate::cli) name: String,
    /// Number of rays.
    pub(in crate::cli) rays: u64,
    /// Number of rays that the processor decided.
    pub(in crate::cli) unknown: u64,
    /// Number of paths that the device followed, whose rays are among the others.
    pub(in crate::cli) paths: u64,
    /// Number of paths that the processor followed, for the device did not know their radiance.
    pub(in crate::cli) unknown_paths: u64,
}
