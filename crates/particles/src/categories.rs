//! Categorical columns: a table of names, and a code for each row in the narrowest type.

use super::element::Element;
use std::collections::HashMap;
use std::hash::{Hash, Hasher};

/// Indices into a table of names, in the narrowest type that holds them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Codes {
    /// Up to 256 names.
    Bytes(Vec<u8>),
    /// Up to 65 536 names.
    Shorts(Vec<u16>),
    /// More.
    Words(Vec<u32>),
}

impl Default for Codes {
    fn default() -> Self {
        Self::Bytes(Vec::new())
    }
}

impl Codes {
    /// Returns the number of rows.
    pub fn len(&self) -> usize {
        match self {
            Self::Bytes(codes) => codes.len(),
            Self::Shorts(codes) => codes.len(),
            Self::Words(codes) => codes.len(),
        }
    }

    /// Returns whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the size of a code in bytes.
    pub fn width(&self) -> usize {
        match self {
            Self::Bytes(_) => 1,
            Self::Shorts(_) => 2,
            Self::Words(_) => 4,
        }
    }

    /// Returns the code of row `row`, which must be less than [`Codes::len`].
    #[inline]
    pub fn code(&self, row: usize) -> u32 {
        match self {
            Self::Bytes(codes) => u32::from(codes[row]),
            Self::Shorts(codes) => u32::from(codes[row]),
            Self::Words(codes) => codes[row],
        }
    }

    /// Appends a row; the column widens if the code needs it.
    #[inline]
    pub(crate) fn push(&mut self, code: u32) {
        match self {
            Self::Bytes(codes) if code < 1 << 8 => codes.push(code as u8),
            Self::Shorts(codes) if code < 1 << 16 => codes.push(code as u16),
            Self::Words(codes) => codes.push(code),
            Self::Bytes(_) | Self::Shorts(_) => {
                self.widen(code);
                self.push(code);
            }
        }
    }

    fn widen(&mut self, code: u32) {
        let all = 0..self.len();
        *self = if code < 1 << 16 {
            Self::Shorts(all.map(|row| self.code(row) as u16).collect())
        } else {
            Self::Words(all.map(|row| self.code(row)).collect())
        };
    }

    /// Replaces each code by `places[code]`.
    pub(crate) fn renumber(&mut self, places: &[u32]) {
        let old = std::mem::take(self);
        (0..old.len()).for_each(|row| self.push(places[old.code(row) as usize]));
    }

    /// Keeps the rows for which `keep` is true.
    pub fn retain(&mut self, keep: &[bool]) {
        self.change(RowChange::Retain(keep));
    }

    /// Changes the rows.
    pub(crate) fn change(&mut self, change: RowChange) {
        match self {
            Self::Bytes(codes) => change.apply(codes),
            Self::Shorts(codes) => change.apply(codes),
            Self::Words(codes) => change.apply(codes),
        }
    }
}

/// A change of the rows of columns, the same for each.
#[derive(Clone, Copy)]
pub(crate) enum RowChange<'a> {
    /// Keeps the rows for which the value is true.
    Retain(&'a [bool]),
    /// Gathers rows: row `i` becomes the former row `rows[i]`.
    Pick(&'a [u32]),
    /// Repeats all rows, so many times in all.
    Repeat(usize),
    /// Keeps all rows, and frees unused capacity.
    Shrink,
}

impl RowChange<'_> {
    /// Changes the rows of a column. Empty columns stay empty.
    pub(crate) fn apply<T: Copy>(self, column: &mut Vec<T>) {
        match self {
            Self::Pick(_) if column.is_empty() => {}
            Self::Pick(rows) => *column = rows.iter().map(|&row| column[row as usize]).collect(),
            Self::Retain(keep) => retain(column, keep),
            Self::Repeat(count) => *column = column.repeat(count),
            Self::Shrink => column.shrink_to_fit(),
        }
    }
}

/// A type of particles: its name and element. Types are equal if they are named and drawn alike, from wherever their
/// elements are known.
#[derive(Clone, Debug, Default)]
pub struct Kind {
    /// Name in the file: a symbol, an atom name, or a type's name or number.
    pub name: String,
    /// The element, if the file declares it or the name implies it.
    pub element: Option<Element>,
    /// Source of the element; meaningless without one.
    pub source: ElementSource,
    /// True for a virtual site of a water model, with a charge or mass but no atom (`MW`, `M`, `EP`,
    /// `LP`), which is not drawn.
    pub virtual_site: bool,
}

impl Kind {
    /// Returns all that types differ by.
    fn identity(&self) -> (&str, Option<Element>, bool) {
        (&self.name, self.element, self.virtual_site)
    }
}

impl PartialEq for Kind {
    fn eq(&self, other: &Self) -> bool {
        self.identity() == other.identity()
    }
}

impl Eq for Kind {}

impl Hash for Kind {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.identity().hash(state);
    }
}

/// The facts of a file from which an element is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ElementSource {
    /// Its symbol.
    #[default]
    Symbol,
    /// Its atomic number.
    Number,
    /// The names of the atom and of its residue.
    Name,
    /// The name of a type: of a force field, or one that happens to be a symbol.
    Type,
    /// The mass.
    Mass,
    /// None: the user said so.
    Given,
}

