//! One line of a text file, and the numbers in it.

use super::{fields::Fields, number};
use crate::FileError;
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Returns whether a line is a comment, as programs for rows of numbers write it.
pub(crate) fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"%")
}

/// One line without its end.
#[derive(Clone, Copy)]
pub(crate) struct Line<'l> {
    path: &'l Arc<Path>,
    number: usize,
    pub(crate) bytes: &'l [u8],
}

impl<'l> Line<'l> {
    pub(crate) fn new(path: &'l Arc<Path>, number: usize, bytes: &'l [u8]) -> Self {
        Self { path, number, bytes }
    }

    pub(crate) fn path(&self) -> &'l Arc<Path> {
        self.path
    }

    /// Line of the file, from 1.
    pub(crate) fn number_in_file(&self) -> usize {
        self.number
    }

    /// An error at these bytes of the line.
    pub(crate) fn error(&self, span: Range<usize>, message: impl Into<String>) -> FileError {
        let length =
            |end: usize| String::from_utf8_lossy(&self.bytes[..end.min(self.bytes.len())]).len();
        let span = length(span.start)..length(span.end);
        FileError::at(self.path, &self.text(), self.number, span, message)
    }

    /// An error at a part of the line; at all of it, if the field is a copy.
    pub(crate) fn error_at(&self, field: &[u8], message: impl Into<String>) -> FileError {
        let start = (field.as_ptr() as usize).wrapping_sub(self.bytes.as_ptr() as usize);
        if start > self.bytes.len() {
            return self.whole(message);
        }
        self.error(start..start + field.len(), message)
    }

    /// An error that concerns the whole line.
    pub(crate) fn whole(&self, message: impl Into<String>) -> FileError {
        self.error(0..self.bytes.len(), message)
    }

    /// The line as text; what is not UTF-8 becomes replacement characters.
    pub(crate) fn text(&self) -> Cow<'l, str> {
        String::from_utf8_lossy(self.bytes)
    }

    /// Returns the fields between blanks.
    pub(crate) fn fields(&self) -> Fields<'l> {
        Fields::blanks(self.bytes)
    }

    /// Whether the line is blank.
    pub(crate) fn is_blank(&self) -> bool {
        self.bytes.trim_ascii().is_empty()
    }

    /// The number that a part of the line is.
    #[inline]
    pub(crate) fn number(&self, field: &[u8]) -> Result<f64, FileError> {
        number::parse(field).ok_or_else(|| self.not(field, "a number"))
    }

    /// The whole number that a part of the line is.
    pub(crate) fn whole_number(&self, field: &[u8]) -> Result<u64, FileError> {
        number::whole(field).ok_or_else(|| self.not(field, "a whole number"))
    }

    fn not(&self, field: &[u8], what: &str) -> FileError {
        let field = field.trim_ascii();
        let shown = String::from_utf8_lossy(field);
        let error = self.error_at(field, format!("`{shown}` is not {what}"));
        if number::with_point(field).is_none() {
            return error;
        }
        let help = "numbers have decimal points here; `sed 's/\\([0-9]\\),\\([0-9]\\)/\\1.\\2/g'` makes them of \
                    decimal commas";
        error.with_help(help)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_at_the_bytes_of_a_part() {
        let (path, text) = (Path::new("p").into(), b"ab cd \xC3\xA4f".to_vec());
        let line = Line::new(&path, 3, &text);
        let copy = b"cd".to_vec();
        for (field, column, span) in [
            (&text[3..5], 4, 3..5),
            (&text[6..], 7, 6..9),
            (&text[9..], 9, 9..9),
            // A copy may stand anywhere in the line.
            (&copy[..], 1, 0..9),
        ] {
            let place = line.error_at(field, "wrong").place.expect("a place");
            assert_eq!((place.line, place.column, place.span), (3, column, span));
        }
    }
}
