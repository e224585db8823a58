//! Extra columns, of numbers or texts depending on their first value.

use crate::categories::{Codebook, add};
use crate::{FileError, NumberColumn, TextColumn, lines::Line, number};

/// Fields that mean a missing value.
const MISSING: [&[u8]; 3] = [b"", b".", b"?"];

/// An extra column.
pub(crate) enum Extra {
    /// No value yet: its name, and the index in [`MISSING`] of each field so far.
    Unknown(String, Vec<u8>),
    Number(NumberColumn),
    Text(TextColumn, Box<Codebook>),
    /// Dropped.
    LeftOut,
}

impl Extra {
    /// Creates a column of unknown type.
    pub(crate) fn new(name: &str) -> Self {
        Self::Unknown(name.to_owned(), Vec::new())
    }

    /// Sets the type of a column in one of these lists, if it is unknown.
    pub(crate) fn declare(&mut self, texts: &[&str], numbers: &[&str]) {
        let Self::Unknown(name, _) = self else { return };
        if texts.contains(&name.as_str()) {
            self.become_text();
        } else if numbers.contains(&name.as_str()) {
            self.become_number();
        }
    }

    /// Appends a field.
    pub(crate) fn put(&mut self, line: &Line, field: &[u8]) -> Result<(), FileError> {
        let missing = MISSING.iter().position(|token| *token == field);
        if let Self::Unknown(_, tokens) = self {
            match missing {
                Some(token) => {
                    tokens.push(token as u8);
                    return Ok(());
                }
                None if number::parse(field).is_some() => self.become_number(),
                None => self.become_text(),
            }
        }
        match self {
            Self::Unknown(..) | Self::LeftOut => (),
            Self::Number(column) if missing.is_some() => column.values.push(f64::NAN),
            Self::Number(column) => column.values.push(line.number(field)?),
            Self::Text(column, book) => push_text(column, book, field),
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
        let Self::Unknown(name, tokens) = self else { return };
        let values = vec![f64::NAN; tokens.len()];
        *self = Self::Number(NumberColumn { name: std::mem::take(name), values });
    }

    fn become_text(&mut self) {
        let Self::Unknown(name, tokens) = self else { return };
        let mut column = TextColumn { name: std::mem::take(name), ..TextColumn::default() };
        let mut book = Box::default();
        for &token in tokens.iter() {
            push_text(&mut column, &mut book, MISSING[usize::from(token)]);
        }
        *self = Self::Text(column, book);
    }

    /// Moves the column to `numbers` or `texts`. A column without values becomes texts if it has rows.
    pub(crate) fn finish(mut self, numbers: &mut Vec<NumberColumn>, texts: &mut Vec<TextColumn>) {
        match &self {
            Self::Unknown(_, tokens) if tokens.is_empty() => self.become_number(),
            Self::Unknown(..) => self.become_text(),
            _ => (),
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
