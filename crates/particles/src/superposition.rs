//! Superposition of frames: the rotation and translation that bring particles nearest to those of the first
//! frame (Horn, "Closed-form solution of absolute orientation using unit quaternions", Journal of the Optical
//! Society of America A4, 1987), as the algorithm of Kabsch finds it.

use crate::{ParticleFrame, aliases};
use glam::{DMat3, DQuat, DVec3};
use std::fmt;
use std::sync::Arc;

/// Maximum number of sweeps of Jacobi's method; it converges quadratically, in about six.
const SWEEPS: usize = 50;

/// Returns for each particle of a frame whether it is used, or a message.
type RowFilter = dyn Fn(&ParticleFrame) -> Result<Vec<bool>, String> + Send + Sync;

/// The particles by which frames are superposed.
#[derive(Clone)]
pub struct AlignBy {
    name: String,
    /// Columns that the choice depends on, with their other names.
    columns: Vec<String>,
    rows: Option<Arc<RowFilter>>,
}

impl AlignBy {
    /// Superposes frames by all particles.
    pub fn all() -> Self {
        Self { name: String::new(), columns: Vec::new(), rows: None }
    }

    /// Superposes frames by the particles that a function chooses in the first frame, by columns with these
    /// names; the name stands for it in comparisons.
    pub fn rows(
        name: &str,
        columns: &[String],
        rows: impl Fn(&ParticleFrame) -> Result<Vec<bool>, String> + Send + Sync + 'static,
    ) -> Self {
        let others = columns.iter().flat_map(|name| aliases::of(name)).map(str::to_owned);
        let columns = columns.iter().cloned().chain(others).collect();
        Self { name: name.to_owned(), columns, rows: Some(Arc::new(rows)) }
    }

    /// Returns the columns that the choice depends on.
    pub(crate) fn columns(&self) -> &[String] {
        &self.columns
    }
}

impl PartialEq for AlignBy {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.rows.is_some() == other.rows.is_some()
    }
}

impl fmt::Debug for AlignBy {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_tuple("AlignBy").field(&self.name).finish()
    }
}

/// The particles of the first frame, by which others are superposed.
pub(crate) struct Reference {
    rows: Vec<u32>,
    positions: Vec<DVec3>,
    /// Number of particles of the frame.
    count: usize,
}

impl Reference {
    /// Returns the particles of a frame that are chosen.
    ///
    /// # Errors
    ///
    /// A message: fewer than three particles are chosen.
    pub(crate) fn new(frame: &ParticleFrame, by: &AlignBy) -> Result<Self, String> {
        let count = frame.len();
        let chosen = match &by.rows {
            Some(rows) => rows(frame)?,
            None => vec![true; count],
        };
        let usable = |row: &u32| chosen[*row as usize] && frame.position(*row as usize).is_finite();
        let rows: Vec<u32> = (0..count as u32).filter(usable).collect();
        if rows.len() < 3 {
            let chosen = rows.len();
            return Err(format!("cannot be aligned by {chosen} particles: choose three or more"));
        }
        let positions = rows.iter().map(|&row| frame.position(row as usize)).collect();
        Ok(Self { rows, positions, count })
    }

    /// Moves and rotates a frame and its cell onto the reference.
    ///
    /// # Errors
    ///
    /// A message: the frame has another number of particles.
    pub(crate) fn align(&self, frame: &mut ParticleFrame) -> Result<(), String> {
        if frame.len() != self.count {
            let (own, count) = (frame.len(), self.count);
            return Err(format!(
                "cannot be aligned: a frame has {own} particles, the first {count}"
            ));
        }
        let own: Vec<DVec3> = self.rows.iter().map(|&row| frame.position(row as usize)).collect();
        let Superposition { rotation, from, to } = Superposition::new(&self.positions, &own);
        let moved = |point: DVec3| rotation * (point - from) + to;
        for row in 0..frame.len() {
            [frame.x[row], frame.y[row], frame.z[row]] = moved(frame.position(row)).to_array();
        }
        frame.shapes.rotate(DQuat::from_mat3(&rotation));
        frame.rotation = rotation;
        if let Some(cell) = &mut frame.cell {
            cell.origin = moved(cell.origin);
            cell.vectors = cell.vectors.map(|edge| rotation * edge);
        }
        Ok(())
    }
}

/// A rotation about one point, and the translation to another.
struct Superposition {
    rotation: DMat3,
    from: DVec3,
    to: DVec3,
}

impl Superposition {
    /// Returns the superposition of points on a reference with the least sum of squared distances.
    fn new(reference: &[DVec3], points: &[DVec3]) -> Self {
        let mean = |points: &[DVec3]| points.iter().sum::<DVec3>() / points.len() as f64;
        let (to, from) = (mean(reference), mean(points));
        let mut product = DMat3::ZERO;
        for (there, here) in reference.iter().zip(points) {
            let (there, here) = (*there - to, *here - from);
            product += DMat3::from_cols(here * there.x, here * there.y, here * there.z);
        }
        // Entry (a, b) is the sum of the products of component a of a point and b of its reference.
        let s = |a: usize, b: usize| product.col(b)[a];
        let matrix = [
            [s(0, 0) + s(1, 1) + s(2, 2), s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0)],
            [0.0, s(0, 0) - s(1, 1) - s(2, 2), s(0, 1) + s(1, 0), s(2, 0) + s(0, 2)],
            [0.0, 0.0, s(1, 1) - s(0, 0) - s(2, 2), s(1, 2) + s(2, 1)],
            [0.0, 0.0, 0.0, s(2, 2) - s(0, 0) - s(1, 1)],
        ];
        let [w, x, y, z] = greatest_eigenvector(matrix);
        let rotation = DQuat::from_xyzw(x, y, z, w).normalize();
        let rotation = if rotation.is_finite() { rotation } else { DQuat::IDENTITY };
        Self { rotation: DMat3::from_quat(rotation), from, to }
    }
}

