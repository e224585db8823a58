//! The lines of a text file, and the numbers in them.

use crate::scene::SceneError;
use std::io::{self, BufRead, Read};
use std::ops::Range;
use std::path::Path;

/// Longest line in bytes: a longer one is a sign that the file is not text.
const LONGEST: u64 = 1 << 16;

/// A file's lines, one at a time.
pub(super) struct Lines<'p, R> {
    path: &'p Path,
    reader: R,
    number: usize,
    bytes: Vec<u8>,
}

/// One line without its end.
#[derive(Clone, Copy)]
pub(super) struct Line<'l> {
    path: &'l Path,
    number: usize,
    pub(super) text: &'l str,
}

impl<'p, R: BufRead> Lines<'p, R> {
    pub(super) fn new(path: &'p Path, reader: R) -> Self {
        Self { path, reader, number: 0, bytes: Vec::new() }
    }

    /// The next line, if there is one.
    pub(super) fn next(&mut self) -> Result<Option<Line<'_>>, SceneError> {
        self.bytes.clear();
        self.number += 1;
        let mut limited = self.reader.by_ref().take(LONGEST);
        let length = limited.read_until(b'\n', &mut self.bytes).map_err(|e| self.failed(&e))?;
        if length == 0 {
            return Ok(None);
        }
        if length as u64 == LONGEST && self.bytes.last() != Some(&b'\n') {
            let message = format!("line {} is longer than {LONGEST} bytes", self.number);
            return Err(SceneError::whole_file(self.path, message)
                .with_help("a file of particles has one line for each particle"));
        }
        let text = std::str::from_utf8(&self.bytes).map_err(|_| {
            let message = format!("line {} is not UTF-8 text", self.number);
            SceneError::whole_file(self.path, message)
        })?;
        let text = text.trim_start_matches('\u{FEFF}').trim_end_matches(['\n', '\r']);
        Ok(Some(Line { path: self.path, number: self.number, text }))
    }

    /// An error after the last line.
    pub(super) fn ended(&self, message: impl Into<String>) -> SceneError {
        SceneError::at(self.path, "", self.number, 0..0, message)
    }

    fn failed(&self, error: &io::Error) -> SceneError {
        SceneError::whole_file(
            self.path,
            format!("cannot be read at line {}: {error}", self.number),
        )
    }
}

impl<'l> Line<'l> {
    /// An error at these bytes of the line.
    pub(super) fn error(&self, span: Range<usize>, message: impl Into<String>) -> SceneError {
        SceneError::at(self.path, self.text, self.number, span, message)
    }

    /// An error that concerns the whole line.
    pub(super) fn whole(&self, message: impl Into<String>) -> SceneError {
        self.error(0..self.text.len(), message)
    }

    /// What stands between blanks, commas and semicolons before a comment, with its bytes.
    pub(super) fn fields(self) -> impl Iterator<Item = (Range<usize>, &'l str)> {
        let text = self.text.split('#').next().unwrap_or_default();
        text.split(|letter: char| letter.is_whitespace() || ",;".contains(letter))
            .filter(|field| !field.is_empty())
            .map(move |field| {
                let start = field.as_ptr() as usize - text.as_ptr() as usize;
                (start..start + field.len(), field)
            })
    }

    /// The number that a field is.
    pub(super) fn number(&self, (span, field): (Range<usize>, &str)) -> Result<f64, SceneError> {
        field.parse().map_err(|_| self.error(span, format!("`{field}` is not a number")))
    }
}
