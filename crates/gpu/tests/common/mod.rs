//! The device of tests.

use spherule_gpu::Device;
use std::sync::Arc;

/// Opens a device; `None`, which the environment may forbid, if there is none.
pub(crate) fn device() -> Option<Arc<Device>> {
    match Device::best(true).map(Arc::new) {
        Ok(device) => Some(device),
        Err(error) => {
            assert!(std::env::var_os("SPHERULE_GPU_TESTS").is_none(), "{error}");
            None
        }
    }
}
