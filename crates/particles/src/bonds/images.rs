//! Periodic images of bonded particles: the shifts of bonds as particles are placed, moved and copied.

use super::{Bond, Bonds};
use crate::cell::Cell;
use glam::DVec3;

/// Maximum number of steps to a nearer image, for cells so skewed that rounding ends far from it.
const MOST_STEPS: usize = 100;

/// Returns a shift if it fits its column.
pub(super) fn narrow(shift: [i64; 3]) -> Option<[i8; 3]> {
    let fits = |edge: &i64| (-127..=127).contains(edge);
    shift.iter().all(fits).then(|| shift.map(|edge| edge as i8))
}

/// Returns the number of edges to add to `away`, a vector between two particles, to make it the shortest
/// one. The rounded fractional coordinates are the answer of orthogonal cells; in a skewed cell one of
/// the adjacent images may be nearer.
fn nearest(away: DVec3, cell: &Cell) -> [i64; 3] {
    let fractional = cell.matrix().inverse() * away;
    let edge = |axis: usize| if cell.periodic[axis] { -fractional[axis].round() } else { 0.0 };
    let start = [edge(0), edge(1), edge(2)];
    let [a, b, c] = cell.vectors;
    let skewed = a.dot(b) != 0.0 || b.dot(c) != 0.0 || a.dot(c) != 0.0;
    let length = |shift: [f64; 3]| (away + cell.matrix() * DVec3::from(shift)).length_squared();
    let mut best = start;
    // Each step makes the vector shorter, so this ends.
    for _ in 0..if skewed { MOST_STEPS } else { 0 } {
        let center = best;
        let steps = |axis: usize| if cell.periodic[axis] { -1..=1 } else { 0..=0 };
        for i in steps(0) {
            for j in steps(1) {
                for k in steps(2) {
                    let step = [i, j, k].map(f64::from);
                    let shift = std::array::from_fn(|axis| center[axis] + step[axis]);
                    // Rounding alone does not choose another image.
                    if length(shift) < length(best) * (1.0 - 1e-9) {
                        best = shift;
                    }
                }
            }
        }
        if best == center {
            break;
        }
    }
    best.map(|edge| edge as i64)
}

/// Returns the nearest periodic image of a vector between two particles.
pub fn nearest_image(vector: DVec3, cell: Option<&Cell>) -> DVec3 {
    match cell {
        Some(cell) if vector.is_finite() => {
            let edges = nearest(vector, cell).map(|edge| edge as f64);
            vector + cell.matrix() * DVec3::from(edges)
        }
        _ => vector,
    }
}

impl Bonds {
    /// Finds the shift of each bond: that of the nearest image. Returns the number of bonds that are
    /// removed because their particles are too many cells apart.
    pub(crate) fn find_images(&mut self, axes: [&[f64]; 3], cell: &Cell) -> usize {
        if cell.periodic == [false; 3] {
            return 0;
        }
        let count = self.len();
        let position = |row: u32| DVec3::from(axes.map(|axis| axis[row as usize]));
        self.map(|(first, second, _)| {
            let away = position(second) - position(first);
            let shift = if away.is_finite() { nearest(away, cell) } else { [0; 3] };
            Some((first, second, narrow(shift)?))
        });
        count - self.len()
    }

    /// Removes all shifts, so that they are found again.
    pub(crate) fn forget_images(&mut self) {
        self.map(|(first, second, _)| (first != second).then_some((first, second, [0; 3])));
    }

    /// Returns the vector of a bond from its first particle to the bonded image of the second one.
    pub fn vector(&self, bond: usize, positions: [DVec3; 2], cell: Option<&Cell>) -> DVec3 {
        let away = positions[1] - positions[0];
        match cell {
            Some(cell) if !self.shift.is_empty() => {
                let shift = self.shift[bond].map(f64::from);
                away + cell.matrix() * DVec3::from(shift)
            }
            _ => away,
        }
    }

    /// Changes the shifts after particles were moved by whole edges of the cell: particle `row` from its
    /// position by minus `edges(row)`. Bonds whose particles are too many cells apart are removed.
    pub fn move_particles(&mut self, edges: impl Fn(usize) -> [i32; 3]) {
        self.map(|(first, second, shift)| {
            let (own, other) = (edges(first as usize), edges(second as usize));
            let edge = |axis: usize| {
                i64::from(shift[axis]) + i64::from(other[axis]) - i64::from(own[axis])
            };
            Some((first, second, narrow([edge(0), edge(1), edge(2)])?))
        });
    }

