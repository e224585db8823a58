//! Bonds as files list them: by the numbers of atoms, which become rows.

use super::{Bond, Bonds, ordered};
use crate::categories::{Codebook, add};
use crate::{FileError, TextColumn, line::Line, memory};
use std::collections::HashMap;
use std::path::Path;

/// Number of bonds between checks of available memory.
const CHECK: usize = 1 << 18;

/// Marks the numbers of several atoms.
const MANY: u32 = u32::MAX;

/// Marks numbers of no atom.
const NONE: u32 = u32::MAX - 1;

/// The atom at an end of a bond, by what the file calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End<T> {
    Atom(T),
    /// There is no such atom.
    Nowhere,
    /// There are several such atoms.
    Ambiguous,
}

impl<T> From<Option<T>> for End<T> {
    fn from(atom: Option<T>) -> Self {
        atom.map_or(Self::Nowhere, Self::Atom)
    }
}

/// Rows of atoms by their numbers.
pub(crate) enum Numbering {
    /// Rows by number, if these are not much more than the atoms.
    Dense(Vec<u32>),
    Sparse(HashMap<u64, u32>),
}

impl Numbering {
    /// Returns the numbering of atoms with these numbers; those that aren't whole have none.
    pub(crate) fn of(numbers: &[f64]) -> Self {
        let whole = |number: f64| (number >= 0.0 && number.fract() == 0.0).then_some(number as u64);
        let most = numbers.iter().filter_map(|&number| whole(number)).max().unwrap_or(0);
        let mut numbering = if most < 4 * numbers.len() as u64 + 1024 {
            Self::Dense(vec![NONE; most as usize + 1])
        } else {
            Self::Sparse(HashMap::new())
        };
        for (row, &number) in numbers.iter().enumerate() {
            let Some(number) = whole(number) else { continue };
            let place = match &mut numbering {
                Self::Dense(rows) => &mut rows[number as usize],
                Self::Sparse(rows) => rows.entry(number).or_insert(NONE),
            };
            *place = if *place == NONE { row as u32 } else { MANY };
        }
        numbering
    }

    /// Returns the row of the atom whose number is a field of a line.
    pub(crate) fn row(&self, line: &Line, field: &[u8]) -> Result<End<u32>, FileError> {
        let number = line.whole_number(field)?;
        let row = match self {
            Self::Dense(rows) => usize::try_from(number).ok().and_then(|at| rows.get(at)),
            Self::Sparse(rows) => rows.get(&number),
        };
        Ok(match row.copied().unwrap_or(NONE) {
            NONE => End::Nowhere,
            MANY => End::Ambiguous,
            row => End::Atom(row),
        })
    }
}

/// Returns the row of the atom that a field numbers from 1, of `atoms` atoms.
pub(crate) fn row_from_one(line: &Line, field: &[u8], atoms: usize) -> Result<End<u32>, FileError> {
    let row = line.whole_number(field)?.checked_sub(1);
    Ok(row.filter(|row| *row < atoms as u64).map(|row| row as u32).into())
}

/// Bonds that are being read.
#[derive(Default)]
pub(crate) struct Listed {
    bonds: Vec<(Bond, u32)>,
    kinds: TextColumn,
    book: Codebook,
    /// Number of bonds that end at no atom.
    dangling: u64,
    /// Number of bonds that end at one of several atoms.
    ambiguous: u64,
}

impl Listed {
    /// Returns both ends of a bond; `None` if it is not clear which atom is at one of them: then the bond is counted, and left out.
    pub(crate) fn ends<T>(&mut self, ends: [End<T>; 2]) -> Option<[T; 2]> {
        match ends {
            [End::Atom(first), End::Atom(second)] => return Some([first, second]),
            [End::Nowhere, _] | [_, End::Nowhere] => self.dangling += 1,
            [End::Ambiguous, _] | [_, End::Ambiguous] => self.ambiguous += 1,
        }
        None
    }

    /// Adds a bond without a type.
    pub(crate) fn push(&mut self, path: &Path, bond: Bond) -> Result<(), FileError> {
        self.push_code(path, bond, 0)
    }

