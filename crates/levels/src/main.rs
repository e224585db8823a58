//! `bin/spherule` of packages: executes the program for the highest level that the processor has.
//!
//! The programs are `../libexec/spherule/spherule-LEVEL`, relative to the real path of this one. The
//! arguments, the environment and standard streams are theirs, and on Unix the process becomes theirs, so
//! that signals and exit codes need no help. Compiled for the baseline: it runs on every processor, and
//! the detection of the standard library, which takes what a program is compiled for as given, asks the
//! processor.

#![forbid(unsafe_code)]

use spherule_levels::Level;
use std::env;
use std::ffi::{OsStr, OsString};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// The environment variable that names the level to use.
const VARIABLE: &str = "SPHERULE_LEVEL";

fn main() -> ExitCode {
    let message = match start() {
        Ok(code) => return code,
        Err(message) => message,
    };
    // There is nowhere to report that standard error is closed.
    let _ = writeln!(io::stderr(), "error: {message}");
    ExitCode::FAILURE
}

/// Executes the program; returns only on failure, or where processes cannot be replaced.
fn start() -> Result<ExitCode, String> {
    let asked = env::var_os(VARIABLE).filter(|value| !value.is_empty());
    let launcher = env::current_exe().and_then(|path| path.canonicalize());
    let launcher =
        launcher.map_err(|error| format!("cannot find the path of this program: {error}"))?;
    let folder = folder_of_programs(&launcher)
        .ok_or_else(|| format!("{}: is not in a folder `bin`", launcher.display()))?;
    let levels = candidates(asked.as_deref(), Level::missing)?;
    let Some(program) =
        levels.iter().map(|&level| program(&folder, level)).find(|path| path.is_file())
    else {
        let names: Vec<&str> = levels.iter().map(|level| level.name()).collect();
        return Err(format!(
            "{}: has no program spherule-{}; unpack the archive or install the package again",
            folder.display(),
            names.join(" or spherule-"),
        ));
    };
    execute(&program).map_err(|error| format!("{}: cannot be executed: {error}", program.display()))
}

/// `libexec/spherule` beside the folder that the launcher is in.
fn folder_of_programs(launcher: &Path) -> Option<PathBuf> {
    Some(launcher.parent()?.parent()?.join("libexec").join("spherule"))
}

fn program(folder: &Path, level: Level) -> PathBuf {
    folder.join(format!("spherule-{}{}", level.name(), env::consts::EXE_SUFFIX))
}

/// Returns the levels to try in turn: the one that is asked for, or all that the processor has.
fn candidates(
    asked: Option<&OsStr>,
    missing: impl Fn(Level) -> Vec<&'static str>,
) -> Result<Vec<Level>, String> {
    let suited: Vec<Level> =
        Level::PACKAGED.iter().copied().filter(|&level| missing(level).is_empty()).collect();
    let list = |levels: &[Level]| {
        let names: Vec<&str> = levels.iter().rev().map(|level| level.name()).collect();
        names.join(", ")
    };
    let Some(&lowest) = Level::PACKAGED.last() else { return Ok(suited) };
    if suited.is_empty() {
        return Err(format!(
            "this processor lacks {}, which {lowest} has and every program of this package needs; build \
             Spherule from its source on this machine: cargo build --release",
            missing(lowest).join(", "),
        ));
    }
    let Some(asked) = asked else { return Ok(suited) };
    let level = asked.to_str().and_then(Level::from_name).ok_or_else(|| {
        let all = list(Level::PACKAGED);
        format!("{VARIABLE} is `{}`; use one of {all}, or unset it", asked.to_string_lossy())
    })?;
    if suited.contains(&level) {
        return Ok(vec![level]);
    }
    Err(format!(
        "{VARIABLE} is `{}`, but this processor lacks {}; use one of {}, or unset it",
        level.name(),
        missing(level).join(", "),
        list(&suited),
    ))
}

/// The program with this one's name and arguments.
fn command(program: &Path) -> Command {
    let mut words = env::args_os();
    let name = words.next().unwrap_or_else(|| OsString::from("spherule"));
    let mut command = Command::new(program);
    command.args(words);
    name_process(&mut command, &name);
    command
}

#[cfg(unix)]
fn name_process(command: &mut Command, name: &OsStr) {
    std::os::unix::process::CommandExt::arg0(command, name);
}

#[cfg(not(unix))]
fn name_process(_: &mut Command, _: &OsStr) {}

#[cfg(unix)]
fn execute(program: &Path) -> io::Result<ExitCode> {
    Err(std::os::unix::process::CommandExt::exec(&mut command(program)))
}

#[cfg(not(unix))]
fn execute(program: &Path) -> io::Result<ExitCode> {
    let status = command(program).status()?;
    Ok(status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from))
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    /// A processor that has everything up to a level.
    fn up_to(highest: Level) -> impl Fn(Level) -> Vec<&'static str> {
        move |level| if level <= highest { Vec::new() } else { vec!["avx512f", "avx512vl"] }
    }

    fn chosen(asked: Option<&str>, highest: Level) -> Result<Vec<Level>, String> {
        candidates(asked.map(OsStr::new), up_to(highest))
    }

    #[test]
    fn the_highest_level_comes_first() {
        assert_eq!(chosen(None, Level::V4), Ok(vec![Level::V4, Level::V3, Level::V2]));
        assert_eq!(chosen(None, Level::V3), Ok(vec![Level::V3, Level::V2]));
        assert_eq!(chosen(None, Level::V2), Ok(vec![Level::V2]));
        assert_eq!(chosen(Some("v2"), Level::V4), Ok(vec![Level::V2]));
    }

    #[test]
    fn levels_that_cannot_run_are_refused() {
        let message = |asked, highest| chosen(asked, highest).expect_err("refused");
        assert_eq!(
            message(Some("v4"), Level::V3),
            "SPHERULE_LEVEL is `v4`, but this processor lacks avx512f, avx512vl; use one of v2, v3, or \
             unset it"
        );
        assert_eq!(
            message(Some("fast"), Level::V3),
            "SPHERULE_LEVEL is `fast`; use one of v2, v3, v4, or unset it"
        );
        let none = message(None, Level::Baseline);
        assert!(
            none.starts_with("this processor lacks avx512f, avx512vl, which x86-64-v2 has"),
            "{none}"
        );
        assert!(none.ends_with("cargo build --release"), "{none}");
    }
}
