//! Bonds between the particles of a frame, in columns.

use crate::categories::{RowChange, TextColumn};

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
    /// Number of bonds of the file that are left out, since they end at no particle, until
    /// [`ParticleFrame::find_bonds`](crate::ParticleFrame::find_bonds) warns of them.
    pub dangling: u64,
    /// Number of bonds of the file that are left out, since they end at a number or name that several particles have, until
    /// [`ParticleFrame::find_bonds`](crate::ParticleFrame::find_bonds) warns of them.
    pub ambiguous: u64,
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
    pub(crate) fn map(&mut self, mut change: impl FnMut(Bond) -> Option<Bond>) {
        let changed = |bond| change(self.bond(bond)).map(|changed| (ordered(changed), bond as u32));
        self.replace((0..self.len()).filter_map(changed).collect());
    }

    /// Replaces the bonds by others, each with the bond whose type it has, and sorts them. Of equal bonds the first is
    /// kept.
    pub(crate) fn replace(&mut self, mut bonds: Vec<(Bond, u32)>) {
        if !bonds.is_sorted_by(|one, other| one.0 < other.0) {
            bonds.sort_unstable();
            bonds.dedup_by_key(|(bond, _)| *bond);
        }
        let sorted: Vec<Bond> = bonds.iter().map(|(bond, _)| *bond).collect();
        let mut kinds = std::mem::take(&mut self.kinds);
        kinds.codes.change(RowChange::Pick(&bonds.iter().map(|bond| bond.1).collect::<Vec<u32>>()));
        let Self { partial, dangling, ambiguous, .. } = *self;
        *self = Self { kinds, partial, dangling, ambiguous, ..Self::of_sorted(&sorted) };
    }

    /// Renumbers the bonds after the particles for which `keep` is false were removed; their bonds are
    /// removed too.
    pub fn retain(&mut self, keep: &[bool]) {
        let rows = (0..).zip(keep).filter_map(|(row, keep)| keep.then_some(row));
        self.pick(&rows.collect::<Vec<u32>>());
    }

    /// Removes the bonds for whose ends `keep` is false.
    pub fn keep(&mut self, keep: impl Fn([u32; 2]) -> bool) {
        self.map(|bond| keep([bond.0, bond.1]).then_some(bond));
    }

    /// Changes the rows of the particles. Repeated ones get bonds by [`Bonds::replicate`], which knows the cell.
    pub(super) fn change(&mut self, change: RowChange) {
        match change {
            RowChange::Retain(keep) => self.retain(keep),
            RowChange::Pick(rows) => self.pick(rows),
            RowChange::Repeat(_) | RowChange::Shrink => {}
        }
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
