//! Arrays of an archive that are not columns of particles: the cell, and those that are not drawn.

use super::archive::Npz;
use super::array::Transpose;
use crate::{Cell, FileError, ParticleFrame, gsd, undrawn::Undrawn};
use glam::DVec3;

/// Names of arrays that hold the cell.
const CELLS: [&str; 4] = ["box", "cell", "lattice", "unit_cell"];

/// Threshold to distinguish a cell's angles in degrees, which are greater, from tilts.
const LEAST_ANGLE: f64 = 15.0;

impl Npz {
    /// Reads the cell from the arrays that are not `used`, and adds warnings about those not drawn.
    pub(super) fn read_rest(
        &mut self,
        frame: &mut ParticleFrame,
        used: &[String],
    ) -> Result<(), FileError> {
        let count = frame.len() as u64;
        let mut unused = Vec::new();
        for name in self.names().into_iter().filter(|name| !used.contains(name)) {
            let is = |names: &[&str]| names.iter().any(|own| own.eq_ignore_ascii_case(&name));
            let transpose = if is(&CELLS) { Transpose::Never } else { self.to_rows(frame.len()) };
            let Some([rows, columns]) = self.shape(&name, transpose) else {
                unused.push(name);
                continue;
            };
            if is(&CELLS) && frame.cell.is_none() && self.has_row_for_each_frame([rows, columns]) {
                let values = self.numbers(&name)?;
                let row = values.chunks_exact(columns as usize).nth(self.frame_number());
                frame.cell = row.and_then(|row| cell([columns, 1], row, frame));
                if frame.cell.is_none() {
                    unused.push(name);
                }
            } else if is(&CELLS) && frame.cell.is_none() && rows.saturating_mul(columns) <= 9 {
                let values = self.numbers(&name)?;
                frame.cell = cell([rows, columns], &values, frame);
                if frame.cell.is_none() {
                    unused.push(name);
                }
            } else if is(&["bonds", "bond"]) && columns == 2 {
                frame.add_undrawn(Undrawn::Bonds, rows);
            } else if rows != count {
                // Other arrays are columns.
                unused.push(name);
            }
        }
        let unused: Vec<&str> = unused.iter().map(String::as_str).collect();
        frame.add_unused_arrays(&unused);
        Ok(())
    }
}

/// Returns the cell of an array in the layout of HOOMD-blue (lengths and tilts, or a matrix of columns),
/// `MDAnalysis` (lengths and angles) or ASE (a matrix of rows), or of a lower and an upper corner.
fn cell(shape: [u64; 2], values: &[f64], frame: &ParticleFrame) -> Option<Cell> {
    let vector = |at: usize| DVec3::from_slice(&values[at..at + 3]);
    let diagonal =
        |lengths: DVec3| [DVec3::X * lengths.x, DVec3::Y * lengths.y, DVec3::Z * lengths.z];
    let at_corner = |vectors, origin| Cell { origin, vectors, periodic: [true; 3] }.declared();
    match (shape, values.len()) {
        ([6, 1] | [1, 6], 6) if values[3..].iter().all(|angle| *angle > LEAST_ANGLE) => {
            let [a, b, c] = vector(0).to_array();
            Cell::of_lengths([a, b, c], vector(3).to_array())
        }
        ([6, 1] | [1, 6], 6) => gsd::cell(values),
        ([2, 3], 6) => at_corner(diagonal(vector(3) - vector(0)), vector(0)),
        ([3, 2], 6) => {
            let [low, high] =
                [0, 1].map(|at| DVec3::new(values[at], values[at + 2], values[at + 4]));
            at_corner(diagonal(high - low), low)
        }
        ([3, 1] | [1, 3], 3) => {
            at_corner(diagonal(vector(0)), DVec3::ZERO).map(|cell| placed(cell, frame))
        }
        ([3, 3] | [9, 1], 9) => {
            let rows = [vector(0), vector(3), vector(6)];
            let upper = [values[3], values[6], values[7]] == [0.0; 3];
            let column = |at: usize| DVec3::new(values[at], values[at + 3], values[at + 6]);
            let vectors = if upper { [0, 1, 2].map(column) } else { rows };
            at_corner(vectors, DVec3::ZERO).map(|cell| placed(cell, frame))
        }
        _ => None,
    }
}

/// Places the cell with its center or a corner at the origin, whichever encloses more particles.
fn placed(cell: Cell, frame: &ParticleFrame) -> Cell {
    let center: DVec3 = cell.vectors.iter().sum::<DVec3>() * 0.5;
    let around = Cell { origin: cell.origin - center, ..cell };
    let inside = |cell: &Cell| {
        let places = (0..frame.len()).map(|row| cell.fractional(frame.position(row)));
        places.filter(|place| place.min_element() >= 0.0 && place.max_element() <= 1.0).count()
    };
    if inside(&around) > inside(&cell) { around } else { cell }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(shape: [u64; 2], values: &[f64], x: f64) -> Option<Cell> {
        let frame =
            ParticleFrame { x: vec![x], y: vec![x], z: vec![x], ..ParticleFrame::default() };
        cell(shape, values, &frame)
    }

    #[test]
    fn cells_are_read_in_the_usual_layouts() {
        let corner = |values: &[f64], shape, x| of(shape, values, x).expect("a cell").origin;
        let tilted = of([6, 1], &[4.0, 5.0, 6.0, 0.5, 0.0, 0.0], 1.0).expect("a cell");
        assert_eq!(tilted.vectors[1], DVec3::new(2.5, 5.0, 0.0));
        assert_eq!(tilted.cartesian([0.5; 3]), DVec3::ZERO);
        let angles = of([6, 1], &[4.0, 5.0, 6.0, 90.0, 90.0, 90.0], 1.0).expect("a cell");
        assert_eq!((angles.origin, angles.vectors[2]), (DVec3::ZERO, DVec3::Z * 6.0));
        // Angles are greater than 15, tilts are not.
        let skewed = of([6, 1], &[4.0, 5.0, 6.0, 15.0, 15.0, 15.0], 1.0).expect("a cell");
        assert_eq!(skewed.vectors[1].x, 75.0);
        assert_eq!(corner(&[4.0; 3], [3, 1], 1.0), DVec3::ZERO);
        assert_eq!(corner(&[4.0; 3], [3, 1], -1.0), DVec3::splat(-2.0));
        let rows = [4.0, 0.0, 0.0, 1.0, 5.0, 0.0, 0.0, 0.0, 6.0];
        let columns = [4.0, 1.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 6.0];
        for matrix in [rows, columns] {
            let cell = of([3, 3], &matrix, 1.0).expect("a cell");
            assert_eq!(cell.vectors[1], DVec3::new(1.0, 5.0, 0.0));
        }
        for (shape, bounds) in
            [([2, 3], [1.0, 2.0, 3.0, 5.0, 7.0, 9.0]), ([3, 2], [1.0, 5.0, 2.0, 7.0, 3.0, 9.0])]
        {
            let cell = of(shape, &bounds, 1.0).expect("a cell");
            assert_eq!(cell.origin, DVec3::new(1.0, 2.0, 3.0));
            assert_eq!(cell.cartesian([1.0; 3]), DVec3::new(5.0, 7.0, 9.0));
        }
        for (shape, values) in
            [([6, 1], &[0.0; 6][..]), ([4, 1], &[1.0; 4]), ([3, 1], &[f64::NAN; 3])]
        {
            assert_eq!(of(shape, values, 1.0), None, "{values:?}");
        }
    }
}
