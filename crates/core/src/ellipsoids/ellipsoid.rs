//! An ellipsoid: the image of the unit sphere under an affine map.

use glam::DVec3;

/// All points `x` with `|M (x - c)| <= 1`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// The center `c`.
    pub center: DVec3,
    /// The rows of `M`, which takes the ellipsoid to the unit sphere: the direction of each axis, divided by the semi-axis.
    pub to_unit: [DVec3; 3],
}

impl Ellipsoid {
    /// Applies `M` to a vector.
    #[inline(always)]
    pub fn to_unit(&self, v: DVec3) -> DVec3 {
        DVec3::from(self.to_unit.map(|row| row.dot(v)))
    }

    /// Returns half the gradient of `|M (x - c)|^2` at a point, given relative to the center.
    #[inline(always)]
    pub fn gradient(&self, from_center: DVec3) -> DVec3 {
        let unit = self.to_unit(from_center);
        let [x, y, z] = self.to_unit;
        x * unit.x + y * unit.y + z * unit.z
    }

    /// Returns the point of the surface next to one that is off it by rounding, both relative to the center: the end of one step
    /// of Newton's method along the gradient.
    pub fn onto_surface(&self, from_center: DVec3) -> DVec3 {
        let gradient = self.gradient(from_center);
        let off = self.to_unit(from_center).length_squared() - 1.0;
        let step = off / (2.0 * gradient.length_squared());
        if step.is_finite() { from_center - gradient * step } else { from_center }
    }

    /// The outward unit normal at a point of the surface, given relative to the center. The point need not be on the surface
    /// by more than rounding.
    pub fn normal(&self, from_center: DVec3) -> DVec3 {
        self.gradient(from_center).normalize_or_zero()
    }
}
