//! Connected components of bonded particles, and molecules made whole across the periodic cell.

use super::Bonds;
use crate::ParticleFrame;
use glam::DVec3;

/// The bonds of each particle.
pub(crate) struct Adjacency {
    /// Index of the first end of each particle.
    starts: Vec<u32>,
    /// Bonds, and whether the particle is the first one.
    ends: Vec<(u32, bool)>,
}

/// A bond from one of its ends.
pub(crate) struct Near {
    /// The particle at the other end.
    pub(crate) row: u32,
    /// Number of edges of the cell to its image.
    pub(crate) shift: [i32; 3],
    pub(crate) bond: usize,
    /// True if this end is the first one.
    pub(crate) is_first: bool,
}

/// Particles that bonds connect in one piece, in columns.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Molecule {
    /// Rows of the particles.
    pub rows: Vec<u32>,
    /// By how many edges a, b and c of the cell to move each one, so that no bond crosses the cell; the first one stays.
    pub moves: Vec<[i32; 3]>,
}

impl Adjacency {
    pub(crate) fn new(bonds: &Bonds, particles: usize) -> Self {
        let mut starts = vec![0_u32; particles + 2];
        for &row in bonds.first.iter().chain(&bonds.second) {
            starts[row as usize + 2] += 1;
        }
        for row in 2..starts.len() {
            starts[row] += starts[row - 1];
        }
        let mut ends = vec![(0, false); 2 * bonds.len()];
        for bond in 0..bonds.len() {
            for (row, is_first) in [(bonds.first[bond], true), (bonds.second[bond], false)] {
                let next = &mut starts[row as usize + 1];
                ends[*next as usize] = (bond as u32, is_first);
                *next += 1;
            }
        }
        starts.pop();
        Self { starts, ends }
    }

    fn of(&self, row: u32) -> &[(u32, bool)] {
        let row = row as usize;
        &self.ends[self.starts[row] as usize..self.starts[row + 1] as usize]
    }

    /// Returns the bonds of a particle from its end; `bonds` are those of [`Adjacency::new`].
    pub(crate) fn near(&self, bonds: &Bonds, row: u32) -> impl Iterator<Item = Near> {
        self.of(row).iter().map(|&(bond, is_first)| {
            let bond = bond as usize;
            let (first, second, shift) = bonds.bond(bond);
            let shift = shift.map(i32::from);
            if is_first {
                Near { row: second, shift, bond, is_first }
            } else {
                Near { row: first, shift: shift.map(|edge| -edge), bond, is_first }
            }
        })
    }
}

impl Bonds {
    /// Returns the number of the connected component of each particle: 1 for the largest one; of equal ones,
    /// the one with the first particle comes first.
    pub fn clusters(&self, particles: usize) -> Vec<u32> {
        let mut parents: Vec<u32> = (0..particles as u32).collect();
        // The root of a component is its first particle.
        for bond in 0..self.len() {
            let one = root(&mut parents, self.first[bond]);
            let other = root(&mut parents, self.second[bond]);
            parents[one.max(other) as usize] = one.min(other);
        }
        let mut sizes = vec![0_u32; particles];
        for row in 0..particles as u32 {
            sizes[root(&mut parents, row) as usize] += 1;
        }
        let mut roots: Vec<u32> =
            (0..particles as u32).filter(|&row| sizes[row as usize] > 0).collect();
        roots.sort_by_key(|&row| std::cmp::Reverse(sizes[row as usize]));
        let mut numbers = sizes;
        for (number, &row) in (1..).zip(&roots) {
            numbers[row as usize] = number;
        }
        (0..particles as u32).map(|row| numbers[root(&mut parents, row) as usize]).collect()
    }

    /// Returns the molecules of `particles` particles, of two or more each, between which there are no bonds; networks without an
    /// end are none.
    pub fn molecules(&self, particles: usize) -> Vec<Molecule> {
        let moves = self.unwrapped(particles);
        let clusters = self.clusters(particles);
        let mut molecules = vec![Some(Molecule::default()); particles];
        for (row, &cluster) in clusters.iter().enumerate() {
            if let Some(molecule) = &mut molecules[cluster as usize - 1] {
                molecule.rows.push(row as u32);
                molecule.moves.push(moves[row]);
            }
        }
        for bond in 0..self.len() {
            let (first, second, shift) = self.bond(bond);
            let [own, other] = [first, second].map(|row| moves[row as usize]);
            let is_crossed = |edge: usize| i32::from(shift[edge]) + own[edge] != other[edge];
            if [0, 1, 2].into_iter().any(is_crossed) {
                molecules[clusters[first as usize] as usize - 1] = None;
            }
        }
        let several = |molecule: &Molecule| molecule.rows.len() > 1;
        molecules.into_iter().flatten().filter(several).collect()
    }

    /// Returns by how many edges of the cell to move each particle so that bonds don't cross the cell: the
    /// first particle of each molecule stays in place. Bonds of endless networks still cross it.
    fn unwrapped(&self, particles: usize) -> Vec<[i32; 3]> {
        let adjacency = Adjacency::new(self, particles);
        let mut moves = vec![[0; 3]; particles];
        let mut visited = vec![false; particles];
        let mut queue = Vec::new();
        for start in 0..particles as u32 {
            if std::mem::replace(&mut visited[start as usize], true) {
                continue;
            }
            queue.push(start);
            let mut next = 0;
            while let Some(&row) = queue.get(next) {
                next += 1;
                let own: [i32; 3] = moves[row as usize];
                for &(bond, is_first) in adjacency.of(row) {
                    let (first, second, shift) = self.bond(bond as usize);
                    let other = if is_first { second } else { first };
                    if std::mem::replace(&mut visited[other as usize], true) {
                        continue;
                    }
                    let sign = if is_first { 1 } else { -1 };
                    let edge = |axis: usize| own[axis] + sign * i32::from(shift[axis]);
                    moves[other as usize] = [edge(0), edge(1), edge(2)];
                    queue.push(other);
                }
            }
            queue.clear();
        }
        moves
    }
}

