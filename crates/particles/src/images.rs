//! Periodic images of particles that are drawn beside them: those on the faces of the cell, and those that are bonded to
//! particles that are drawn.

use crate::bonds::{Adjacency, Bonds, ordered};
use crate::neighbors::Points;
use std::collections::HashMap;

/// The part of an edge of the cell up to which a particle is on the face at its end.
pub const ON_FACE: f64 = 1e-3;

/// Images of particles: row `i` of every column belongs to image `i`.
#[derive(Clone, Debug, Default)]
pub struct Images {
    /// Rows of the particles.
    pub rows: Vec<u32>,
    /// Number of edges a, b and c of the cell from the particle to the image.
    pub shifts: Vec<[i32; 3]>,
    /// Number of each image.
    places: HashMap<(u32, [i32; 3]), u32>,
}

/// An end of a bond that leaves what is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeavingBond {
    /// Row of the particle, or of the image, which follow the particles, at this end.
    pub row: u32,
    /// Row of the particle at the other end.
    pub other: u32,
    /// Number of edges of the cell from that particle to its image that is at the other end.
    pub shift: [i32; 3],
}

impl Images {
    /// Returns the images that complete the cell: those of particles on its faces, edges and corners at the opposite
    /// ones, along the edges that are periodic. `molecules` are rows of particles that go together, by the place of their center.
    pub fn on_faces(points: Points, molecules: &[Vec<u32>]) -> Self {
        let mut images = Self::default();
        let Some(cell) = points.cell else { return images };
        let inverse = cell.matrix().inverse();
        let mut is_alone = vec![true; points.len()];
        molecules.iter().flatten().for_each(|&row| is_alone[row as usize] = false);
        let alone = (0..points.len() as u32).filter(|&row| is_alone[row as usize]);
        let alone: Vec<[u32; 1]> = alone.map(|row| [row]).collect();
        let groups = alone.iter().map(|row| &row[..]).chain(molecules.iter().map(Vec::as_slice));
        for rows in groups {
            let place = inverse * (points.center(rows) - cell.origin);
            let steps = |edge: usize| -> &[i32] {
                match place[edge] {
                    _ if !cell.periodic[edge] => &[0],
                    start if start.abs() <= ON_FACE => &[0, 1],
                    end if (end - 1.0).abs() <= ON_FACE => &[0, -1],
                    _ => &[0],
                }
            };
            for &a in steps(0) {
                for &b in steps(1) {
                    for &c in steps(2) {
                        for &row in rows {
                            images.add(row, [a, b, c]);
                        }
                    }
                }
            }
        }
        images
    }

    /// Returns the number of images.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Adds an image, unless it is there already or the particle itself.
    pub fn add(&mut self, row: u32, shift: [i32; 3]) {
        let next = self.rows.len() as u32;
        if shift != [0; 3] && *self.places.entry((row, shift)).or_insert(next) == next {
            self.rows.push(row);
            self.shifts.push(shift);
        }
    }

    /// Adds the images that are bonded to the first `nodes` of `particles` particles and the images that follow them.
    pub fn add_bonded(&mut self, particles: usize, nodes: usize, bonds: &Bonds) {
        let adjacency = Adjacency::new(bonds, particles);
        for node in 0..nodes {
            let (row, own) = self.node(particles, node);
            for near in adjacency.near(bonds, row) {
                self.add(near.row, sum(own, near.shift));
            }
        }
    }

    /// Returns the row of a particle's image, after those of `particles` particles; `None` if it is not drawn.
    pub fn row_of(&self, particles: usize, row: u32, shift: [i32; 3]) -> Option<u32> {
        if shift == [0; 3] {
            return Some(row);
        }
        self.places.get(&(row, shift)).map(|place| particles as u32 + place)
    }

    /// Returns the rows of particles and their images among all that is drawn, and the shift of each from the particle.
    pub fn nodes(&self, particles: usize) -> impl Iterator<Item = (u32, [i32; 3])> {
        (0..particles + self.len()).map(move |node| self.node(particles, node))
    }

    fn node(&self, particles: usize, node: usize) -> (u32, [i32; 3]) {
        match node.checked_sub(particles) {
            None => (node as u32, [0; 3]),
            Some(image) => (self.rows[image], self.shifts[image]),
        }
    }
}

/// Returns the sum of two shifts.
fn sum(one: [i32; 3], other: [i32; 3]) -> [i32; 3] {
    [0, 1, 2].map(|edge| one[edge] + other[edge])
}

