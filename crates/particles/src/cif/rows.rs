//! The rows of a loop of a CIF file.

use super::tokens::{Token, Tokens};
use crate::FileError;

/// The rows of a loop, one at a time.
pub(super) struct Rows {
    columns: usize,
    /// The values of the row, one after another, and where each ends.
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Rows {
    /// Of a loop of so many columns, at least one.
    pub(super) fn new(columns: usize) -> Self {
        Self { columns, bytes: Vec::new(), ends: Vec::new() }
    }

    /// Reads a row; whether there is one more.
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
            self.bytes.extend_from_slice(value);
            self.ends.push(self.bytes.len());
        }
        Ok(true)
    }

    /// A value of the row.
    pub(super) fn field(&self, column: usize) -> &[u8] {
        let start = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.bytes[start..self.ends[column]]
    }

    /// All values of the row.
    pub(super) fn fields(&self) -> impl Iterator<Item = &[u8]> {
        (0..self.ends.len()).map(|column| self.field(column))
    }
}
