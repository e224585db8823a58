//! Devices that trace rays, the processor or a GPU (`--device`), and the list of GPUs (`info --devices`).

#[cfg(feature = "gpu")]
mod gpu;
mod summary;
#[cfg(not(feature = "gpu"))]
mod without;

#[cfg(feature = "gpu")]
pub(super) use self::gpu::{Attached, list, open};
pub(super) use self::summary::DeviceSummary;
#[cfg(not(feature = "gpu"))]
pub(super) use self::without::{ADVICE, Attached, list};