impl Bonds {
    /// Replaces the bonds of `particles` particles by those between what is drawn: the particles, and images whose rows follow
    /// theirs. Returns the bonds that leave it, from each end that is drawn.
    pub fn between(&mut self, particles: usize, images: &Images) -> Vec<LeavingBond> {
        let adjacency = Adjacency::new(self, particles);
        let (mut inside, mut leaving) = (Vec::new(), Vec::new());
        for (place, (row, own)) in images.nodes(particles).enumerate() {
            for near in adjacency.near(self, row) {
                let shift = sum(own, near.shift);
                match images.row_of(particles, near.row, shift) {
                    Some(other) if near.is_first => {
                        let bond = ordered((place as u32, other, [0; 3]));
                        inside.push((bond, near.bond as u32));
                    }
                    Some(_) => (),
                    None => leaving.push(LeavingBond { row: place as u32, other: near.row, shift }),
                }
            }
        }
        self.replace(inside);
        leaving
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cell;
    use crate::bonds::{BondRules, from_distance};
    use crate::frame::ParticleFrame;
    use glam::DVec3;

    /// Particles at these places in a cubic cell of edge 4.
    fn frame(places: &[[f64; 3]], periodic: [bool; 3]) -> ParticleFrame {
        let cell = Cell {
            origin: DVec3::X,
            vectors: [DVec3::X, DVec3::Y, DVec3::Z].map(|e| e * 4.0),
            periodic,
        };
        let column = |axis: usize| places.iter().map(|at| cell.cartesian(*at)[axis]).collect();
        ParticleFrame {
            x: column(0),
            y: column(1),
            z: column(2),
            cell: Some(cell),
            ..ParticleFrame::default()
        }
    }

    #[test]
    fn corners_edges_and_faces_are_completed() {
        let places = [
            [0.0; 3],
            [0.0, 0.0005, 0.5],
            [0.9999, 0.5, 0.5],
            [0.5; 3],
            [2.0, 0.3, 0.3],
            [0.002, 0.5, 0.5],
        ];
        let counts = |periodic| {
            let frame = frame(&places, periodic);
            let images = Images::on_faces(Points::of(&frame), &[]);
            [0, 1, 2, 3, 4, 5].map(|row| images.rows.iter().filter(|own| **own == row).count())
        };
        assert_eq!(counts([true; 3]), [7, 3, 1, 0, 0, 0]);
        assert_eq!(counts([true, true, false]), [3, 3, 1, 0, 0, 0]);
        assert_eq!(counts([false; 3]), [0; 6]);
        let frame = frame(&places, [true; 3]);
        let images = Images::on_faces(Points::of(&frame), &[]);
        assert_eq!(images.row_of(6, 2, [-1, 0, 0]), Some(6 + images.len() as u32 - 1));
        assert_eq!((images.row_of(6, 3, [0; 3]), images.row_of(6, 3, [1, 0, 0])), (Some(3), None));
    }

    #[test]
    fn molecules_are_completed_by_their_centers() {
        // A pair around a corner, one of whose particles is on a face, and a pair whose center is inside.
        let places = [[-0.1, 0.0, 0.1], [0.1, 0.0, -0.1], [0.0, 0.5, 0.5], [0.2, 0.5, 0.5]];
        let frame = frame(&places, [true; 3]);
        let images = Images::on_faces(Points::of(&frame), &[vec![0, 1], vec![2, 3]]);
        let count = |row: u32| images.rows.iter().filter(|own| **own == row).count();
        assert_eq!([0, 1, 2, 3].map(count), [7, 7, 0, 0]);
        let alone = Images::on_faces(Points::of(&frame), &[]);
        assert_eq!((alone.len(), alone.rows.contains(&2)), (3, true));
    }

    #[test]
    fn bonds_are_those_between_what_is_drawn() {
        // Halite with one particle of each kind: a simple cubic lattice along each axis.
        let frame = frame(&[[0.0; 3], [0.5, 0.0, 0.0]], [true; 3]);
        let bonds = from_distance(&frame, &BondRules::within(2.1)).expect("bonds");
        assert_eq!(bonds.len(), 2);
        let mut alone = bonds.clone();
        let leaving = alone.between(2, &Images::default());
        assert_eq!((alone.len(), alone.shift.len()), (1, 0));
        let ends = [(0, 1, [-1, 0, 0]), (1, 0, [1, 0, 0])];
        assert_eq!(leaving, ends.map(|(row, other, shift)| LeavingBond { row, other, shift }));
        // Four rows of three particles.
        let images = Images::on_faces(Points::of(&frame), &[]);
        let mut completed = bonds.clone();
        let leaving = completed.between(2, &images);
        assert_eq!((images.len(), completed.len(), leaving.len()), (10, 8, 8));
        let mut whole = images;
        whole.add_bonded(2, 12, &bonds);
        let mut all = bonds.clone();
        let leaving = all.between(2, &whole);
        assert_eq!((whole.len(), all.len(), leaving.len()), (18, 16, 8));
    }
}