/// Returns the root of a component, and halves the path to it.
fn root(parents: &mut [u32], mut row: u32) -> u32 {
    while parents[row as usize] != row {
        let parent = parents[row as usize];
        parents[row as usize] = parents[parent as usize];
        row = parent;
    }
    row
}

impl ParticleFrame {
    /// Makes molecules whole: moves particles by whole edges of the cell so that bonds don't cross it.
    /// Does nothing without bonds or a cell.
    pub fn make_whole(&mut self) {
        let (Some(bonds), Some(cell)) = (&mut self.bonds, &self.cell) else { return };
        if bonds.shift.is_empty() {
            return;
        }
        let moves = bonds.unwrapped(self.x.len());
        let matrix = cell.matrix();
        for (row, edges) in moves.iter().enumerate().filter(|(_, edges)| **edges != [0; 3]) {
            let by = matrix * DVec3::from(edges.map(f64::from));
            self.x[row] += by.x;
            self.y[row] += by.y;
            self.z[row] += by.z;
        }
        bonds.move_particles(|row| moves[row].map(|edge| -edge));
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BondRules, from_distance, ordered};
    use super::*;
    use crate::cell::Cell;
    use proptest::prelude::*;

    #[test]
    fn clusters_are_numbered_by_size_and_first_particle() {
        let bonds = [(5, 6), (1, 3), (3, 4), (0, 2)].map(|(one, other)| (one, other, [0; 3]));
        let bonds = Bonds::sorted(bonds.into());
        assert_eq!(bonds.clusters(8), [2, 1, 2, 1, 1, 3, 3, 4]);
        assert_eq!(Bonds::default().clusters(3), [1, 2, 3]);
        assert!(Bonds::default().clusters(0).is_empty());
    }

    #[test]
    fn molecules_end_and_networks_do_not() {
        // A chain over two faces, a chain without an end, a particle alone, and a pair.
        let bonds = [
            (0, 2, [1, 0, 0]),
            (2, 3, [0, -1, 0]),
            (1, 4, [0; 3]),
            (1, 4, [0, 0, 1]),
            (6, 7, [0; 3]),
        ];
        let bonds = Bonds::sorted(bonds.map(ordered).into());
        let molecules = bonds.molecules(8);
        assert_eq!(molecules.len(), 2);
        assert_eq!(molecules[0].rows, [0, 2, 3]);
        assert_eq!(molecules[0].moves, [[0; 3], [1, 0, 0], [1, -1, 0]]);
        assert_eq!((&molecules[1].rows[..], molecules[1].moves[1]), (&[6, 7][..], [0; 3]));
        assert!(Bonds::default().molecules(3).is_empty());
    }

    proptest! {
        #[test]
        fn whole_chains_have_no_bond_across_the_cell(
            steps in prop::collection::vec([-0.5..0.5_f64, -0.5..0.5, -0.5..0.5], 1..60),
        ) {
            let vectors = [DVec3::X * 4.0, DVec3::new(1.0, 5.0, 0.0), DVec3::new(-1.0, 0.5, 6.0)];
            let cell = Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] };
            let mut frame = ParticleFrame { cell: Some(cell), ..ParticleFrame::default() };
            let mut place = DVec3::splat(0.5);
            for step in &steps {
                place += DVec3::from(*step) + DVec3::splat(0.2);
                let cells = cell.fractional(place).floor();
                let [x, y, z] = (place - cell.matrix() * cells).to_array();
                frame.x.push(x);
                frame.y.push(y);
                frame.z.push(z);
            }
            let chain = (1..frame.len() as u32).map(|row| ordered((row - 1, row, [0; 3])));
            let mut bonds = Bonds::sorted(chain.collect());
            bonds.find_images([&frame.x, &frame.y, &frame.z], &cell);
            frame.bonds = Some(bonds);
            let first = frame.position(0);
            frame.make_whole();
            prop_assert_eq!(frame.position(0), first);
            prop_assert!(frame.bonds.as_ref().is_some_and(|bonds| bonds.shift.is_empty()));
            for row in 1..frame.len() {
                prop_assert!(frame.position(row).distance(frame.position(row - 1)) < 1.4);
            }
        }
    }

    #[test]
    fn endless_chains_still_cross_the_cell() {
        let vectors = [DVec3::X * 3.0, DVec3::Y * 9.0, DVec3::Z * 9.0];
        let cell = Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] };
        let mut frame = ParticleFrame {
            x: vec![0.0, 1.0, 2.0],
            y: vec![0.0; 3],
            z: vec![0.0; 3],
            cell: Some(cell),
            ..ParticleFrame::default()
        };
        let bonds = from_distance(&frame, &BondRules::within(1.5)).expect("bonds");
        frame.bonds = Some(bonds);
        frame.make_whole();
        let bonds = frame.bonds.as_ref().expect("bonds");
        assert_eq!(bonds.len(), 3);
        for bond in 0..3 {
            let ends = [bonds.first[bond], bonds.second[bond]];
            let positions = ends.map(|row| frame.position(row as usize));
            assert!((bonds.vector(bond, positions, Some(&cell)).length() - 1.0).abs() < 1e-12);
        }
    }
}
