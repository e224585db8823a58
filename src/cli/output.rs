//! What goes to the terminal. A reader that has gone away is no error.

use serde::Serialize;
use std::fmt::Display;
use std::io::Write;

/// Bold and colored where the terminal takes it; `anstream` strips it elsewhere.
const ERROR: &str = "\x1b[1;31m";
const WARNING: &str = "\x1b[1;33m";
const NOTE: &str = "\x1b[1;36m";
const RESET: &str = "\x1b[0m";

/// A line on standard output: what was asked for.
pub(super) fn print(text: impl Display) {
    let mut output = anstream::stdout().lock();
    let _ = writeln!(output, "{text}").and_then(|()| output.flush());
}

/// One JSON object on standard output.
pub(super) fn print_json(object: &impl Serialize) {
    // Only maps whose keys are no strings, and readers of files, could fail.
    print(serde_json::to_string_pretty(object).unwrap_or_default());
}

/// What the user may want to know.
pub(super) fn note(text: impl Display) {
    tell(NOTE, "note", text);
}

/// What the user must know: the result is not what it seems.
pub(super) fn warn(text: impl Display) {
    tell(WARNING, "warning", text);
}

/// Why there is no result.
pub(super) fn error(text: impl Display) {
    tell(ERROR, "error", text);
}

/// A line on standard error as it is.
pub(super) fn tell_plain(text: impl Display) {
    let _ = writeln!(anstream::stderr().lock(), "{text}");
}

fn tell(style: &str, kind: &str, text: impl Display) {
    tell_plain(format_args!("{style}{kind}:{RESET} {text}"));
}
