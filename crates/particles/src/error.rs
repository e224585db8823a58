//! Errors in files: the file, the position in it, and advice.

use crate::suggest;
use std::fmt::{self, Debug, Formatter};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::{fs, io};
use thiserror::Error;

/// Maximum number of characters of a message or a help.
const LONGEST: usize = 600;

/// An error in a file of particles, or in a scene file. Prints as `path:line:column: message` and, on a
/// second line, the help.
#[derive(Clone, Error)]
#[error("{}: {message}{}", self.location(), self.advice())]
pub struct FileError {
    /// The faulty file.
    pub path: PathBuf,
    /// The message: one sentence without a full stop.
    pub message: String,
    /// Advice: what to write instead, if known.
    pub help: Option<String>,
    /// The position in the file; `None` if the error concerns the whole file.
    pub place: Option<Box<Place>>,
    /// True if the file ends before what it announces: it is cut off, or still being written.
    pub cut_off: bool,
}

/// A position in a file, with the surrounding text for display.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The file's text or, from a file of particles, the faulty line alone.
    pub source_text: String,
    /// The line of the file that `source_text` begins with, from 1.
    pub first_line: usize,
    /// The faulty bytes of `source_text`.
    pub span: Range<usize>,
}

impl Debug for FileError {
    /// The text of the error, which `main` prints if it returns one: not that of the file.
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        write!(formatter, "{self}")
    }
}

/// Number of names of a folder among which one is looked for that is meant.
const NAMES: usize = 10_000;

/// Returns the file of the same folder whose name is nearest to a missing one's.
fn near(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let entries = fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?.take(NAMES);
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let names: Vec<String> = names.collect();
    let near = suggest::nearest(path.file_name()?.to_str()?, names.iter().map(String::as_str));
    Some(path.with_file_name(near?))
}

impl FileError {
    /// Returns an error that concerns a whole file.
    pub fn whole_file(path: &Path, message: impl Into<String>) -> Self {
        let message = clipped(message);
        Self { path: path.to_path_buf(), message, help: None, place: None, cut_off: false }
    }

    /// Returns the error of a file that the system does not read, with the nearest name in its folder if it is not there.
    pub fn unreadable(path: &Path, error: &io::Error) -> Self {
        let fault = Self::whole_file(path, format!("cannot be read: {error}"));
        let near = if error.kind() == io::ErrorKind::NotFound { near(path) } else { None };
        match near {
            Some(near) => fault.with_help(format!("did you mean `{}`?", near.display())),
            None => fault,
        }
    }

    /// Returns an error at the bytes `span` of `text`, which begins at line `first_line` of the file.
    pub fn at(
        path: &Path,
        text: &str,
        first_line: usize,
        span: Range<usize>,
        message: impl Into<String>,
    ) -> Self {
        let place = Place::new(text, first_line, span);
        Self { place: Some(Box::new(place)), ..Self::whole_file(path, message) }
    }

    /// Returns the error with advice.
    #[must_use]
    pub fn with_help(self, help: impl Into<String>) -> Self {
        Self { help: Some(clipped(help)), ..self }
    }

    /// Returns the line of the fault, from 1; `None` if the error concerns the whole file.
    pub fn line(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.line)
    }

    /// Returns the column of the fault in characters, from 1; `None` if the error concerns the whole file.
    pub fn column(&self) -> Option<usize> {
        self.place.as_ref().map(|place| place.column)
    }

    fn location(&self) -> String {
        let path = self.path.display();
        self.place
            .as_ref()
            .map_or_else(|| path.to_string(), |at| format!("{path}:{}:{}", at.line, at.column))
    }

    fn advice(&self) -> String {
        self.help.as_ref().map_or_else(String::new, |help| format!("\nhelp: {help}"))
    }
}

/// Truncates a text to the maximum length: a name in a damaged file may be as long as the file.
pub fn clipped(text: impl Into<String>) -> String {
    let mut text = text.into();
    if let Some((end, _)) = text.char_indices().nth(LONGEST) {
        text.truncate(end);
        text.push_str("...");
    }
    text
}

/// Maximum number of names in a warning.
pub(crate) const LISTED: usize = 5;

/// Returns a message with the first few names.
pub fn listed(reason: &str, names: &[&str]) -> String {
    let more = if names.len() > LISTED { ", ..." } else { "" };
    format!("{reason}: {}{more}", names[..names.len().min(LISTED)].join(", "))
}

impl Place {
    fn new(text: &str, first_line: usize, span: Range<usize>) -> Self {
        let start =
            (0..=span.start.min(text.len())).rev().find(|&byte| text.is_char_boundary(byte));
        let before = &text[..start.unwrap_or(0)];
        let end =
            (span.end.max(before.len())..text.len()).find(|&byte| text.is_char_boundary(byte));
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            line: first_line + before.matches('\n').count(),
            column: before[line_start..].chars().count() + 1,
            source_text: text.to_owned(),
            first_line,
            span: before.len()..end.unwrap_or(text.len()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_characters_from_one() {
        let error = FileError::at(Path::new("a.toml"), "x\nä = 1\ny", 1, 5..6, "bad");
        assert_eq!((error.line(), error.column()), (Some(2), Some(3)));
        assert_eq!(error.to_string(), "a.toml:2:3: bad");
        assert_eq!(format!("{error:?}"), "a.toml:2:3: bad");
        let helped = FileError::whole_file(Path::new("b"), "bad").with_help("do");
        assert_eq!(helped.to_string(), "b: bad\nhelp: do");
    }

    #[test]
    fn long_messages_are_shortened() {
        let error = FileError::whole_file(Path::new("a"), "\u{e4}".repeat(1_000_000));
        let error = error.with_help("b".repeat(LONGEST));
        assert_eq!(error.message.chars().count(), LONGEST + 3);
        assert_eq!(error.help.map(|help| help.len()), Some(LONGEST));
    }

    #[test]
    fn positions_outside_the_text_are_at_its_end() {
        let error = FileError::at(Path::new("a"), "ab\n", 7, 90..95, "bad");
        assert_eq!((error.line(), error.column()), (Some(8), Some(1)));
        let inside_a_character = FileError::at(Path::new("a"), "ä", 1, 1..2, "bad");
        assert_eq!(inside_a_character.column(), Some(1));
    }

    #[test]
    fn long_lists_are_cut_short() {
        let names: Vec<&str> = vec!["a"; LISTED + 1];
        assert_eq!(listed("unused", &names[..2]), "unused: a, a");
        assert!(!listed("unused", &names[..LISTED]).contains("..."));
        let cut = listed("unused", &names);
        assert!(cut.ends_with(", ...") && cut.matches('a').count() == LISTED, "{cut}");
    }
}