/// Returns the eigenvector of the greatest eigenvalue of a symmetric matrix, of which the upper half is given,
/// by Jacobi's method.
fn greatest_eigenvector(upper: [[f64; 4]; 4]) -> [f64; 4] {
    let mut matrix = upper;
    for row in 0..4 {
        for column in 0..row {
            matrix[row][column] = upper[column][row];
        }
    }
    let mut vectors =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..3 {
            for q in p + 1..4 {
                let off = matrix[p][q];
                let scale = matrix[p][p].abs() + matrix[q][q].abs();
                if off == 0.0 || off.abs() <= f64::EPSILON * 1e-3 * scale || !off.is_finite() {
                    continue;
                }
                rotated = true;
                let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * off);
                let sign = if theta < 0.0 { -1.0 } else { 1.0 };
                let tangent = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
                let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
                let sine = tangent * cosine;
                for row in &mut matrix {
                    (row[p], row[q]) =
                        (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
                }
                let (one, other) = (matrix[p], matrix[q]);
                matrix[p] = std::array::from_fn(|at| cosine * one[at] - sine * other[at]);
                matrix[q] = std::array::from_fn(|at| sine * one[at] + cosine * other[at]);
                for row in &mut vectors {
                    (row[p], row[q]) =
                        (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let greatest = (1..4)
        .fold(0, |best, next| if matrix[next][next] > matrix[best][best] { next } else { best });
    vectors.map(|row| row[greatest])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::Cell;
    use proptest::prelude::*;

    fn frame(points: &[DVec3]) -> ParticleFrame {
        let axis = |axis: usize| points.iter().map(|point| point[axis]).collect();
        ParticleFrame { x: axis(0), y: axis(1), z: axis(2), ..ParticleFrame::default() }
    }

    fn distance2(one: &ParticleFrame, other: &ParticleFrame) -> f64 {
        (0..one.len()).map(|row| one.position(row).distance_squared(other.position(row))).sum()
    }

    fn rotation([x, y, z, w]: [f64; 4]) -> DMat3 {
        DMat3::from_quat(DQuat::from_xyzw(x, y, z, w + 1e-3).normalize())
    }

    proptest! {
        #[test]
        fn rigid_motions_are_undone(
            points in prop::collection::vec([-9.0..9.0_f64, -9.0..9.0, -9.0..9.0], 4..40),
            turn in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, 0.0..1.0],
            by in [-99.0..99.0_f64, -99.0..99.0, -99.0..99.0],
        ) {
            let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
            let first = frame(&points);
            let reference = Reference::new(&first, &AlignBy::all()).expect("a reference");
            let (turn, by) = (rotation(turn), DVec3::from(by));
            let moved: Vec<DVec3> = points.iter().map(|point| turn * *point + by).collect();
            let mut moved = frame(&moved);
            let vectors = [turn.x_axis, turn.y_axis, turn.z_axis];
            moved.cell = Some(Cell { origin: by, vectors, periodic: [true; 3] });
            reference.align(&mut moved).expect("a frame");
            prop_assert!(distance2(&first, &moved) < 1e-18 * 1e4);
            let cell = moved.cell.expect("a cell");
            prop_assert!(cell.origin.length() < 1e-9);
            prop_assert!((cell.vectors[0] - DVec3::X).length() < 1e-9);
        }

        #[test]
        fn no_other_rotation_is_nearer(
            points in prop::collection::vec([-9.0..9.0_f64, -9.0..9.0, -9.0..9.0], 4..20),
            others in prop::collection::vec([-9.0..9.0_f64, -9.0..9.0, -9.0..9.0], 20),
            turn in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0, 0.0..99.0],
        ) {
            let first = frame(&points.iter().copied().map(DVec3::from).collect::<Vec<_>>());
            let others: Vec<DVec3> = others.into_iter().take(points.len()).map(DVec3::from).collect();
            let mut moved = frame(&others);
            Reference::new(&first, &AlignBy::all()).expect("a reference").align(&mut moved).expect("a frame");
            let best = distance2(&first, &moved);
            let center = (0..moved.len()).map(|row| moved.position(row)).sum::<DVec3>() / moved.len() as f64;
            let turn = rotation(turn);
            let turned: Vec<DVec3> =
                (0..moved.len()).map(|row| turn * (moved.position(row) - center) + center).collect();
            prop_assert!(distance2(&first, &frame(&turned)) > best - 1e-9);
        }
    }

    #[test]
    fn frames_that_cannot_be_aligned_are_refused() {
        let two = frame(&[DVec3::ZERO, DVec3::X]);
        assert!(
            Reference::new(&two, &AlignBy::all()).is_err_and(|why| why.contains("2 particles"))
        );
        let mut points = frame(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z]);
        let by = AlignBy::rows("x", &[], |frame| Ok((0..frame.len()).map(|row| row > 0).collect()));
        let reference = Reference::new(&points, &by).expect("a reference");
        assert!(reference.align(&mut frame(&[DVec3::X])).is_err());
        // Rows that are not chosen may be anywhere.
        let before = points.clone();
        points.x[0] = 50.0;
        reference.align(&mut points).expect("a frame");
        assert!((points.position(1) - before.position(1)).length() < 1e-12);
        assert!(AlignBy::all() == AlignBy::all() && AlignBy::all() != by);
    }
}
