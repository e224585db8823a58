//! The rows of a loop of a CIF file.

use super::tokens::{Token, Tokens};
use crate::{FileError, ParticleFrame};

/// Reader of the rows of a loop.
#[derive(Clone)]
pub(super) struct Rows {
    columns: usize,
    /// Values of the current row, concatenated, and their end offsets.
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Rows {
    /// Creates a reader of rows with `columns` values, at least one.
    pub(super) fn new(columns: usize) -> Self {
        Self { columns, bytes: Vec::new(), ends: Vec::new() }
    }

    /// Appends a value to the row.
    pub(super) fn push(&mut self, value: &[u8]) {
        self.bytes.extend_from_slice(value);
        self.ends.push(self.bytes.len());
    }

    /// Reads the next row. Returns whether there was one.
    pub(super) fn read(&mut self, tokens: &mut Tokens) -> Result<bool, FileError> {
        self.bytes.clear();
        self.ends.clear();
        while self.ends.len() < self.columns {
            let Some(Token::Value(value)) = tokens.next()? else {
                tokens.back();
                if self.ends.is_empty() {
                    return Ok(false);
                }
                let (count, columns) = (self.ends.len(), self.columns);
                let error = tokens
                    .error(format!("a row of {count} values, but there are {columns} columns"));
                return Err(error.with_help("the file is cut off, or a quote is not closed"));
            };
            self.push(value);
        }
        Ok(true)
    }

    /// Passes over the rows of a loop with so many columns. Returns their number.
    pub(super) fn count(tokens: &mut Tokens, columns: usize) -> Result<u64, FileError> {
        let (mut rows, mut count) = (Self::new(columns), 0);
        while rows.read(tokens)? {
            count += 1;
        }
        Ok(count)
    }

    /// Returns a value of the row.
    pub(super) fn field(&self, column: usize) -> &[u8] {
        let start = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.bytes[start..self.ends[column]]
    }

    /// Returns all values of the row.
    pub(super) fn fields(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.ends.len()).map(|column| self.field(column))
    }
}

/// Returns whether a row of atoms is a dummy site, such as the center of a ring, by its column of calculated positions.
pub(super) fn is_dummy(rows: &Rows, calculated: Option<usize>) -> bool {
    calculated.is_some_and(|column| rows.field(column).eq_ignore_ascii_case(b"dum"))
}

/// Adds a warning that dummy sites are left out, if there are any.
pub(super) fn add_dummies(frame: &mut ParticleFrame, dummies: u64) {
    let text = match dummies {
        0 => return,
        1 => "1 dummy site is left out".to_owned(),
        _ => format!("{dummies} dummy sites are left out"),
    };
    frame.warnings.push(text);
}
