//! A capsule: a cylinder with round ends.

use glam::DVec3;

/// All points within `radius` of the line segment between two ends, which may be the same point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// The ends.
    pub ends: [DVec3; 2],
    /// The radius, more than 0.
    pub radius: f64,
}

impl Capsule {
    /// The outward unit normal at a point of the surface, given relative to the first end, and where on the axis the point
    /// belongs, from 0 to 1. The point need not be on the surface by more than rounding.
    pub fn normal(&self, from_start: DVec3) -> (DVec3, f64) {
        let axis = self.ends[1] - self.ends[0];
        let length2 = axis.length_squared();
        let along =
            if length2 > 0.0 { (from_start.dot(axis) / length2).clamp(0.0, 1.0) } else { 0.0 };
        ((from_start - axis * along).normalize_or_zero(), along)
    }
}
