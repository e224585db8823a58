//! The device of tests, and their files.

use spherule_gpu::Device;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Returns the device of all tests but those that destroy theirs: each kernel is compiled once. Fails if there is none.
pub(crate) fn device() -> &'static Arc<Device> {
    static DEVICE: OnceLock<Arc<Device>> = OnceLock::new();
    DEVICE.get_or_init(own_device)
}

/// Opens a device; fails if there is none.
pub(crate) fn own_device() -> Arc<Device> {
    Arc::new(Device::best(true).unwrap_or_else(|error| panic!("{error}")))
}

/// Returns the scene files of the repository.
pub(crate) fn scene_folder() -> PathBuf {
    folder("CARGO_MANIFEST_DIR", env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// Returns the folder of files that tests write.
pub(crate) fn scratch_folder() -> PathBuf {
    folder("CARGO_TARGET_TMPDIR", env!("CARGO_TARGET_TMPDIR"))
}

/// Returns a folder that cargo named while it compiled, or what the variable names now: `tools/gpu-check` runs tests on
/// another machine.
fn folder(variable: &str, compiled: &str) -> PathBuf {
    std::env::var_os(variable).map_or_else(|| PathBuf::from(compiled), PathBuf::from)
}
