//! Results on standard output, messages on standard error.
//!
//! A closed reader (a broken pipe) is no error. Any other failure to write is stored until the command is
//! done, and then determines the exit code: see [`finish`].

use serde::Serialize;
use std::fmt::{Arguments, Display};
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bold and colored on terminals; `anstream` strips the codes elsewhere.
const ERROR: &str = "\x1b[1;31m";
const WARNING: &str = "\x1b[1;33m";
const NOTE: &str = "\x1b[1;36m";
const RESET: &str = "\x1b[0m";

/// The first failure to write standard output. Nothing is written after it: a result with a gap is worse
/// than one that ends.
static OUTPUT_FAILURE: OnceLock<io::Error> = OnceLock::new();

/// True once a message could not be written to standard error.
static MESSAGE_LOST: AtomicBool = AtomicBool::new(false);

/// True once standard output is reserved for an image.
static RESERVED: AtomicBool = AtomicBool::new(false);

/// Prints a line of results to standard output.
pub(super) fn print(text: impl Display) {
    write(format_args!("{text}\n"));
}

/// Prints text to standard output, without adding an end of line.
pub(super) fn write(text: Arguments) {
    if RESERVED.load(Ordering::Relaxed) {
        return write_error(text);
    }
    if OUTPUT_FAILURE.get().is_some() {
        return;
    }
    let mut output = anstream::stdout().lock();
    record(output.write_fmt(text).and_then(|()| output.flush()));
}

/// Reserves standard output for an image: from now on results are printed to standard error.
pub(super) fn reserve_for_picture() {
    RESERVED.store(true, Ordering::Relaxed);
}

/// Writes a file's content to standard output.
pub(super) fn write_bytes(content: &[u8]) {
    let mut output = io::stdout().lock();
    record(output.write_all(content).and_then(|()| output.flush()));
}

/// Prints one JSON object to standard output.
pub(super) fn print_json(object: &impl Serialize) {
    match serde_json::to_string_pretty(object) {
        Ok(text) => print(text),
        Err(error) => record(Err(error.into())),
    }
}

/// Prints a note.
pub(super) fn note(text: impl Display) {
    print_message(NOTE, "note", text);
}

/// Prints a warning.
pub(super) fn warn(text: impl Display) {
    print_message(WARNING, "warning", text);
}

/// Prints an error.
pub(super) fn error(text: impl Display) {
    print_message(ERROR, "error", text);
}

/// Prints a line to standard error.
pub(super) fn print_error_line(text: impl Display) {
    write_error(format_args!("{text}\n"));
}

fn write_error(text: Arguments) {
    if is_lost(&anstream::stderr().lock().write_fmt(text)) {
        MESSAGE_LOST.store(true, Ordering::Relaxed);
    }
}

/// Reports failures to write standard output, and returns the exit code of the program: `code`, or that of a
/// failure if a result or a message was lost.
pub(crate) fn finish(code: ExitCode) -> ExitCode {
    if let Some(failure) = OUTPUT_FAILURE.get() {
        error(format_args!("standard output cannot be written: {failure}"));
    } else if !MESSAGE_LOST.load(Ordering::Relaxed) {
        return code;
    }
    if code == ExitCode::SUCCESS { ExitCode::FAILURE } else { code }
}

fn print_message(style: &str, kind: &str, text: impl Display) {
    print_error_line(format_args!("{style}{kind}:{RESET} {text}"));
}

/// Keeps the first failure to write standard output.
fn record(written: io::Result<()>) {
    if is_lost(&written)
        && let Err(error) = written
    {
        // Of two simultaneous failures the first one counts.
        let _ = OUTPUT_FAILURE.set(error);
    }
}

/// Returns whether text was lost that somebody could have read.
fn is_lost(written: &io::Result<()>) -> bool {
    written.as_ref().is_err_and(|error| error.kind() != ErrorKind::BrokenPipe)
}
