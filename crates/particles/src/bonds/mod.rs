//! Bonds between the particles of a frame, in columns: those of the file, or those found by distance.

mod components;
mod distance;
mod images;
mod listed;
mod rules;

pub use distance::from_distance;
pub(crate) use images::nearest;
pub(crate) use listed::{Listed, Numbering, row_from_one, unknown};
pub use rules::{BondRules, BondSource};

use crate::categories::TextColumn;
use crate::frame::ParticleFrame;

/// Bonds between the particles of a frame. Row `i` of every column belongs to bond `i`. Bonds are sorted by
/// their first particle, second particle and shift, and each is listed once.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bonds {
    /// Row of the first particle.
    pub first: Vec<u32>,
    /// Row of the second particle, greater than that of the first, or equal if the bond is to a periodic
    /// image of the same particle.
    pub second: Vec<u32>,
    /// Number of edges a, b and c of the cell to add to the position of the second particle to get the
    /// image that is bonded to the first; empty if no bond crosses the cell.
    pub shift: Vec<[i8; 3]>,
    /// Types as the file names them, such as `1`, `2` and `ar`; no codes if the file has none.
    pub kinds: TextColumn,
    /// True if the file lists only some of the bonds, as PDB and mmCIF do.
    pub partial: bool,
}

/// A bond: its particles, and the shift of the second one.
pub(crate) type Bond = (u32, u32, [i8; 3]);

/// Returns the bond from its other end, if that is the lesser one.
pub(crate) fn ordered((first, second, shift): Bond) -> Bond {
    // Images beyond 127 cells are left out where shifts are made.
    let back = shift.map(i8::wrapping_neg);
    if second < first || second == first && back < shift {
        (second, first, back)
    } else {
        (first, second, shift)
    }
}

impl Bonds {
    /// Returns the number of bonds.
    pub fn len(&self) -> usize {
        self.first.len()
    }

    /// Returns whether there are no bonds.
    pub fn is_empty(&self) -> bool {
        self.first.is_empty()
    }

    /// Returns the shift of the second particle of a bond, which must be less than [`Bonds::len`].
    #[inline]
    pub fn shift_of(&self, bond: usize) -> [i8; 3] {
        if self.shift.is_empty() { [0; 3] } else { self.shift[bond] }
    }

    /// Returns the particles of a bond and the shift of the second one.
    #[inline]
    pub(crate) fn bond(&self, bond: usize) -> Bond {
        (self.first[bond], self.second[bond], self.shift_of(bond))
    }

    /// Returns sorted bonds without types, each once.
    #[cfg(test)]
    pub(crate) fn sorted(mut bonds: Vec<Bond>) -> Self {
        bonds.sort_unstable();
        bonds.dedup();
        Self::of_sorted(&bonds)
    }

    /// Returns bonds that are sorted.
    pub(crate) fn of_sorted(bonds: &[Bond]) -> Self {
        let crosses = bonds.iter().any(|bond| bond.2 != [0; 3]);
        Self {
            first: bonds.iter().map(|bond| bond.0).collect(),
            second: bonds.iter().map(|bond| bond.1).collect(),
            shift: if crosses { bonds.iter().map(|bond| bond.2).collect() } else { Vec::new() },
            ..Self::default()
        }
    }

    /// Maps each bond to another one or to none, and sorts what is left. Of equal bonds the first is kept.
    fn map(&mut self, mut change: impl FnMut(Bond) -> Option<Bond>) {
        let changed = |bond| change(self.bond(bond)).map(|changed| (ordered(changed), bond as u32));
        let mut bonds: Vec<(Bond, u32)> = (0..self.len()).filter_map(changed).collect();
        if !bonds.is_sorted_by(|one, other| one.0 < other.0) {
            bonds.sort_unstable();
            bonds.dedup_by_key(|(bond, _)| *bond);
        }
        let sorted: Vec<Bond> = bonds.iter().map(|(bond, _)| *bond).collect();
        let mut kinds = std::mem::take(&mut self.kinds);
        if !kinds.codes.is_empty() {
            kinds.codes.pick(&bonds.iter().map(|(_, row)| *row).collect::<Vec<u32>>());
        }
        *self = Self { kinds, partial: self.partial, ..Self::of_sorted(&sorted) };
    }

    /// Renumbers the bonds after the particles for which `keep` is false were removed; their bonds are
    /// removed too.
    pub fn retain(&mut self, keep: &[bool]) {
        let mut next = 0;
        let mut places = Vec::with_capacity(keep.len());
        for &keep in keep {
            places.push(next);
            next += u32::from(keep);
        }
        let place = |row: u32| keep[row as usize].then(|| places[row as usize]);
        self.map(|(first, second, shift)| Some((place(first)?, place(second)?, shift)));
    }

    /// Renumbers the bonds after the particles were reordered: row `i` became the former row `rows[i]`.
    pub(crate) fn pick(&mut self, rows: &[u32]) {
        let most = rows.iter().max().map_or(0, |row| *row as usize + 1);
        let mut places = vec![u32::MAX; most];
        for (place, &row) in rows.iter().enumerate() {
            places[row as usize] = place as u32;
        }
        let place = |row: u32| places.get(row as usize).copied().filter(|place| *place < u32::MAX);
        self.map(|(first, second, shift)| Some((place(first)?, place(second)?, shift)));
    }

