//! A temporary folder for a test.

#![allow(dead_code, reason = "each test crate uses its own part of this")]

use crate::process::run;
use serde_json::Value;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Arguments of a small image of plastic, metal and glass.
pub(crate) const SMALL: [&str; 6] = ["render", "--size", "40x24", "--spp", "4", "--quiet"];

/// A folder that is removed after the test.
pub(crate) struct Folder(TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    /// Returns a command for the program in the folder.
    pub(crate) fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(program());
        command.args(args).current_dir(&self.0);
        command
    }

    /// Runs the program in the folder.
    #[track_caller]
    pub(crate) fn run(&self, args: &[&str]) -> Output {
        run(&mut self.command(args))
    }

    /// Runs a line of a shell in the folder; `$0` is the program, and `$@` are the arguments.
    #[track_caller]
    pub(crate) fn shell(&self, line: &str, args: &[&str]) -> Output {
        let mut shell = Command::new("sh");
        shell.args(["-c", line]).arg(program()).args(args);
        run(shell.current_dir(&self.0))
    }

    /// Runs the program, asserts success, and returns its output.
    #[track_caller]
    pub(crate) fn succeed(&self, args: &[&str]) -> String {
        let output = self.run(args);
        assert!(output.status.success(), "{args:?}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    /// Runs the program and returns its output as JSON.
    pub(crate) fn json(&self, args: &[&str]) -> Value {
        serde_json::from_str(&self.succeed(args)).expect("one JSON object")
    }

    /// Returns the bytes of a small image.
    pub(crate) fn picture(&self, name: &str, args: &[&str]) -> Vec<u8> {
        let output = self.succeed(&[&SMALL, &["-o", name][..], args].concat());
        assert!(output.is_empty(), "{output}");
        self.read(name)
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).expect("a file that is there")
    }

    pub(crate) fn write(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).expect("a folder that takes files");
    }

    /// Returns the path of a file in the folder.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn root(&self) -> &Path {
        self.0.path()
    }
}

/// Returns the path of the program: that of the variable if there is one, as on another machine by `tools/gpu-check`.
fn program() -> OsString {
    let variable = std::env::var_os("CARGO_BIN_EXE_spherule");
    variable.unwrap_or_else(|| env!("CARGO_BIN_EXE_spherule").into())
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
