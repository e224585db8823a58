//! A triangle: a face of a mesh.

use super::exact;
use crate::body_tree::Shape;
use glam::DVec3;

/// Normals that are shorter than this part of the product of two edges are computed without rounding.
const THIN: f64 = 1.0 / (1 << 20) as f64;

/// The points between three corners, which single precision holds and which are not on one line; its edges and corners are part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// The corners.
    pub corners: [DVec3; 3],
}

impl Triangle {
    /// The edges from the first corner to the second and to the third.
    #[inline(always)]
    pub(super) fn edges(&self) -> [DVec3; 2] {
        let [first, second, third] = self.corners;
        [second - first, third - first]
    }

    /// A normal of the side on which the corners run counterclockwise, as long as twice the triangle's area; 0 if and only if the corners are
    /// on one line.
    ///
    /// Of corners in single precision no product of two edges, nor its square, overflows or underflows.
    pub(super) fn area_normal(&self) -> DVec3 {
        let [first, second] = self.edges();
        let normal = first.cross(second);
        let product2 = first.length_squared() * second.length_squared();
        if normal.length_squared() <= THIN * THIN * product2 {
            return exact::area_normal(self);
        }
        normal
    }

    /// Returns the unit normal of the side on which the corners run counterclockwise.
    pub fn normal(&self) -> DVec3 {
        self.area_normal().normalize()
    }

    /// Returns whether a point is no farther from the triangle than a distance, but for rounding in double precision.
    #[inline(always)]
    pub(super) fn is_near(&self, point: DVec3, distance: f64) -> bool {
        let [low, high] = self.extent();
        let in_box = point.cmpge(low - distance) & point.cmple(high + distance);
        in_box.all() && self.is_close(point, distance)
    }

    /// [`Triangle::is_near`] of a point in a box around the triangle.
    #[inline(never)]
    fn is_close(&self, point: DVec3, distance: f64) -> bool {
        let (normal, reach2) = (self.area_normal(), distance * distance);
        let height = normal.dot(point - self.corners[0]);
        if height * height > reach2 * normal.length_squared() {
            return false;
        }
        let edges = [0, 1, 2].map(|i| {
            let (start, end) = (self.corners[i], self.corners[(i + 1) % 3]);
            (point - start, end - start)
        });
        let is_inward = |(from, edge): (DVec3, DVec3)| normal.cross(edge).dot(from) >= 0.0;
        let is_at_edge = |(from, edge): (DVec3, DVec3)| {
            let along = (from.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
            (from - edge * along).length_squared() <= reach2
        };
        edges.into_iter().all(is_inward) || edges.into_iter().any(is_at_edge)
    }
}