    /// Adds a bond with the name of its type.
    pub(crate) fn push_named(
        &mut self,
        path: &Path,
        bond: Bond,
        name: &[u8],
    ) -> Result<(), FileError> {
        let names = &mut self.kinds.names;
        let code = self.book.code(name, |name| add(names, name));
        self.push_code(path, bond, code)
    }

    fn push_code(&mut self, path: &Path, bond: Bond, code: u32) -> Result<(), FileError> {
        let count = self.bonds.len();
        if count.is_multiple_of(CHECK) && count > 0 {
            // The list may double, and columns follow.
            let bytes = (2 * size_of::<(Bond, u32)>() * count.max(CHECK)) as u64;
            memory::check(bytes).map_err(|shortage| {
                let message =
                    format!("lists more than {count} bonds; more of them need {shortage}");
                FileError::whole_file(path, message)
            })?;
        }
        self.bonds.push((ordered(bond), code));
        Ok(())
    }

    /// Returns the bonds, each once; of equal ones, the first in the file.
    pub(crate) fn finish(self) -> Bonds {
        let Self { mut bonds, mut kinds, dangling, ambiguous, .. } = self;
        // A stable sort: the first in the file comes first.
        bonds.sort_by_key(|(bond, _)| *bond);
        bonds.dedup_by_key(|(bond, _)| *bond);
        if !kinds.names.is_empty() {
            "type".clone_into(&mut kinds.name);
            for (_, code) in &bonds {
                kinds.codes.push(*code);
            }
        }
        let sorted: Vec<Bond> = bonds.iter().map(|(bond, _)| *bond).collect();
        // A bond of an atom to itself is no bond, unless its image is another one.
        let mut bonds = Bonds { kinds, dangling, ambiguous, ..Bonds::of_sorted(&sorted) };
        bonds.map(|(first, second, shift)| {
            (first != second || shift != [0; 3]).then_some((first, second, shift))
        });
        bonds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(numbers: &[f64], field: &str) -> Result<End<u32>, String> {
        let path = Path::new("p").into();
        let line = Line::new(&path, 7, field.as_bytes());
        let row = Numbering::of(numbers).row(&line, line.bytes);
        row.map_err(|error| error.to_string())
    }

    #[test]
    fn numbers_become_rows() {
        for numbers in [&[3.0, 1.0, 2.0][..], &[3e9, 1.0, 2.0]] {
            for (field, expected) in [("1", Some(1)), (" 2", Some(2)), ("0", None), ("4", None)] {
                assert_eq!(row(numbers, field), Ok(expected.into()), "{field}");
            }
            let error = row(numbers, "x").expect_err("a letter");
            assert!(error.contains("not a whole number"), "{error}");
        }
        assert_eq!(row(&[5.0, 5.0], "5"), Ok(End::Ambiguous));
        assert_eq!(row(&[f64::NAN, 0.5], "0"), Ok(End::Nowhere));
    }

    #[test]
    fn bonds_with_unclear_ends_are_counted() {
        let mut listed = Listed::default();
        assert_eq!(listed.ends([End::Atom(1), End::Atom(2)]), Some([1, 2]));
        for other in [End::Atom(1), End::Ambiguous] {
            assert_eq!(listed.ends([End::Ambiguous, other]), None);
        }
        assert_eq!(listed.ends([End::<u32>::Ambiguous, End::Nowhere]), None);
        let bonds = listed.finish();
        assert_eq!((bonds.dangling, bonds.ambiguous), (1, 2));
    }

    #[test]
    fn the_first_of_equal_bonds_is_kept() {
        let mut listed = Listed::default();
        let path = Path::new("p");
        for (bond, name) in [((2, 1, [0; 3]), "b"), ((1, 2, [0; 3]), "a"), ((0, 0, [0; 3]), "c")] {
            listed.push_named(path, bond, name.as_bytes()).expect("memory");
        }
        let bonds = listed.finish();
        assert_eq!((bonds.first.as_slice(), bonds.second.as_slice()), (&[1][..], &[2][..]));
        assert_eq!(bonds.kinds.text(0), "b");
    }
}
