//! Particles at the boundary of a periodic cell: the cell is completed with the images of particles on its faces, and bonds that
//! leave it end at images, in the middle, or are not drawn.

use super::contents::{Polyhedron, Stub};
use super::polyhedra::Coordination;
use super::{Particles, PeriodicError};
use crate::memory;
use crate::scene::Spheres;
use glam::{DMat3, DVec3};
use spherule_particles::images::{Images, LeavingBond, ON_FACE};
use spherule_particles::neighbors::Points;
use spherule_particles::{Format, Molecule};

/// The treatment of bonds that leave the cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// Molecules are whole, those whose centers are in the cell; bonds of networks without an end are not drawn.
    Molecules,
    /// The particles at their other ends are drawn, too.
    Whole,
    /// They are not drawn.
    None,
    /// Their halves inside are drawn.
    Halves,
}

impl Outside {
    /// All treatments, with their names in options.
    pub const ALL: [(&'static str, Self); 4] = [
        ("molecules", Self::Molecules),
        ("whole", Self::Whole),
        ("none", Self::None),
        ("halves", Self::Halves),
    ];

    /// Returns the name in options.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, own)| *own == self).map_or("", |(name, _)| name)
    }
}

/// The part of a periodic structure that is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Boundary {
    /// True if particles on faces, edges and corners of the cell are drawn on the opposite ones, too; `None` for
    /// [crystals](Particles::completes_cell).
    pub complete: Option<bool>,
    /// The treatment of bonds that leave the cell; `None` for molecules in a completed cell, and else for halves.
    pub outside: Option<Outside>,
}

impl Particles {
    /// Returns whether the cell is completed if nothing else is asked for: that of a small crystal
    /// ([`ParticleFrame::has_crystal_cell`](super::ParticleFrame::has_crystal_cell)), if the file has no other frames, between which
    /// particles would come and go.
    pub fn completes_cell(&self) -> bool {
        self.has_crystal_cell && (self.first_frame.is_none() || self.frame.format == Format::Cif)
    }

    fn completes(&self, boundary: Boundary) -> bool {
        boundary.complete.unwrap_or_else(|| self.completes_cell())
    }

    fn outside(&self, boundary: Boundary) -> Outside {
        let usual = if self.completes(boundary) { Outside::Molecules } else { Outside::Halves };
        boundary.outside.unwrap_or(usual)
    }

    /// Makes the molecules of the cell whole, if they are drawn so ([`Outside::Molecules`]): moves their particles by whole edges, so
    /// that no bond crosses the cell and the center of each molecule is in it. Does nothing without bonds.
    pub fn gather_molecules(&mut self, boundary: Boundary) {
        let (Outside::Molecules, Some(bonds), Some(cell)) =
            (self.outside(boundary), &self.frame.bonds, self.frame.cell)
        else {
            return;
        };
        let (matrix, periodic) = (cell.matrix(), DVec3::from(cell.periodic.map(f64::from)));
        let mut moves = vec![[0; 3]; self.spheres.len()];
        for Molecule { rows, moves: own } in bonds.molecules(self.spheres.len()) {
            let mean: DVec3 = own.iter().map(|edges| DVec3::from(edges.map(f64::from))).sum();
            let center = cell.fractional(self.points().center(&rows)) + mean / rows.len() as f64;
            // Those on a face are at its beginning.
            let outside = (center + ON_FACE).floor() * periodic;
            for (row, edges) in rows.iter().zip(own) {
                let edge = |axis: usize| edges[axis] - outside[axis] as i32;
                moves[*row as usize] = [edge(0), edge(1), edge(2)];
            }
        }
        for (row, edges) in moves.iter().enumerate() {
            let by = matrix * DVec3::from(edges.map(f64::from));
            self.spheres.x[row] += by.x;
            self.spheres.y[row] += by.y;
            self.spheres.z[row] += by.z;
        }
        if let Some(bonds) = &mut self.frame.bonds {
            bonds.move_particles(|row| moves[row].map(|edge| -edge));
        }
    }

    /// Returns the rows of each molecule that is whole.
    fn whole_molecules(&self) -> Vec<Vec<u32>> {
        let molecules = self.frame.bonds.as_ref().map(|bonds| bonds.molecules(self.spheres.len()));
        let is_whole = |molecule: &Molecule| molecule.moves.iter().all(|edges| *edges == [0; 3]);
        let whole = molecules.into_iter().flatten().filter(is_whole);
        whole.map(|molecule| molecule.rows).collect()
    }

