//! A line of a text file, its end, and its numbers.

use crate::{FileError, fields::Fields, number};
use memchr::memchr;
use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Number of lines at the beginning of a file of which any may tell its format.
pub(crate) const FIRST: usize = 1000;

/// Returns whether a line is a comment of a numeric table.
pub(crate) fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"%")
}

/// Makes newlines of the carriage returns that end lines by themselves, as on the first Macintosh. Those before a newline belong
/// to it. Returns the offset of those at the end, which the next byte decides, or else the length.
pub(crate) fn end_lines(text: &mut [u8]) -> usize {
    let mut at = 0;
    while let Some(found) = memchr(b'\r', &text[at..]) {
        let first = at + found;
        at = first + text[first..].iter().take_while(|&&byte| byte == b'\r').count();
        match text.get(at) {
            None => return first,
            Some(b'\n') => (),
            Some(_) => text[first..at].fill(b'\n'),
        }
    }
    text.len()
}

/// A line without its line ending.
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

    /// Returns the line up to a comment, which begins with any of these marks.
    pub(crate) fn without_comment(self, marks: &[u8]) -> Self {
        let end = self.bytes.iter().position(|byte| marks.contains(byte));
        Self { bytes: &self.bytes[..end.unwrap_or(self.bytes.len())], ..self }
    }

    pub(crate) fn path(&self) -> &'l Arc<Path> {
        self.path
    }

    /// Returns the line's number in the file, from 1.
    pub(crate) fn number_in_file(&self) -> usize {
        self.number
    }

    /// Returns an error at these bytes of the line.
    pub(crate) fn error(&self, span: Range<usize>, message: impl Into<String>) -> FileError {
        let length =
            |end: usize| String::from_utf8_lossy(&self.bytes[..end.min(self.bytes.len())]).len();
        let span = length(span.start)..length(span.end);
        FileError::at(self.path, &self.text(), self.number, span, message)
    }

    /// Returns an error at a field of the line; at the whole line if the field is a copy.
    pub(crate) fn error_at(&self, field: &[u8], message: impl Into<String>) -> FileError {
        let start = (field.as_ptr() as usize).wrapping_sub(self.bytes.as_ptr() as usize);
        if start > self.bytes.len() {
            return self.whole(message);
        }
        self.error(start..start + field.len(), message)
    }

    /// Returns an error that concerns the whole line.
    pub(crate) fn whole(&self, message: impl Into<String>) -> FileError {
        self.error(0..self.bytes.len(), message)
    }

    /// Returns the line as text; invalid UTF-8 becomes replacement characters.
    pub(crate) fn text(&self) -> Cow<'l, str> {
        String::from_utf8_lossy(self.bytes)
    }

    /// Returns the blank-separated fields.
    pub(crate) fn fields(&self) -> Fields<'l> {
        Fields::blanks(self.bytes)
    }

    /// Returns whether the line is blank.
    pub(crate) fn is_blank(&self) -> bool {
        self.bytes.trim_ascii().is_empty()
    }

    /// Parses a field as a number.
    #[inline]
    pub(crate) fn number(&self, field: &[u8]) -> Result<f64, FileError> {
        number::parse(field).ok_or_else(|| self.not(field, "a number"))
    }

    /// Parses a field as a number, or as a missing one, which is NaN.
    #[inline]
    pub(crate) fn number_or_missing(&self, field: &[u8]) -> Result<f64, FileError> {
        match number::parse(field) {
            Some(number) => Ok(number),
            None if number::is_missing(field) => Ok(f64::NAN),
            None => Err(self.not(field, "a number")),
        }
    }

    /// Parses a field as a whole number.
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
            // The position of a copy in the line is unknown.
            (&copy[..], 1, 0..9),
        ] {
            let place = line.error_at(field, "wrong").place.expect("a place");
            assert_eq!((place.line, place.column, place.span), (3, column, span));
        }
    }
}