    /// Repeats the bonds in copies of the cell of `particles` particles: the first copy along the edge a
    /// varies fastest. Bonds that cross the cell lead to the next copy, and from the last one to the first.
    pub fn replicate(&mut self, particles: usize, copies: [u32; 3]) {
        let copies = copies.map(i64::from);
        let mut bonds: Vec<(Bond, u32)> = Vec::new();
        for k in 0..copies[2] {
            for j in 0..copies[1] {
                for i in 0..copies[0] {
                    let place = [i, j, k];
                    for bond in 0..self.len() {
                        let (first, second, shift) = self.bond(bond);
                        let to = |axis: usize| place[axis] + i64::from(shift[axis]);
                        let row = |row: u32, [i, j, k]: [i64; 3]| {
                            let copy = (k * copies[1] + j) * copies[0] + i;
                            (copy as usize * particles + row as usize) as u32
                        };
                        let there = [0, 1, 2].map(|axis| to(axis).rem_euclid(copies[axis]));
                        let shift = [0, 1, 2].map(|axis| to(axis).div_euclid(copies[axis]) as i8);
                        let copy = (row(first, place), row(second, there), shift);
                        bonds.push((super::ordered(copy), bond as u32));
                    }
                }
            }
        }
        self.replace(bonds);
    }
}

#[cfg(test)]
mod tests {
    use super::super::ordered;
    use super::*;
    use crate::Codes;
    use proptest::prelude::*;

    fn tilted() -> Cell {
        Cell {
            origin: DVec3::new(-1.0, 2.0, 5.0),
            vectors: [
                DVec3::new(4.0, 0.0, 0.0),
                DVec3::new(1.9, 3.0, 0.0),
                DVec3::new(-1.9, 1.4, 6.0),
            ],
            periodic: [true; 3],
        }
    }

    proptest! {
        #[test]
        fn the_nearest_image_is_the_nearest_of_all(
            [x, y, z] in [-20.0..20.0_f64, -20.0..20.0, -20.0..20.0],
            periodic in any::<[bool; 3]>(),
        ) {
            let cell = Cell { periodic, ..tilted() };
            let away = DVec3::new(x, y, z);
            let length = |shift: [i64; 3]| {
                (away + cell.matrix() * DVec3::from(shift.map(|edge| edge as f64))).length()
            };
            let found = length(nearest(away, &cell));
            let steps = |axis: usize| if periodic[axis] { -14..=14 } else { 0..=0_i64 };
            for i in steps(0) {
                for j in steps(1) {
                    for k in steps(2) {
                        prop_assert!(length([i, j, k]) > found - 1e-6);
                    }
                }
            }
        }

        #[test]
        fn vectors_of_bonds_survive_moves(
            edges in [[-3..4_i32, -3..4, -3..4], [-3..4, -3..4, -3..4]],
        ) {
            let cell = tilted();
            let before = [DVec3::new(0.5, 2.5, 6.0), DVec3::new(1.0, 3.0, 5.5)];
            let mut bonds = Bonds::sorted(vec![ordered((0, 1, [1, 0, -1]))]);
            let vector = bonds.vector(0, before, Some(&cell));
            bonds.move_particles(|row| edges[row]);
            let moved = [0, 1].map(|row| {
                before[row] - cell.matrix() * DVec3::from(edges[row].map(f64::from))
            });
            prop_assert!((bonds.vector(0, moved, Some(&cell)) - vector).length() < 1e-12);
        }
    }

    #[test]
    fn copies_are_bonded_across_their_faces() {
        let mut bonds = Bonds::sorted(vec![(0, 1, [0; 3]), ordered((0, 1, [1, 0, 0]))]);
        bonds.kinds.names = vec!["in".to_owned(), "across".to_owned()];
        bonds.kinds.codes = Codes::Bytes(vec![0, 1]);
        bonds.replicate(2, [3, 2, 1]);
        assert_eq!(bonds.len(), 12);
        let across = (0..12).filter(|&bond| bonds.shift_of(bond) != [0; 3]);
        // Of each row of three copies, one bond crosses the greater cell.
        assert_eq!(across.count(), 2);
        assert_eq!(bonds.degrees(12), [2; 12]);
        let named = (0..12).filter(|&bond| bonds.kinds.text(bond) == "across");
        assert_eq!(named.count(), 6);
    }

    #[test]
    fn bonds_across_many_cells_are_removed() {
        let cell = Cell { vectors: [DVec3::X, DVec3::Y, DVec3::Z], ..tilted() };
        let mut bonds = Bonds::sorted(vec![(0, 1, [0; 3]), (0, 2, [0; 3])]);
        let x = [0.0, 1.25, 500.0];
        assert_eq!(bonds.find_images([&x, &[0.0; 3], &[0.0; 3]], &cell), 1);
        assert_eq!((bonds.len(), bonds.shift_of(0)), (1, [-1, 0, 0]));
    }
}
