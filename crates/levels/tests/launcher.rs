//! The launcher beside shell scripts in place of programs.
#![cfg(unix)]

#[path = "../../../tests/common/process.rs"]
mod process;

use process::{Process, run};
use spherule_levels::Level;
use std::ffi::OsStr;
use std::fs;
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A package with the launcher and scripts for these levels, in a folder with a space in its name.
struct Package {
    folder: TempDir,
}

impl Package {
    fn new(levels: &[Level], script: &str) -> Self {
        let folder = tempfile::Builder::new().prefix("with space ").tempdir().expect("a folder");
        let package = Self { folder };
        for path in ["bin", "libexec/spherule"] {
            fs::create_dir_all(package.path(path)).expect("a folder");
        }
        // A copy, since the path of a link would be that of the build folder.
        fs::copy(env!("CARGO_BIN_EXE_spherule-launcher"), package.path("bin/spherule"))
            .expect("a copy");
        for level in levels {
            let path = package.path(&format!("libexec/spherule/spherule-{}", level.name()));
            let script = format!("#!/bin/sh\nlevel={}\n{script}\n", level.name());
            fs::write(&path, script).expect("a script");
            fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("a mode");
        }
        package
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self) -> Command {
        let mut command = Command::new(self.path("bin/spherule"));
        command.env_clear();
        command
    }
}

fn best() -> Level {
    Level::of_processor()
}

#[test]
fn the_best_program_gets_arguments_and_environment_as_they_are() {
    let package = Package::new(Level::PACKAGED, r#"printf '%s|' "$level" "$@" "$VALUE""#);
    let odd = OsStr::from_bytes(b"not \xff UTF-8");
    let output = run(package.command().args(["render", "", "a b"]).arg(odd).env("VALUE", odd));
    let expected =
        [best().name().as_bytes(), b"|render||a b|not \xff UTF-8|not \xff UTF-8|"].concat();
    assert_eq!(output.stdout, expected, "{}", String::from_utf8_lossy(&output.stderr));
    assert!(output.stderr.is_empty());
}

#[test]
fn links_lead_to_the_package() {
    let package = Package::new(Level::PACKAGED, "echo $level");
    let other = tempfile::tempdir().expect("a folder");
    let link = other.path().join("render spheres");
    symlink(package.path("bin/spherule"), &link).expect("a link");
    for path in [&link, Path::new("/proc/self/cwd/render spheres")] {
        let output = run(Command::new(path).env_clear().current_dir(other.path()));
        assert_eq!(output.stdout, format!("{}\n", best().name()).into_bytes(), "{path:?}");
    }
}

#[test]
fn the_process_becomes_the_programs() {
    let package = Package::new(Level::PACKAGED, "echo $$; exit 37");
    let launcher = Process::start(package.command().stdout(Stdio::piped()));
    let id = launcher.id();
    let output = launcher.end();
    assert_eq!(output.status.code(), Some(37));
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), id.to_string());
    let package = Package::new(Level::PACKAGED, "kill -TERM $$");
    assert_eq!(run(&mut package.command()).status.signal(), Some(15));
}

#[test]
fn the_name_of_the_program_is_that_of_the_launcher() {
    let package = Package::new(&[], "");
    let program = package.path(&format!("libexec/spherule/spherule-{}", best().name()));
    symlink("/bin/sh", &program).expect("a link");
    let mut command = package.command();
    command.arg0("renderer").args(["-c", "echo $0"]);
    assert_eq!(run(&mut command).stdout, b"renderer\n");
}

#[test]
fn the_next_level_runs_where_the_best_is_not_installed() {
    let lowest = *Level::PACKAGED.last().expect("a level");
    let package = Package::new(&[lowest], "echo $level");
    let output = run(&mut package.command());
    assert_eq!(output.stdout, format!("{}\n", lowest.name()).into_bytes());
}

#[test]
fn levels_can_be_forced() {
    let package = Package::new(Level::PACKAGED, "echo $level");
    for level in Level::PACKAGED.iter().filter(|level| level.missing().is_empty()) {
        let output = run(package.command().env("SPHERULE_LEVEL", level.name()));
        assert_eq!(output.stdout, format!("{}\n", level.name()).into_bytes());
    }
    assert_eq!(run(package.command().env("SPHERULE_LEVEL", "")).status.code(), Some(0));
    let output = run(package.command().env("SPHERULE_LEVEL", "v1"));
    assert_eq!(output.status.code(), Some(1));
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(message.starts_with("error: SPHERULE_LEVEL is `v1`; use one of "), "{message}");
}

#[test]
fn missing_programs_are_named() {
    let package = Package::new(&[], "");
    let output = run(&mut package.command());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{message}");
    let expected = format!("libexec/spherule: has no program spherule-{}", best().name());
    assert!(
        message.contains(&expected) && message.contains("install the package again"),
        "{message}"
    );
    let program = package.path(&format!("libexec/spherule/spherule-{}", best().name()));
    fs::write(&program, "no program").expect("a file");
    let message = String::from_utf8_lossy(&run(&mut package.command()).stderr).into_owned();
    assert!(message.contains("cannot be executed: Permission denied"), "{message}");
}
