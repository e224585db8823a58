//! Results on standard output, messages on standard error.
//!
//! A reader that has gone away (a broken pipe) is no error. Any other failure to write is kept until the
//! command has done its work, and then decides the exit code: see [`finish`].

use serde::Serialize;
use std::fmt::{Arguments, Display};
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bold and colored where the terminal takes it; `anstream` strips it elsewhere.
const ERROR: &str = "\x1b[1;31m";
const WARNING: &str = "\x1b[1;33m";
const NOTE: &str = "\x1b[1;36m";
const RESET: &str = "\x1b[0m";

/// The first failure to write standard output. Nothing is written after it: a result with a gap is worse
/// than one that ends.
static OUTPUT_FAILURE: OnceLock<io::Error> = OnceLock::new();

/// True once a message could not be written to standard error.
static MESSAGE_LOST: AtomicBool = AtomicBool::new(false);

/// True once standard output takes a picture.
static RESERVED: AtomicBool = AtomicBool::new(false);

/// Prints a line on standard output: what was asked for.
pub(super) fn print(text: impl Display) {
    write(format_args!("{text}\n"));
}

/// Prints text on standard output as it is, without an end of line.
pub(super) fn write(text: Arguments) {
    if RESERVED.load(Ordering::Relaxed) {
        return tell_text(text);
    }
    if OUTPUT_FAILURE.get().is_some() {
        return;
    }
    let mut output = anstream::stdout().lock();
    record(output.write_fmt(text).and_then(|()| output.flush()));
}

/// Leaves standard output to a picture: from now on results are printed on standard error.
pub(super) fn reserve_for_picture() {
    RESERVED.store(true, Ordering::Relaxed);
}

/// Writes a file's content to standard output.
pub(super) fn write_bytes(content: &[u8]) {
    let mut output = io::stdout().lock();
    record(output.write_all(content).and_then(|()| output.flush()));
}

/// Prints one JSON object on standard output.
pub(super) fn print_json(object: &impl Serialize) {
    match serde_json::to_string_pretty(object) {
        Ok(text) => print(text),
        Err(error) => record(Err(error.into())),
    }
}

/// Tells the user what may be worth knowing.
pub(super) fn note(text: impl Display) {
    tell(NOTE, "note", text);
}

/// Tells the user that the result is not what it seems.
pub(super) fn warn(text: impl Display) {
    tell(WARNING, "warning", text);
}

/// Tells the user why there is no result.
pub(super) fn error(text: impl Display) {
    tell(ERROR, "error", text);
}

/// Prints a line on standard error as it is.
pub(super) fn tell_plain(text: impl Display) {
    tell_text(format_args!("{text}\n"));
}

fn tell_text(text: Arguments) {
    if is_lost(&anstream::stderr().lock().write_fmt(text)) {
        MESSAGE_LOST.store(true, Ordering::Relaxed);
    }
}

/// Reports standard output that could not be written, and returns the exit code of the program: `code`, or
/// that of a failure if a result or a message was lost.
pub(crate) fn finish(code: ExitCode) -> ExitCode {
    if let Some(failure) = OUTPUT_FAILURE.get() {
        error(format_args!("standard output cannot be written: {failure}"));
    } else if !MESSAGE_LOST.load(Ordering::Relaxed) {
        return code;
    }
    if code == ExitCode::SUCCESS { ExitCode::FAILURE } else { code }
}

fn tell(style: &str, kind: &str, text: impl Display) {
    tell_plain(format_args!("{style}{kind}:{RESET} {text}"));
}

/// Keeps the first failure to write standard output.
fn record(written: io::Result<()>) {
    if is_lost(&written)
        && let Err(error) = written
    {
        // Of two failures at once the first one counts.
        let _ = OUTPUT_FAILURE.set(error);
    }
}

/// Returns whether text was lost that somebody could have read.
fn is_lost(written: &io::Result<()>) -> bool {
    written.as_ref().is_err_and(|error| error.kind() != ErrorKind::BrokenPipe)
}
