//! Adapters, and what the probe of their arithmetic finds.

#![allow(clippy::unwrap_used, reason = "tests fail so")]

use spherule_gpu::{Adapters, Fma, Subnormals};

#[test]
#[ignore = "needs Vulkan in software"]
fn the_software_adapter_is_listed_and_its_arithmetic_is_known() {
    let adapters = Adapters::find();
    let summaries = adapters.summaries();
    let place = summaries.iter().position(|summary| summary.name.contains("llvmpipe"));
    let place = place.unwrap_or_else(|| panic!("{summaries:?}"));
    let summary = &summaries[place];
    assert!(summary.is_software() && summary.max_binding >= 1 << 27, "{summary:?}");
    assert_eq!(summary.backend, "vulkan");
    let device = adapters.open(place).unwrap();
    let probe = device.probe();
    // Its operations are those of the processor, but for `fma`, which rounds twice.
    assert!(probe.operations.iter().all(|operation| operation.unequal == 0), "{probe:?}");
    assert_eq!(
        (probe.fma, probe.subnormals, probe.contracts),
        (Fma::Unfused, Subnormals::Kept, false)
    );
    assert!(!probe.is_like_the_processor() && probe.tried > 60_000);
    assert!(adapters.open(summaries.len()).is_err());
}