    /// Draws the boundary of the cell: appends the images that are asked for, with all columns of their particles, and changes the
    /// bonds to those between what is drawn. Polyhedra become those of all centers in the cell; their corners are drawn, too, unless
    /// nothing outside is to be drawn: then those with other corners are left out. Molecules are whole that
    /// [`gather_molecules`](Self::gather_molecules) has made so.
    ///
    /// # Errors
    /// There is no cell to complete, or there would be too many spheres; then nothing has changed.
    pub fn draw_boundary(
        &mut self,
        boundary: Boundary,
        coordinations: &[Coordination],
    ) -> Result<(), PeriodicError> {
        let Boundary { complete, outside } = boundary;
        if complete == Some(true) {
            let cell = self.frame.cell.ok_or(PeriodicError::NoCell("complete"))?;
            if cell.periodic == [false; 3] {
                return Err(PeriodicError::NotPeriodic("complete"));
            }
        }
        let leaving = self.outside(boundary);
        let count = self.spheres.len();
        let mut images = Images::default();
        if self.completes(boundary) {
            let is_of_molecules = leaving == Outside::Molecules;
            let molecules = if is_of_molecules { self.whole_molecules() } else { Vec::new() };
            images = Images::on_faces(self.points(), &molecules);
        }
        let in_cell = count + images.len();
        let centers: Vec<(&Coordination, [i32; 3], u32)> = images
            .nodes(count)
            .take(in_cell)
            .enumerate()
            .filter_map(|(place, (row, shift))| {
                let found = coordinations.binary_search_by_key(&row, |own| own.center).ok()?;
                Some((&coordinations[found], shift, place as u32))
            })
            .collect();
        if outside != Some(Outside::None) {
            for (coordination, shift, _) in &centers {
                coordination.corners(*shift).for_each(|(row, shift)| images.add(row, shift));
            }
        }
        if let (Outside::Whole, Some(bonds)) = (leaving, &self.frame.bonds) {
            images.add_bonded(count, in_cell, bonds);
        }
        self.check_images(&images)?;
        let row = |(row, shift): (u32, [i32; 3])| images.row_of(count, row, shift);
        let drawn = centers.iter().filter_map(|(coordination, shift, place)| {
            let corners = coordination.corners(*shift).map(row).collect::<Option<Vec<u32>>>()?;
            Some(Polyhedron::new(*place, &corners, coordination))
        });
        self.added.polyhedra = drawn.collect();
        if images.is_empty() && leaving == Outside::Halves {
            return Ok(());
        }
        let bonds = self.frame.bonds.as_mut();
        let ends = bonds.map_or_else(Vec::new, |bonds| bonds.between(count, &images));
        self.append(&images);
        if leaving == Outside::Halves {
            self.added.stubs = ends.iter().map(|end| self.stub(*end)).collect();
        }
        Ok(())
    }

