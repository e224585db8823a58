//! Bounds of ellipsoids.
//!
//! The unit ball's image under `M^-1` reaches as far along axis `i` as row `i` of `M^-1` is long. The inverse is computed as
//! adjugate over determinant in numbers with bounds ([`BoundedVector`]), so that the length plus its error is no less than the true
//! one, whatever the condition of `M`.

use super::Ellipsoid;
use crate::bounded::BoundedVector;
use glam::DVec3;

/// Returns half of the lengths of the box around an ellipsoid, never less than they are; infinite for a matrix that cannot be
/// told from a singular one.
pub(super) fn half_extent(ellipsoid: &Ellipsoid) -> DVec3 {
    let rows = ellipsoid.to_unit.map(BoundedVector::exact);
    // The columns of the adjugate.
    let columns: [BoundedVector; 3] =
        std::array::from_fn(|i| rows[(i + 1) % 3].cross(&rows[(i + 2) % 3]));
    let determinant = rows[0].dot(&columns[0]);
    if determinant.sign().is_none() {
        return DVec3::INFINITY;
    }
    let length = |i: usize| {
        let [x, y, z] = columns.map(|column| (column.0[i] / determinant).square());
        let square = x + y + z;
        let root = square.sqrt();
        // The sum is positive: no row of an inverse is 0.
        (root.value + root.error) * (1.0 + f64::EPSILON)
    };
    DVec3::from(std::array::from_fn(length))
}
