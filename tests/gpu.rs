//! The program with GPUs: images with a device, and without one, are the processor's.

#![cfg(feature = "gpu")]

use assert_cmd::Command;
use std::path::Path;

/// A variable of Vulkan's loader with the drivers; none of these exists.
const NO_DRIVERS: (&str, &str) = ("VK_ICD_FILENAMES", "/nowhere");

/// Runs the program, and returns what it prints, and what it complains of.
fn run(folder: &Path, args: &[&str], variable: Option<(&str, &str)>) -> (String, String) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_spherule"));
    let output = program.args(args).envs(variable).current_dir(folder).output();
    let output = output.expect("a program that runs");
    let [printed, complaints] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{args:?}: {complaints}");
    (printed, complaints)
}

/// Renders a small image on a device, and returns its bytes, and the complaints.
fn image(folder: &Path, device: &str, variable: Option<(&str, &str)>) -> (Vec<u8>, String) {
    let args =
        ["render", "--size", "64x36", "--spp", "4", "--quiet", "--device", device, "-o", "a.pfm"];
    let (_, complaints) = run(folder, &args, variable);
    (std::fs::read(folder.join("a.pfm")).expect("an image"), complaints)
}

#[test]
fn images_are_the_processors_with_and_without_a_device() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let refusal = "--device gpu has no effect";
    let (own, _) = image(folder.path(), "cpu", None);
    let (other, complaints) = image(folder.path(), "gpu", None);
    assert!(own == other);
    if std::env::var_os("SPHERULE_GPU_TESTS").is_some() {
        assert!(!complaints.contains(refusal), "{complaints}");
    }
    let (without, complaints) = image(folder.path(), "gpu", Some(NO_DRIVERS));
    assert!(own == without);
    if cfg!(target_os = "linux") {
        assert!(complaints.contains(refusal), "{complaints}");
    }
}

#[test]
fn devices_are_listed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (printed, _) = run(folder.path(), &["info", "--devices", "--json"], None);
    let listed: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    let count = listed.as_array().map_or(0, Vec::len);
    assert!(count > 0 || std::env::var_os("SPHERULE_GPU_TESTS").is_none(), "{printed}");
}
