//! Tables: described columns, and rows of cells.

use super::{Spread, Style};

/// A table. Every row has a cell for each column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Name; the stem of file names.
    pub name: String,
    /// Title, in a line.
    pub title: String,
    /// Columns.
    pub columns: Vec<Column>,
    /// Cells, row by row.
    pub rows: Vec<Vec<Cell>>,
    /// Notes, a few sentences each.
    pub notes: Vec<String>,
}

/// The description of a column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Name in a few words, also in files.
    pub name: String,
    /// Unit of its numbers; empty for none.
    pub unit: String,
    /// Description, in a sentence.
    pub about: String,
    /// Heading of a group of columns, in the first of them; empty elsewhere.
    pub group: String,
    /// Number format.
    pub style: Style,
}

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// No value: not measured, or not applicable.
    None,
    /// Text.
    Text(String),
    /// A whole number.
    Count(u64),
    /// A number; empty in files if it is not finite.
    Number(f64),
    /// A number that was measured several times.
    Spread(Spread),
}

impl Table {
    /// Returns a table without rows.
    pub fn new(name: &str, title: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { name: name.to_owned(), title: title.into(), columns, ..Self::default() }
    }

    /// Appends a row. Missing cells are empty, surplus cells are dropped.
    pub fn push(&mut self, row: impl IntoIterator<Item = Cell>) {
        let count = self.columns.len();
        self.rows.push(row.into_iter().chain(std::iter::repeat(Cell::None)).take(count).collect());
    }

    /// Returns whether a column has numbers that were measured several times.
    pub(super) fn has_spread(&self, column: usize) -> bool {
        self.rows.iter().any(|row| matches!(row[column], Cell::Spread(_)))
    }
}

impl Column {
    /// Returns a column of text, or of numbers without unit.
    pub fn new(name: &str, about: &str) -> Self {
        Self { name: name.to_owned(), about: about.to_owned(), ..Self::default() }
    }

    /// Sets the unit.
    pub fn unit(self, unit: &str) -> Self {
        Self { unit: unit.to_owned(), ..self }
    }

    /// Sets the number format.
    pub fn style(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// Starts a group.
    pub fn group(self, group: &str) -> Self {
        Self { group: group.to_owned(), ..self }
    }

    /// Returns name and unit, as in `rate [Mrays/s]`.
    pub fn heading(&self) -> String {
        self.with_unit(&self.name)
    }

    pub(super) fn with_unit(&self, name: &str) -> String {
        if self.unit.is_empty() { name.to_owned() } else { format!("{name} [{}]", self.unit) }
    }
}

impl Cell {
    /// Returns whether the cell is text, which is aligned left. Numbers are aligned right.
    pub(super) fn is_text(&self) -> bool {
        matches!(self, Self::Text(_))
    }

    /// Formats the cell for people.
    pub fn text(&self, style: Style) -> String {
        match self {
            Self::None => "-".to_owned(),
            Self::Text(text) => text.clone(),
            Self::Count(count) => indicatif::HumanCount(*count).to_string(),
            Self::Number(number) => style.write(*number),
            Self::Spread(Spread { median, least, greatest }) => {
                let [median, least, greatest] = [median, least, greatest].map(|&x| style.write(x));
                if least == greatest { median } else { format!("{median} ({least}..{greatest})") }
            }
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<Spread> for Cell {
    fn from(spread: Spread) -> Self {
        Self::Spread(spread)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::None, Into::into)
    }
}
