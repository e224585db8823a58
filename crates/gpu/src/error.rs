//! Reasons why a device does not answer.

/// A reason why a device does not answer. Whoever asked turns to the processor.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceError {
    /// No adapter is there.
    #[error("no GPU was found: there is no driver for Vulkan, Metal or DirectX 12")]
    NoAdapter,
    /// The adapter gave no device.
    #[error("the GPU {adapter} cannot be used: {reason}")]
    Refused {
        /// The adapter's name.
        adapter: String,
        /// Message of the driver.
        reason: String,
    },
    /// The device's arithmetic is less exact than the bounds of the kernels allow.
    #[error(
        "the GPU {adapter} cannot be used: its arithmetic breaks the promises of WGSL ({what})"
    )]
    Inexact {
        /// The adapter's name.
        adapter: String,
        /// The operations.
        what: String,
    },
    /// Spheres or rays do not fit.
    #[error("the GPU has too little memory for {what}")]
    Memory {
        /// Data that do not fit, and their size.
        what: String,
    },
    /// The device is gone.
    #[error("the GPU was lost: {0}")]
    Lost(String),
    /// Anything else that the driver reports.
    #[error("the GPU failed: {0}")]
    Failed(String),
}