    /// Adds the bonds of another list, which have no types if this list has some.
    pub(crate) fn add(&mut self, other: &Self) {
        let own = self.len();
        let total = own + other.len();
        if !(self.shift.is_empty() && other.shift.is_empty()) {
            let shift =
                |bond| if bond < own { self.shift_of(bond) } else { other.shift_of(bond - own) };
            self.shift = (0..total).map(shift).collect();
        }
        self.first.extend_from_slice(&other.first);
        self.second.extend_from_slice(&other.second);
        if !self.kinds.codes.is_empty() {
            let none = self.kinds.names.len() as u32;
            self.kinds.names.push(String::new());
            (own..total).for_each(|_| self.kinds.codes.push(none));
        }
        self.map(Some);
    }

    /// Returns the number of bonds of each particle of a frame; a bond to an image of the same particle
    /// counts twice.
    pub fn degrees(&self, particles: usize) -> Vec<u32> {
        let mut degrees = vec![0; particles];
        for &row in self.first.iter().chain(&self.second) {
            degrees[row as usize] += 1;
        }
        degrees
    }
}

impl ParticleFrame {
    /// Finds the bonds that a source asks for: those of the file stay as they are, others are found by
    /// distance. Bonds of the file get their shifts by the nearest images.
    ///
    /// # Errors
    ///
    /// A message: the file has no bonds although only those are asked for, a rule names no type of the frame,
    /// or there are too many neighbors.
    pub fn find_bonds(&mut self, source: &BondSource) -> Result<(), String> {
        if let Some(bonds) = &mut self.bonds
            && bonds.shift.is_empty()
            && let Some(cell) = &self.cell
        {
            let far = bonds.find_images([&self.x, &self.y, &self.z], cell);
            if far > 0 {
                self.warnings.push(format!("{far} bonds of more than 127 cells are left out"));
            }
        }
        match source {
            BondSource::None => self.bonds = None,
            BondSource::OfCrystals if !self.is_crystal() => self.bonds = None,
            BondSource::File if self.bonds.is_none() && !self.is_empty() => {
                return Err("has no bonds in it; `auto` finds them by distance".to_owned());
            }
            BondSource::File => (),
            BondSource::Rules(rules) => self.bonds = Some(from_distance(self, rules)?),
            BondSource::Auto | BondSource::OfCrystals => {
                let has_elements = self.kinds.table.iter().any(|kind| kind.element.is_some());
                let needs =
                    self.bonds.as_ref().is_none_or(|bonds| bonds.partial || bonds.is_empty());
                if needs && has_elements {
                    let by_distance = from_distance(self, &BondRules::covalent())?;
                    match &mut self.bonds {
                        Some(bonds) => bonds.add(&by_distance),
                        None => self.bonds = Some(by_distance),
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bonds(rows: &[Bond]) -> Bonds {
        Bonds::sorted(rows.iter().copied().map(ordered).collect())
    }

    fn rows(bonds: &Bonds) -> Vec<Bond> {
        (0..bonds.len()).map(|bond| bonds.bond(bond)).collect()
    }

    #[test]
    fn bonds_are_listed_once_from_their_lesser_end() {
        let same =
            bonds(&[(3, 1, [1, 0, -2]), (1, 3, [-1, 0, 2]), (0, 0, [0, -1, 0]), (0, 0, [0, 1, 0])]);
        assert_eq!(rows(&same), [(0, 0, [0, -1, 0]), (1, 3, [-1, 0, 2])]);
        assert_eq!(same.degrees(4), [2, 1, 0, 1]);
        assert!(bonds(&[(0, 1, [0; 3])]).shift.is_empty());
    }

    #[test]
    fn bonds_follow_the_rows_of_their_particles() {
        let mut kept = bonds(&[(0, 1, [0; 3]), (1, 3, [1, 0, 0]), (2, 3, [0; 3])]);
        kept.kinds.names = vec!["a".to_owned(), "b".to_owned()];
        kept.kinds.codes = crate::Codes::Bytes(vec![0, 1, 0]);
        let mut reordered = kept.clone();
        kept.retain(&[false, true, true, true]);
        assert_eq!(rows(&kept), [(0, 2, [1, 0, 0]), (1, 2, [0; 3])]);
        assert_eq!([kept.kinds.text(0), kept.kinds.text(1)], ["b", "a"]);
        reordered.pick(&[3, 2, 1, 0]);
        assert_eq!(rows(&reordered), [(0, 1, [0; 3]), (0, 2, [-1, 0, 0]), (2, 3, [0; 3])]);
        assert_eq!([0, 1, 2].map(|bond| reordered.kinds.text(bond)), ["a", "b", "a"]);
    }

    #[test]
    fn added_bonds_are_not_doubled() {
        let mut one = bonds(&[(0, 1, [0; 3])]);
        one.kinds.names = vec!["2".to_owned()];
        one.kinds.codes.push(0);
        one.add(&bonds(&[(0, 1, [0; 3]), (0, 2, [1, 0, 0])]));
        assert_eq!(rows(&one), [(0, 1, [0; 3]), (0, 2, [1, 0, 0])]);
        assert_eq!([one.kinds.text(0), one.kinds.text(1)], ["2", ""]);
    }
}
