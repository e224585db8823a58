//! The program with GPUs: images with a device, and without one, are the processor's.

#![cfg(feature = "gpu")]

#[path = "common/process.rs"]
mod process;

use std::path::Path;
use std::process::Command;

/// A variable of Vulkan's loader with the drivers; none of these exists.
const NO_DRIVERS: (&str, &str) = ("VK_ICD_FILENAMES", "/nowhere");

/// Runs the program, and returns what it prints, and what it complains of.
fn run(folder: &Path, args: &[&str], variable: Option<(&str, &str)>) -> (String, String) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_spherule"));
    let output = process::run(program.args(args).envs(variable).current_dir(folder));
    let [printed, complaints] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{args:?}: {complaints}");
    (printed, complaints)
}

/// Renders a small image on a device, and returns its bytes, and the complaints.
fn image(folder: &Path, device: &str, variable: Option<(&str, &str)>) -> (Vec<u8>, String) {
    let occlusion = ["render", "--size", "64x36", "--spp", "4", "--quiet", "--integrator", "ao"];
    let args = [&occlusion[..], &["--device", device, "-o", "a.pfm"]].concat();
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
fn what_the_device_does_is_told() {
    if std::env::var_os("SPHERULE_GPU_TESTS").is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let render = |device: &str, more: &[&str]| {
        let args = ["render", "--size", "64x36", "--spp", "4", "--device", device, "-o", "a.pfm"];
        let (printed, notes) = run(folder.path(), &[&args, more].concat(), None);
        (std::fs::read(folder.path().join("a.pfm")).expect("an image"), printed, notes)
    };
    let occlusion = ["--integrator", "ao", "--json", "--quiet"];
    let (own, ..) = render("cpu", &occlusion);
    let (image, printed, _) = render("gpu", &occlusion);
    assert!(image == own);
    let summary: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    let text = summary.to_string();
    let paths = text.split("\"paths\":").nth(1).and_then(|rest| rest.split([',', '}']).next());
    assert!(
        paths.and_then(|paths| paths.parse().ok()).is_some_and(|paths: u64| paths > 1000),
        "{text}"
    );
    // The default field, whose glass and metal cast caustics.
    for more in [[].as_slice(), &["--no-caustics"], &["--integrator", "whitted"]] {
        let (own, ..) = render("cpu", more);
        let (image, _, notes) = render("gpu", &[more, &["--verbose"]].concat());
        assert!(notes.contains("follows paths from the camera to their ends"), "{notes}");
        assert!(image == own, "{more:?}");
    }
    let sliced = ["--integrator", "ao", "--slice", "x>0", "--slice-mode", "hide"];
    let (.., notes) = render("gpu", &sliced);
    assert!(notes.contains("--device gpu has no effect"), "{notes}");
    assert!(notes.contains("the scene has slices"), "{notes}");
}

#[test]
fn devices_are_listed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (printed, _) = run(folder.path(), &["info", "--devices", "--json"], None);
    let listed: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    let count = listed.as_array().map_or(0, Vec::len);
    assert!(count > 0 || std::env::var_os("SPHERULE_GPU_TESTS").is_none(), "{printed}");
}

#[test]
fn the_device_is_measured_beside_the_processor() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    if std::env::var_os("SPHERULE_GPU_TESTS").is_none() {
        return;
    }
    let args = ["bench", "gpu", "--quick", "--rounds", "1", "-o", "out"];
    let (printed, _) = run(folder.path(), &args, None);
    assert!(printed.contains("Adapter: ") && printed.contains("unknown"), "{printed}");
    let read = |name: &str| std::fs::read(folder.path().join("out").join(name)).expect(name);
    let report: serde_json::Value = serde_json::from_slice(&read("gpu.json")).expect("JSON");
    let rows = |table: usize| report["tables"][table]["rows"].as_array().expect("rows").clone();
    // Classes of rays; one set of spheres; three images with two numbers of samples.
    assert_eq!([0, 1, 2].map(|table| rows(table).len()), [4, 1, 6]);
    let stages = ["pack", "upload", "kernel", "read", "decide"];
    for row in rows(0) {
        let share = |stage: &&str| row[*stage].as_f64().unwrap_or(f64::NAN);
        let sum: f64 = stages.iter().map(share).sum();
        assert!((sum - 1.0).abs() < 1e-9, "{row}");
        assert!(row["unknown"].as_f64().is_some_and(|share| share < 0.05), "{row}");
    }
    assert!(!read("gpu-build.csv").is_empty() && !read("gpu-error.csv").is_empty());
}