impl ElementSource {
    /// Returns the name of what the element is known from.
    pub fn name(self) -> &'static str {
        match self {
            Self::Symbol => "symbol",
            Self::Number => "atomic number",
            Self::Name => "name",
            Self::Type => "type",
            Self::Mass => "mass",
            Self::Given => "given",
        }
    }
}

/// Types of particles: row `i` of `codes` is the index of particle `i`'s type in `table`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Kinds {
    /// The types, in order of first occurrence.
    pub table: Vec<Kind>,
    /// The type of each particle; empty if the file has no types.
    pub codes: Codes,
}

impl Kinds {
    /// Replaces the types in the table, and merges types that become equal.
    pub(crate) fn rename(&mut self, kind: impl Fn(&str) -> Kind) {
        let mut places = HashMap::new();
        let old = std::mem::take(self);
        let place = |old: &Kind| {
            let new = kind(&old.name);
            *places.entry(new).or_insert_with_key(|new| {
                self.table.push(new.clone());
                self.table.len() as u32 - 1
            })
        };
        let codes: Vec<u32> = old.table.iter().map(place).collect();
        (0..old.codes.len()).for_each(|row| self.codes.push(codes[old.codes.code(row) as usize]));
    }

    /// Returns the type of a particle; `None` if the file has no types.
    pub fn kind(&self, row: usize) -> Option<&Kind> {
        if self.codes.is_empty() { None } else { self.table.get(self.codes.code(row) as usize) }
    }
}

/// A column of texts: row `i` of `codes` is the index of particle `i`'s text in `names`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TextColumn {
    /// The column's name.
    pub name: String,
    /// The distinct texts, in order of first occurrence.
    pub names: Vec<String>,
    /// The text of each particle.
    pub codes: Codes,
}

impl TextColumn {
    /// Returns the text of a particle; `row` must be less than the number of codes.
    pub fn text(&self, row: usize) -> &str {
        &self.names[self.codes.code(row) as usize]
    }
}

/// Number of entries in the direct-mapped cache of recent names.
const RECENT: usize = 64;

/// Finds the code of a name.
pub(crate) struct Codebook {
    /// Names of up to 15 bytes, with their codes.
    recent: [(u128, u32); RECENT],
    codes: HashMap<Vec<u8>, u32>,
}

impl Default for Codebook {
    fn default() -> Self {
        // No name has this length, and so this key.
        Self { recent: [(u128::MAX, 0); RECENT], codes: HashMap::new() }
    }
}

impl Codebook {
    /// Returns the code of a name; `add` returns the code of a new name.
    #[inline]
    pub(crate) fn code(&mut self, name: &[u8], add: impl FnOnce(&str) -> u32) -> u32 {
        if name.len() > 15 {
            return self.find(name, add);
        }
        let mut key = [0; 16];
        key[..name.len()].copy_from_slice(name);
        key[15] = name.len() as u8;
        let key = u128::from_le_bytes(key);
        let mixed = (key as u64 ^ (key >> 61) as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let place = (mixed >> 58) as usize;
        if self.recent[place].0 != key {
            self.recent[place] = (key, self.find(name, add));
        }
        self.recent[place].1
    }

    fn find(&mut self, name: &[u8], add: impl FnOnce(&str) -> u32) -> u32 {
        if let Some(&code) = self.codes.get(name) {
            return code;
        }
        let code = add(&String::from_utf8_lossy(name));
        self.codes.insert(name.to_vec(), code);
        code
    }
}

/// Keeps the rows of a column for which `keep` is true.
pub fn retain<T>(column: &mut Vec<T>, keep: &[bool]) {
    let mut rows = keep.iter();
    column.retain(|_| rows.next().copied().unwrap_or(true));
}

/// Appends a name and returns its index.
pub(crate) fn add(names: &mut Vec<String>, name: &str) -> u32 {
    names.push(name.to_owned());
    names.len() as u32 - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_as_narrow_as_possible() {
        let mut codes = Codes::default();
        for code in [0, 255, 256, 3, 65_536, 7] {
            codes.push(code);
            let narrow = matches!(codes, Codes::Bytes(_));
            assert_eq!(narrow, codes.len() <= 2);
            let width = [1, 1, 2, 2, 4, 4][codes.len() - 1];
            assert_eq!((codes.width(), codes.is_empty()), (width, false));
        }
        assert!(Codes::default().is_empty());
        let all: Vec<u32> = (0..codes.len()).map(|row| codes.code(row)).collect();
        assert_eq!(all, [0, 255, 256, 3, 65_536, 7]);
        codes.retain(&[true, false, false, true, true, false]);
        assert_eq!(codes, Codes::Words(vec![0, 3, 65_536]));
    }

    #[test]
    fn names_keep_their_codes() {
        let mut book = Codebook::default();
        let mut count = 0;
        let names: Vec<String> =
            (0..1000).map(|name| format!("{name}{}", "x".repeat(name % 20))).collect();
        for (expected, name) in names.iter().enumerate().chain(names.iter().enumerate().rev()) {
            let code = book.code(name.as_bytes(), |_| {
                count += 1;
                count - 1
            });
            assert_eq!(code, expected as u32, "{name}");
        }
        assert_eq!(count, 1000);
    }
}
