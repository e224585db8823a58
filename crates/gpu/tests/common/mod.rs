//! The device of tests.

use spherule_gpu::Device;
use std::sync::Arc;

/// Opens a device; fails if there is none.
pub(crate) fn device() -> Arc<Device> {
    Device::best(true).map(Arc::new).unwrap_or_else(|error| panic!("{error}"))
}
