//! Extra columns, of numbers or texts depending on their first value.

use crate::categories::{Codebook, add};
use crate::{FileError, NumberColumn, TextColumn, lines::Line, number};

/// Returns whether a field is a missing value of CIF or of a table, or is not a number.
fn is_missing(field: &[u8]) -> bool {
    matches!(field, b"." | b"?") || number::is_missing(field) || field.eq_ignore_ascii_case(b"nan")
}

/// An extra column.
pub(crate) enum Extra {
    /// No value yet: the fields so far, which are kept if they turn out to be texts.
    Unknown(TextColumn, Box<Codebook>),
    Number(NumberColumn),
    Text(TextColumn, Box<Codebook>),
    /// Dropped.
    LeftOut,
}

impl Extra {
    /// Creates a column of unknown type.
    pub(crate) fn new(name: &str) -> Self {
        Self::Unknown(TextColumn { name: name.to_owned(), ..TextColumn::default() }, Box::default())
    }

    /// Sets the type of a column in one of these lists, if it is unknown.
    pub(crate) fn declare(&mut self, texts: &[&str], numbers: &[&str]) {
        let Self::Unknown(column, _) = self else { return };
        let is_in = |names: &[&str]| names.contains(&column.name.as_str());
        if is_in(texts) {
            self.become_text();
        } else if is_in(numbers) {
            self.become_number();
        }
    }

    /// Appends a field.
    pub(crate) fn put(&mut self, line: &Line, field: &[u8]) -> Result<(), FileError> {
        if matches!(self, Self::Unknown(..)) && !is_missing(field) {
            match number::parse(field) {
                Some(_) => self.become_number(),
                None => self.become_text(),
            }
        }
        match self {
            Self::LeftOut => (),
            Self::Number(column) => column.values.push(match number::parse(field) {
                Some(value) => value,
                None if is_missing(field) => f64::NAN,
                None => line.number(field)?,
            }),
            Self::Unknown(column, book) | Self::Text(column, book) => {
                push_text(column, book, field);
            }
        }
        Ok(())
    }

    /// Appends a number; ignored if it is a column of texts.
    pub(crate) fn put_number(&mut self, value: f64) {
        if matches!(self, Self::Unknown(..)) {
            self.become_number();
        }
        if let Self::Number(column) = self {
            column.values.push(value);
        }
    }

    /// Appends a text; ignored if it is a column of numbers.
    pub(crate) fn put_text(&mut self, text: &str) {
        if matches!(self, Self::Unknown(..)) {
            self.become_text();
        }
        if let Self::Text(column, book) = self {
            push_text(column, book, text.as_bytes());
        }
    }

    fn become_number(&mut self) {
        let Self::Unknown(column, _) = self else { return };
        let values = vec![f64::NAN; column.codes.len()];
        *self = Self::Number(NumberColumn { name: std::mem::take(&mut column.name), values });
    }

    fn become_text(&mut self) {
        let Self::Unknown(column, book) = self else { return };
        *self = Self::Text(std::mem::take(column), std::mem::take(book));
    }

    /// Moves the column to `numbers` or `texts`. A column without values becomes texts if it has rows, and none is `nan`.
    pub(crate) fn finish(mut self, numbers: &mut Vec<NumberColumn>, texts: &mut Vec<TextColumn>) {
        if let Self::Unknown(column, _) = &self {
            let is_nan = |name: &String| number::parse(name.as_bytes()).is_some();
            if column.codes.is_empty() || column.names.iter().any(is_nan) {
                self.become_number();
            } else {
                self.become_text();
            }
        }
        match self {
            Self::Unknown(..) | Self::LeftOut => (),
            Self::Number(column) => numbers.push(column),
            Self::Text(column, _) => texts.push(column),
        }
    }
}

fn push_text(column: &mut TextColumn, book: &mut Codebook, field: &[u8]) {
    let TextColumn { names, codes, .. } = column;
    codes.push(book.code(field, |name| add(names, name)));
}
