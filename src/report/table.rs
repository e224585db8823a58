//! Tables: columns that say what they hold, and rows.

use super::{Spread, Style};

/// A table. Every row has a cell for each column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// A word; files are called by it.
    pub name: String,
    /// What it shows, in a line.
    pub title: String,
    /// What the cells of each column are.
    pub columns: Vec<Column>,
    /// The cells, row by row.
    pub rows: Vec<Vec<Cell>>,
    /// What to mind, a sentence each.
    pub notes: Vec<String>,
}

/// What a column holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// What it is called, in a few words; in files, too.
    pub name: String,
    /// The unit of its numbers; empty for none.
    pub unit: String,
    /// What is in it, in a sentence.
    pub about: String,
    /// The heading of a group of columns, in the first of them; empty elsewhere.
    pub group: String,
    /// How its numbers are written.
    pub style: Style,
}

/// A cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing: it was not measured, or makes no sense here.
    None,
    /// Words.
    Text(String),
    /// How many.
    Count(u64),
    /// A number; one that is not finite is left out of files.
    Number(f64),
    /// A number that was measured several times.
    Spread(Spread),
}

impl Table {
    /// A table without rows.
    pub fn new(name: &str, title: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { name: name.to_owned(), title: title.into(), columns, ..Self::default() }
    }

    /// Appends a row; cells that are left out are empty, those that are too many are not taken.
    pub fn push(&mut self, row: impl IntoIterator<Item = Cell>) {
        let count = self.columns.len();
        self.rows.push(row.into_iter().chain(std::iter::repeat(Cell::None)).take(count).collect());
    }

    /// Whether a column holds numbers with their spread.
    pub(super) fn has_spread(&self, column: usize) -> bool {
        self.rows.iter().any(|row| matches!(row[column], Cell::Spread(_)))
    }
}

impl Column {
    /// A column of words or of numbers without unit.
    pub fn new(name: &str, about: &str) -> Self {
        Self { name: name.to_owned(), about: about.to_owned(), ..Self::default() }
    }

    /// The same with a unit.
    pub fn unit(self, unit: &str) -> Self {
        Self { unit: unit.to_owned(), ..self }
    }

    /// The same with numbers in another style.
    pub fn style(self, style: Style) -> Self {
        Self { style, ..self }
    }

    /// The same as the first of a group.
    pub fn group(self, group: &str) -> Self {
        Self { group: group.to_owned(), ..self }
    }

    /// Name and unit, as in `rate [Mrays/s]`.
    pub fn heading(&self) -> String {
        self.with_unit(&self.name)
    }

    pub(super) fn with_unit(&self, name: &str) -> String {
        if self.unit.is_empty() { name.to_owned() } else { format!("{name} [{}]", self.unit) }
    }
}

impl Cell {
    /// Whether it stands at the left of its column: numbers stand at the right.
    pub(super) fn is_text(&self) -> bool {
        matches!(self, Self::Text(_))
    }

    /// As people read it.
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
