//! Periodic particles: wrapping into the cell, and replication of the cell.

use super::{Bonds, Cell, Codes, Particles};
use crate::memory::{self, Shortage};
use crate::scene::Spheres;
use glam::{DQuat, DVec3};

/// Names of the edges of a cell.
const EDGES: [&str; 3] = ["a", "b", "c"];

/// Reasons why particles cannot be wrapped, replicated or completed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PeriodicError {
    /// The file has no cell.
    #[error("cannot {0} particles: the file has no cell")]
    NoCell(&'static str),
    /// No edge is periodic.
    #[error("cannot {0} particles: the cell is not periodic along any of its edges")]
    NotPeriodic(&'static str),
    /// More than one copy along an edge that is not periodic.
    #[error("the cell is not periodic along its edge {0}: cannot make {1} copies along it")]
    Edge(&'static str, u32),
    /// No copies at all.
    #[error("cannot make 0 copies: write 1 or more along each edge")]
    NoCopies,
    /// More spheres than a scene may hold.
    #[error("{0} copies make {1} spheres, but a scene holds at most {max}", max = Spheres::MAX)]
    TooMany(u64, u64),
    /// More spheres than memory holds.
    #[error("{0} copies make {1} spheres, which need {2}")]
    Memory(u64, u64, Shortage),
    /// More spheres with images at the boundary than a scene may hold.
    #[error("images at the boundary of the cell make {0} spheres, but a scene holds at most {max}", max = Spheres::MAX)]
    TooManyImages(u64),
    /// More spheres with images at the boundary than memory holds.
    #[error("images at the boundary of the cell make {0} spheres, which need {1}")]
    MemoryOfImages(u64, Shortage),
}

impl Particles {
    /// Moves centers into the cell by whole edges, along its periodic edges.
    ///
    /// # Errors
    /// There is no cell, or none of its edges is periodic.
    pub fn wrap(&mut self) -> Result<(), PeriodicError> {
        let cell = self.frame.cell.ok_or(PeriodicError::NoCell("wrap"))?;
        if cell.periodic == [false; 3] {
            return Err(PeriodicError::NotPeriodic("wrap"));
        }
        let inverse = cell.matrix().inverse();
        let mut moves = vec![[0; 3]; self.frame.bonds.as_ref().map_or(0, |_| self.spheres.len())];
        let spheres = &mut self.spheres;
        for row in 0..spheres.len() {
            let center = spheres.center(row);
            let cells = (inverse * (center - cell.origin)).floor();
            let edges = cell.periodic.map(f64::from);
            let wrapped = center - cell.matrix() * (cells * DVec3::from(edges));
            [spheres.x[row], spheres.y[row], spheres.z[row]] = wrapped.to_array();
            if let Some(edges_of_row) = moves.get_mut(row) {
                *edges_of_row = (cells * DVec3::from(edges)).to_array().map(|edges| edges as i32);
            }
        }
        if let Some(bonds) = &mut self.frame.bonds {
            bonds.move_particles(|row| moves[row]);
        }
        Ok(())
    }

    /// Replicates the cell: `copies` along each edge in total, including the original. The cell grows
    /// to hold them. Rows of copies follow in the order of the particles.
    ///
    /// # Errors
    /// There is no cell, an edge with several copies is not periodic, or there would be too many
    /// spheres for a scene or for memory; then nothing has changed.
    pub fn replicate(&mut self, copies: [u32; 3]) -> Result<(), PeriodicError> {
        let cell = self.frame.cell.ok_or(PeriodicError::NoCell("replicate"))?;
        let count = self.check_copies(&cell, copies)?;
        if count == 1 {
            return Ok(());
        }
        let shifts = shifts(&cell, copies);
        let spheres = &mut self.spheres;
        let columns = [&mut spheres.x, &mut spheres.y, &mut spheres.z];
        for (axis, column) in columns.into_iter().enumerate() {
            let shifts = shifts.iter().map(|shift| shift[axis]);
            *column = shifts.flat_map(|shift| column.iter().map(move |x| x + shift)).collect();
        }
        spheres.radius = spheres.radius.repeat(count);
        spheres.material = spheres.material.repeat(count);
        spheres.color = spheres.color.repeat(count);
        self.stick_radii = self.stick_radii.repeat(count);
        self.polyhedra = self.polyhedra.repeat(count);
        self.frame.repeat(count);
        self.arrows.vectors = self.arrows.vectors.repeat(count);
        if let Some(bonds) = &mut self.frame.bonds {
            bonds.replicate(self.spheres.len() / count, copies);
        }
        let vectors = std::array::from_fn(|edge| cell.vectors[edge] * f64::from(copies[edge]));
        self.frame.cell = Some(Cell { vectors, ..cell });
        Ok(())
    }

    /// Returns the number of copies, after checking that they can be made.
    fn check_copies(&self, cell: &Cell, copies: [u32; 3]) -> Result<usize, PeriodicError> {
        for (edge, copies) in copies.into_iter().enumerate() {
            match copies {
                0 => return Err(PeriodicError::NoCopies),
                2.. if !cell.periodic[edge] => {
                    return Err(PeriodicError::Edge(EDGES[edge], copies));
                }
                _ => (),
            }
        }
        let count = copies.into_iter().map(u64::from).fold(1, u64::saturating_mul);
        let spheres = count.saturating_mul(self.spheres.len() as u64);
        if spheres > Spheres::MAX {
            return Err(PeriodicError::TooMany(count, spheres));
        }
        // A column is copied before it is dropped.
        let original = self.spheres.len() as u64;
        let bytes = (spheres - original) * self.row_bytes() + original * size_of::<f64>() as u64;
        memory::check(bytes).map_err(|shortage| PeriodicError::Memory(count, spheres, shortage))?;
        Ok(count as usize)
    }

    /// Returns the bytes of a row in all columns.
    pub(super) fn row_bytes(&self) -> u64 {
        let spheres = &self.spheres;
        let texts = self.frame.texts.iter().map(|column| &column.codes);
        let codes = texts.chain([&self.frame.kinds.codes]).filter(|codes| !codes.is_empty());
        let codes: usize = codes.map(Codes::width).sum();
        let numbers =
            size_of::<f64>() * (self.frame.numbers.len() + 3 * self.frame.trails.steps.len());
        let arrows = if self.arrows.vectors.is_empty() { 0 } else { size_of::<DVec3>() };
        let shapes = if self.frame.shapes.is_empty() { 0 } else { size_of::<(DVec3, DQuat)>() };
        // Bonds are sorted beside their columns; they are spread over the particles.
        let bonds = self.frame.bonds.as_ref().map_or(0, Bonds::len) * 3 * size_of::<[u32; 3]>();
        let bonds = bonds.div_ceil(self.spheres.len().max(1));
        spheres.row_bytes() + (numbers + arrows + shapes + codes + bonds) as u64
    }
}

/// Returns the shift of each copy from the original, which is the first.
fn shifts(cell: &Cell, copies: [u32; 3]) -> Vec<DVec3> {
    let [a, b, c] = cell.vectors;
    let mut shifts = Vec::new();
    for k in 0..copies[2] {
        for j in 0..copies[1] {
            let row = b * f64::from(j) + c * f64::from(k);
            shifts.extend((0..copies[0]).map(|i| a * f64::from(i) + row));
        }
    }
    shifts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Rgb;
    use crate::scene::particles::NumberColumn;

    fn tilted() -> Cell {
        Cell {
            origin: DVec3::new(-1.0, 2.0, 5.0),
            vectors: [
                DVec3::new(4.0, 0.0, 0.0),
                DVec3::new(1.0, 3.0, 0.0),
                DVec3::new(-2.0, 0.5, 6.0),
            ],
            periodic: [true, true, false],
        }
    }

    fn particles() -> Particles {
        let mut particles = Particles::default();
        particles.frame.cell = Some(tilted());
        for i in 0..40 {
            let i = f64::from(i);
            let center = DVec3::new((i * 12.9).sin(), (i * 78.2).sin(), (i * 37.7).cos()) * 30.0;
            particles.spheres.push(center, 0.5 + i, 0, Rgb::ONE);
        }
        let values = particles.spheres.radius.clone();
        particles.frame.numbers.push(NumberColumn { name: "q".to_owned(), values });
        particles
    }

    #[test]
    fn wrapped_particles_are_in_the_cell_and_whole_edges_away() {
        let (before, mut after) = (particles(), particles());
        after.wrap().unwrap();
        for row in 0..before.spheres.len() {
            let fractional = tilted().fractional(after.spheres.center(row));
            assert!(fractional.x > -1e-12 && fractional.x < 1.0 + 1e-12, "{fractional}");
            assert!(fractional.y > -1e-12 && fractional.y < 1.0 + 1e-12, "{fractional}");
            let moved = tilted().fractional(before.spheres.center(row)) - fractional;
            assert!((moved - moved.round()).length() < 1e-12 && moved.z.abs() < 1e-12, "{moved}");
        }
    }

    #[test]
    fn copies_lie_whole_edges_away_and_keep_their_columns() {
        let (before, mut after) = (particles(), particles());
        after.replicate([2, 3, 1]).unwrap();
        let count = before.spheres.len();
        assert_eq!(after.spheres.len(), 6 * count);
        for row in 0..6 * count {
            let (copy, old) = (row / count, row % count);
            let [a, b, _] = tilted().vectors;
            let shift = a * (copy % 2) as f64 + b * (copy / 2) as f64;
            let distance = after.spheres.center(row) - before.spheres.center(old) - shift;
            assert!(distance.length() < 1e-12);
            assert_eq!(after.spheres.radius[row], before.spheres.radius[old]);
            assert_eq!(after.frame.numbers[0].values[row], before.frame.numbers[0].values[old]);
        }
        let cell = after.frame.cell.unwrap();
        assert_eq!(
            cell.vectors,
            [tilted().vectors[0] * 2.0, DVec3::new(3.0, 9.0, 0.0), tilted().vectors[2]]
        );
    }

    #[test]
    fn bonds_follow_wrapped_and_copied_particles() {
        let mut particles = particles();
        let cell = tilted();
        let mut bonds =
            Bonds { first: (0..39).collect(), second: (1..40).collect(), ..Bonds::default() };
        bonds.move_particles(|row| [row as i32 % 3, row as i32 % 2, 0]);
        let vector = |particles: &Particles, bonds: &Bonds, bond: usize, cell: &Cell| {
            let ends = [bonds.first[bond], bonds.second[bond]];
            bonds.vector(bond, ends.map(|row| particles.spheres.center(row as usize)), Some(cell))
        };
        let before: Vec<DVec3> =
            (0..39).map(|bond| vector(&particles, &bonds, bond, &cell)).collect();
        particles.frame.bonds = Some(bonds);
        particles.wrap().unwrap();
        let wrapped = particles.frame.bonds.clone().unwrap();
        for (bond, before) in before.iter().enumerate() {
            assert!((vector(&particles, &wrapped, bond, &cell) - *before).length() < 1e-9);
        }
        particles.replicate([3, 2, 1]).unwrap();
        let copies = particles.frame.bonds.clone().unwrap();
        assert_eq!(copies.len(), 6 * 39);
        for bond in 0..copies.len() {
            let one = copies.first[bond].min(copies.second[bond]) as usize % 40;
            let other = copies.first[bond].max(copies.second[bond]) as usize % 40;
            let vector = vector(&particles, &copies, bond, &particles.frame.cell.unwrap());
            let expected = before[one.min(other)];
            let same = (vector - expected).length().min((vector + expected).length());
            assert!(same < 1e-9, "{bond}");
        }
    }

    #[test]
    fn corners_and_edges_are_those_of_a_parallelepiped() {
        let cell = tilted();
        let corners = cell.corners();
        assert_eq!(corners[0], cell.origin);
        assert_eq!(corners[7], cell.origin + cell.vectors.iter().sum::<DVec3>());
        for corner in corners {
            let touching = cell.edges().iter().filter(|edge| edge.contains(&corner)).count();
            assert_eq!(touching, 3);
        }
        for [start, end] in cell.edges() {
            assert!(cell.vectors.iter().any(|edge| (end - start - *edge).length() < 1e-12));
        }
    }

    #[test]
    fn bounds_are_those_of_the_corners() {
        let [low, high] = tilted().bounds();
        assert_eq!(low, DVec3::new(-3.0, 2.0, 5.0));
        assert_eq!(high, DVec3::new(4.0, 5.5, 11.0));
    }

    #[test]
    fn copies_along_the_third_edge_are_shifted_too() {
        let (before, mut after) = (particles(), particles());
        after.frame.cell = Some(Cell { periodic: [true; 3], ..tilted() });
        after.replicate([1, 2, 2]).unwrap();
        let [_, b, c] = tilted().vectors;
        for (copy, shift) in [DVec3::ZERO, b, c, b + c].into_iter().enumerate() {
            let row = copy * before.spheres.len() + 7;
            let distance = after.spheres.center(row) - before.spheres.center(7) - shift;
            assert!(distance.length() < 1e-12, "{copy}");
        }
    }

    #[test]
    fn rows_take_the_bytes_of_their_columns() {
        let mut particles = particles();
        let plain = particles.row_bytes();
        let column = particles.frame.numbers[0].clone();
        particles.frame.numbers.extend([column.clone(), column]);
        assert_eq!(particles.row_bytes(), plain + 16);
        particles.frame.kinds.codes = Codes::Shorts(vec![0; 40]);
        assert_eq!(particles.row_bytes(), plain + 18);
        let bytes = |particles: &Particles| {
            let numbers =
                particles.frame.numbers.iter().map(|column| column.values.len() * 8).sum::<usize>();
            numbers + particles.frame.kinds.codes.len() * 2
        };
        assert_eq!(
            (particles.row_bytes() - particles.spheres.row_bytes()) * 40,
            bytes(&particles) as u64
        );
    }

    #[test]
    fn aperiodic_edges_are_refused_without_changes() {
        let mut particles = particles();
        let before = particles.clone();
        assert_eq!(particles.replicate([1, 1, 2]), Err(PeriodicError::Edge("c", 2)));
        assert_eq!(particles.replicate([0, 1, 1]), Err(PeriodicError::NoCopies));
        let much = particles.replicate([u32::MAX, u32::MAX, 1]);
        assert!(matches!(much, Err(PeriodicError::TooMany(..))));
        let memory = particles.replicate([100_000, 1000, 1]);
        assert!(matches!(memory, Err(PeriodicError::Memory(..))), "{memory:?}");
        assert_eq!(particles, before);
        particles.frame.cell = Some(Cell { periodic: [false; 3], ..tilted() });
        assert_eq!(particles.wrap(), Err(PeriodicError::NotPeriodic("wrap")));
        particles.frame.cell = None;
        assert_eq!(particles.wrap(), Err(PeriodicError::NoCell("wrap")));
        assert_eq!(particles.replicate([1; 3]), Err(PeriodicError::NoCell("replicate")));
    }
}
