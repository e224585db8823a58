//! Frames of crystals, whose structure can be seen.

use super::ParticleFrame;
use crate::Format;

/// The most atoms of a crystal whose bonds are drawn.
const MOST: usize = 10_000;

/// The most atoms of a cell that is completed: that of a crystal's file, and that of another one.
const MOST_COMPLETED: [usize; 2] = [1000, 100];

/// The most volume per atom of a cell that is completed, in cubic angstrom, if no format says that it is a crystal: that of
/// open frameworks and of iodides. Molecules in the middle of an empty box have more.
const MOST_VOLUME: f64 = 60.0;

impl Format {
    /// Returns whether files of this format are those of crystals.
    pub(crate) fn is_of_crystals(self) -> bool {
        matches!(self, Self::Cif | Self::Poscar | Self::Xsf | Self::Cfg)
    }
}

impl ParticleFrame {
    /// Returns whether the particles are the atoms of a crystal, few enough that its structure can be seen: at most
    /// 10,000 from a file of a format of crystals, of known elements and without radii, in a cell that is periodic in
    /// all directions.
    pub fn is_crystal(&self) -> bool {
        self.format.is_of_crystals() && self.has_atoms_in_cell(MOST)
    }

    /// Returns whether the cell is that of a crystal, small enough that particles on its faces are looked for on the opposite
    /// ones, too: of known elements and without radii, periodic in all directions, with at most 1000 atoms from a file
    /// of a format of crystals, or at most 100 of at most 60 cubic angstrom each from extended XYZ or a trajectory of ASE.
    pub fn has_crystal_cell(&self) -> bool {
        let [of_crystals, others] = MOST_COMPLETED;
        if self.format.is_of_crystals() {
            return self.has_atoms_in_cell(of_crystals);
        }
        let volume = self.cell.map_or(0.0, |cell| cell.matrix().determinant().abs());
        let atom = (MOST_VOLUME * self.unit.per_angstrom().powi(3)) * self.len() as f64;
        matches!(self.format, Format::Xyz | Format::AseTrajectory)
            && self.has_atoms_in_cell(others)
            && volume <= atom
    }

    fn has_atoms_in_cell(&self, most: usize) -> bool {
        let is_periodic = self.cell.as_ref().is_some_and(|cell| cell.periodic == [true; 3]);
        let mut kinds = self.kinds.table.iter();
        is_periodic
            && (1..=most).contains(&self.len())
            && self.radius.is_empty()
            && !self.kinds.codes.is_empty()
            && kinds.all(|kind| kind.element.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Codes, Element, Kind};
    use glam::DVec3;

    fn frame(format: Format, count: usize, edge: f64) -> ParticleFrame {
        let vectors = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * edge);
        let mut frame = ParticleFrame {
            x: vec![0.0; count],
            format,
            cell: Some(Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] }),
            ..ParticleFrame::default()
        };
        let element = Element::from_symbol("Cu");
        frame.kinds.table.push(Kind { name: "Cu".to_owned(), element, ..Kind::default() });
        frame.kinds.codes = Codes::Bytes(vec![0; count]);
        frame
    }

    #[test]
    fn cells_of_crystals_are_small_and_full() {
        for (format, count, edge, is_crystal, has_cell) in [
            (Format::Cif, 4, 3.6, true, true),
            (Format::Poscar, 1000, 80.0, true, true),
            (Format::Poscar, 1001, 22.0, true, false),
            (Format::Poscar, 10_001, 50.0, false, false),
            (Format::Xyz, 4, 3.6, false, true),
            (Format::Xyz, 101, 10.0, false, false),
            // A molecule of water in a box.
            (Format::Xyz, 3, 10.0, false, false),
            (Format::LammpsDump, 4, 3.6, false, false),
        ] {
            let frame = frame(format, count, edge);
            let found = (frame.is_crystal(), frame.has_crystal_cell());
            assert_eq!(found, (is_crystal, has_cell), "{format:?} {count} {edge}");
        }
        let mut layer = frame(Format::Cif, 4, 3.6);
        layer.cell.as_mut().expect("a cell").periodic[2] = false;
        assert!(!layer.is_crystal() && !layer.has_crystal_cell());
    }
}
