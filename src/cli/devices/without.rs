//! Programs that are built without GPUs.

use super::summary::DeviceSummary;
use crate::cli::options::names::Device;
use crate::cli::output;
use spherule_render::World;
use spherule_render::scene::Settings;

/// Advice to who wants one.
pub(in crate::cli) const ADVICE: &str =
    "this program was built without it (build it with cargo build --release --features gpu)";

/// The processor.
#[derive(Debug)]
pub(in crate::cli) struct Attached(Device);

impl Attached {
    /// Leaves all to the processor.
    pub(in crate::cli) fn to(_: &mut World, _: &Settings, choice: Device) -> Self {
        Self(choice)
    }

    /// Leaves it again.
    #[expect(clippy::unused_self, reason = "as with a device")]
    pub(in crate::cli) fn renew(&mut self, _: &mut World, _: &Settings) {}

    /// The reason why there is no device, if one was asked for.
    pub(in crate::cli) fn refusal(&self) -> Option<String> {
        (self.0 == Device::Gpu).then(|| format!("--device gpu has no effect: {ADVICE}"))
    }

    /// Nothing.
    #[expect(clippy::unused_self, reason = "as with a device")]
    pub(in crate::cli) fn facts(&self) -> Vec<String> {
        Vec::new()
    }

    /// Nothing.
    #[expect(clippy::unused_self, reason = "as with a device")]
    pub(in crate::cli) fn fault(&self) -> Option<String> {
        None
    }

    /// Nothing.
    #[expect(clippy::unused_self, reason = "as with a device")]
    pub(in crate::cli) fn new_fault(&mut self) -> Option<String> {
        None
    }

    /// Nothing.
    #[expect(clippy::unused_self, reason = "as with a device")]
    pub(in crate::cli) fn summary(&self) -> Option<DeviceSummary> {
        None
    }
}

/// Says that there is no list.
pub(in crate::cli) fn list(json: bool) {
    if json {
        output::print_json(&Vec::<()>::new());
    }
    output::note(format_args!("GPUs are not looked for: {ADVICE}"));
}
