//! The program with GPUs: images with a device, and without one, are the processor's.

#![cfg(feature = "gpu")]

#[path = "cli/folder.rs"]
mod folder;
#[path = "common/process.rs"]
mod process;

use folder::{Folder, text};
use std::process::Command;

/// A variable of Vulkan's loader with the drivers; none of these exists.
#[cfg(target_os = "linux")]
const NO_DRIVERS: (&str, &str) = ("VK_ICD_FILENAMES", "/nowhere");

/// Runs a command, asserts success, and returns what it writes to standard output and to standard error.
#[track_caller]
fn run(command: &mut Command) -> (String, String) {
    let output = process::run(command);
    let (printed, notes) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{command:?}: {notes}");
    (printed, notes)
}

/// Returns a command that renders a small image, `a.pfm`, on a device.
fn render(folder: &Folder, device: &str) -> Command {
    folder.command(&["render", "--size", "64x36", "--spp", "4", "--device", device, "-o", "a.pfm"])
}

#[test]
#[cfg(target_os = "linux")]
fn images_without_drivers_are_the_processors() {
    let folder = Folder::new();
    run(&mut render(&folder, "cpu"));
    let own = folder.read("a.pfm");
    let (_, notes) = run(render(&folder, "gpu").arg("--quiet").envs([NO_DRIVERS]));
    assert!(notes.contains("--device gpu has no effect"), "{notes}");
    assert!(notes.contains("no GPU was found"), "{notes}");
    assert!(folder.read("a.pfm") == own);
}

#[test]
#[cfg(target_os = "linux")]
fn no_devices_are_listed_without_drivers() {
    let folder = Folder::new();
    let (printed, _) = run(folder.command(&["info", "--devices", "--json"]).envs([NO_DRIVERS]));
    assert_eq!(printed.trim(), "[]");
    let (printed, notes) = run(folder.command(&["info", "--devices"]).envs([NO_DRIVERS]));
    assert!(printed.is_empty() && notes.contains("no GPU was found"), "{printed} {notes}");
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn images_of_a_device_are_the_processors() {
    let folder = Folder::new();
    run(&mut render(&folder, "cpu"));
    let own = folder.read("a.pfm");
    let (_, notes) = run(render(&folder, "gpu").arg("--quiet"));
    assert!(!notes.contains("--device gpu has no effect"), "{notes}");
    assert!(folder.read("a.pfm") == own);
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn what_the_device_does_is_told() {
    let folder = Folder::new();
    let render = |device: &str, more: &[&str]| {
        let (printed, notes) = run(render(&folder, device).args(more));
        (folder.read("a.pfm"), printed, notes)
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
#[ignore = "needs a GPU, or Vulkan in software"]
fn devices_are_listed() {
    let folder = Folder::new();
    let (printed, _) = run(&mut folder.command(&["info", "--devices", "--json"]));
    let listed: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    assert!(listed.as_array().is_some_and(|devices| !devices.is_empty()), "{printed}");
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn the_device_is_measured_beside_the_processor() {
    let folder = Folder::new();
    let args = ["bench", "gpu", "--quick", "--rounds", "1", "-o", "out"];
    let (printed, _) = run(&mut folder.command(&args));
    assert!(printed.contains("Adapter: ") && printed.contains("unknown"), "{printed}");
    let read = |name: &str| folder.read(&format!("out/{name}"));
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