    /// Returns the centers, and the cell.
    pub(super) fn points(&self) -> Points<'_> {
        let Spheres { x, y, z, .. } = &self.spheres;
        Points { axes: [x, y, z], cell: self.frame.cell.as_ref() }
    }

    /// Returns an error if there are too many images.
    fn check_images(&self, images: &Images) -> Result<(), PeriodicError> {
        let (count, more) = (self.spheres.len() as u64, images.len() as u64);
        if count + more > Spheres::MAX {
            return Err(PeriodicError::TooManyImages(count + more));
        }
        // Columns are gathered before they are dropped.
        memory::check(more * self.row_bytes() + count * size_of::<f64>() as u64)
            .map_err(|shortage| PeriodicError::MemoryOfImages(count + more, shortage))
    }

    /// Appends images, with all columns but bonds.
    fn append(&mut self, images: &Images) {
        let count = self.spheres.len();
        let matrix = self.frame.cell.map_or(DMat3::IDENTITY, |cell| cell.matrix());
        for (&row, shift) in images.rows.iter().zip(&images.shifts) {
            let (spheres, row) = (&mut self.spheres, row as usize);
            let center = spheres.center(row) + matrix * DVec3::from(shift.map(f64::from));
            let (radius, color) = (spheres.radius[row], spheres.color_of(row));
            spheres.push(center, radius, spheres.material_of(row), color);
            if let Some(stick) = self.stick_radii.get(row).copied() {
                self.stick_radii.push(stick);
            }
        }
        self.frame.append_rows(count, &images.rows);
        self.arrows.append_rows(&images.rows);
    }

    fn stub(&self, LeavingBond { row, other, shift }: LeavingBond) -> Stub {
        let matrix = self.frame.cell.map_or(DMat3::IDENTITY, |cell| cell.matrix());
        let end = self.spheres.center(other as usize) + matrix * DVec3::from(shift.map(f64::from));
        Stub { row, half: (end - self.spheres.center(row as usize)) / 2.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::{Bonds, Cell, NumberColumn};
    use crate::scene::{Rgb, Scene};

    /// A particle on a corner of the cell, one on a face and one inside, and bonds from the first to the others and over the cell.
    fn particles() -> Particles {
        let mut particles = Particles { has_crystal_cell: true, ..Particles::default() };
        let vectors = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * 4.0);
        particles.frame.cell = Some(Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] });
        for (at, color) in [([0.0; 3], Rgb::X), ([2.0, 0.0, 2.0], Rgb::Y), ([2.0; 3], Rgb::Z)] {
            particles.spheres.push(at.into(), 0.5, 0, color);
        }
        let shift = vec![[0; 3], [-1, 0, 0], [0; 3]];
        let (first, second) = (vec![0, 0, 1], vec![1, 1, 2]);
        particles.frame.bonds = Some(Bonds { first, second, shift, ..Bonds::default() });
        particles.stick_radius = 0.1;
        let values = vec![5.0, 6.0, 7.0];
        particles.frame.numbers.push(NumberColumn { name: "q".to_owned(), values });
        particles
    }

    fn drawn(complete: Option<bool>, outside: Option<Outside>) -> (Particles, usize, usize) {
        let mut own = particles();
        own.draw_boundary(Boundary { complete, outside }, &[]).unwrap();
        let scene = Scene::of_particles(own.clone(), "");
        (own, scene.spheres.len(), scene.sticks.len())
    }

    #[test]
    fn cells_of_crystals_are_completed() {
        let (own, spheres, sticks) = drawn(None, None);
        // Eight corners, two faces, and what is inside; each face has a stick to two of its corners or to the inside.
        assert_eq!((spheres, sticks), (11, 5));
        assert_eq!(own.frame.numbers[0].values.iter().filter(|value| **value == 5.0).count(), 8);
        for row in 0..11 {
            let first = (own.frame.numbers[0].values[row] - 5.0) as usize;
            let moved = (own.spheres.center(row) - particles().spheres.center(first)) / 4.0;
            assert!(moved == moved.round() && moved.abs().max_element() <= 1.0, "{moved}");
            assert_eq!(own.spheres.color_of(row), particles().spheres.color_of(first));
        }
        let mut movie = particles();
        movie.has_crystal_cell = false;
        movie.draw_boundary(Boundary::default(), &[]).unwrap();
        assert_eq!(movie.spheres.len(), 3);
    }

    #[test]
    fn bonds_that_leave_end_at_particles_or_halfway_or_are_not_drawn() {
        use Outside::{Halves, Molecules, None, Whole};
        for (complete, outside, expected) in [
            (false, Option::None, (3, 4)),
            (false, Some(Halves), (3, 4)),
            (false, Some(None), (3, 2)),
            (false, Some(Whole), (5, 4)),
            (true, Some(None), (11, 5)),
            // A network without an end has no molecules.
            (true, Some(Molecules), (11, 5)),
            (true, Some(Halves), (11, 5 + 13)),
        ] {
            let (_, spheres, sticks) = drawn(Some(complete), outside);
            assert_eq!((spheres, sticks), expected, "{complete} {outside:?}");
        }
        let (whole, ..) = drawn(Some(true), Some(Whole));
        assert!(whole.added.stubs.is_empty() && whole.spheres.len() > 11);
        let (halves, ..) = drawn(Some(true), Some(Halves));
        let length = |stub: &Stub| stub.half.length_squared();
        assert!(halves.added.stubs.iter().all(|stub| [1.0, 2.0].contains(&length(stub))));
    }

    #[test]
    fn molecules_are_whole_with_their_centers_in_the_cell() {
        // Three particles in a row over the corner of the cell, and a pair over a face whose center is inside.
        let mut own = particles();
        own.spheres = Spheres::default();
        let places = [[3.0, 0.0, 0.0], [0.0; 3], [1.0, 4.0, 0.0], [2.0, 2.0, 3.8], [2.0, 2.0, 0.6]];
        for at in places {
            own.spheres.push(at.into(), 0.5, 0, Rgb::ONE);
        }
        own.frame.numbers[0].values = vec![0.0, 1.0, 2.0, 3.0, 4.0];
        let (first, second) = (vec![0, 1, 3], vec![1, 2, 4]);
        let shift = vec![[1, 0, 0], [0, -1, 0], [0, 0, 1]];
        own.frame.bonds = Some(Bonds { first, second, shift, ..Bonds::default() });
        let complete = Boundary { complete: Some(true), outside: None };
        own.gather_molecules(complete);
        let gathered = own.spheres.clone();
        own.gather_molecules(complete);
        assert_eq!(own.spheres, gathered);
        let center = |row| own.spheres.center(row);
        assert_eq!([center(0), center(1), center(2)], [-DVec3::X, DVec3::ZERO, DVec3::X]);
        assert!((center(4).z - center(3).z - 0.8).abs() < 1e-12 && center(3).z < 0.0);
        own.draw_boundary(complete, &[]).unwrap();
        // The first is on eight corners, with both of its bonds.
        let bonds = own.frame.bonds.as_ref().map_or(0, Bonds::len);
        assert_eq!((own.spheres.len(), bonds), (8 * 3 + 2, 8 * 2 + 1));
        let cut = Boundary { outside: Some(Outside::None), ..complete };
        let mut other = particles();
        other.gather_molecules(cut);
        assert_eq!(other.spheres, particles().spheres);
    }

    #[test]
    fn cells_that_cannot_be_completed_are_refused() {
        let complete = Boundary { complete: Some(true), outside: None };
        let mut own = particles();
        own.frame.cell.as_mut().unwrap().periodic = [false; 3];
        assert_eq!(own.draw_boundary(complete, &[]), Err(PeriodicError::NotPeriodic("complete")));
        own.frame.cell = None;
        assert_eq!(own.draw_boundary(complete, &[]), Err(PeriodicError::NoCell("complete")));
    }
}
