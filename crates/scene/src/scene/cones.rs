//! The cones of a scene, in columns.

use super::{Rgb, Slice, SliceMode};
use glam::DVec3;

/// Cones in columns: solid right circular cones with flat bases, such as the heads of arrows. Row `i` of every column belongs to
/// cone `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cones {
    /// Apexes.
    pub apex: Vec<DVec3>,
    /// Centers of the bases, which are not the apexes.
    pub base: Vec<DVec3>,
    /// Radii of the bases, more than 0; of the height and the radius none is more than [`Cones::MAX_RATIO`] times the other.
    pub radius: Vec<f64>,
    /// Rows of [`Scene::materials`](super::Scene::materials), of which none is glass or an emitter.
    pub material: Vec<u32>,
    /// Factors on the material's color.
    pub color: Vec<Rgb>,
}

impl Cones {
    /// Maximum number of cones in a scene.
    pub const MAX: usize = 1 << 30;

    /// Maximum ratio of the height and the radius of a cone, in both directions.
    pub const MAX_RATIO: f64 = crate::cones::ConeItem::MAX_RATIO;

    /// Returns the number of cones.
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.radius.is_empty()
    }

    /// Appends a cone.
    pub fn push(&mut self, apex: DVec3, base: DVec3, radius: f64, material: u32, color: Rgb) {
        self.apex.push(apex);
        self.base.push(base);
        self.radius.push(radius);
        self.material.push(material);
        self.color.push(color);
    }

    /// Returns the middle of the axis of cone `row`.
    pub fn middle(&self, row: usize) -> DVec3 {
        self.apex[row].midpoint(self.base[row])
    }

    /// Returns the ratio of the larger of the height and the radius of cone `row` to the smaller one.
    pub fn ratio(&self, row: usize) -> f64 {
        Self::ratio_of(self.apex[row], self.base[row], self.radius[row])
    }

    /// Returns the same ratio of a cone that is not in the columns.
    pub(super) fn ratio_of(apex: DVec3, base: DVec3, radius: f64) -> f64 {
        let height = apex.distance(base);
        height.max(radius) / height.min(radius)
    }

    /// Returns two spheres, center and radius, whose convex hull holds cone `row`: its apex, and that about its base.
    pub fn hull(&self, row: usize) -> [(DVec3, f64); 2] {
        [(self.apex[row], 0.0), (self.base[row], self.radius[row])]
    }

    /// Returns the least and the greatest coordinate of cone `row` along a direction, a unit vector.
    pub fn range(&self, row: usize, direction: DVec3) -> [f64; 2] {
        let axis = (self.base[row] - self.apex[row]).normalize_or_zero();
        let across = (1.0 - axis.dot(direction).powi(2)).max(0.0).sqrt() * self.radius[row];
        let (apex, base) = (self.apex[row].dot(direction), self.base[row].dot(direction));
        [apex.min(base - across), apex.max(base + across)]
    }
}

impl Slice {
    /// Returns whether a cone is removed: as a sphere is, whose center is the middle of the cone's axis; caps remove it if they leave
    /// nothing of it.
    pub fn drops_cone(&self, cones: &Cones, row: usize) -> bool {
        match self.mode {
            SliceMode::Remove => self.depth(cones.middle(row)) > 0.0,
            SliceMode::Caps => cones.range(row, self.normal)[0] >= self.distance,
            SliceMode::Hide => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_of_apex_and_rim() {
        let mut cones = Cones::default();
        cones.push(DVec3::X * 3.0, DVec3::X, 0.5, 0, Rgb::ONE);
        for (direction, range) in [
            (DVec3::X, [1.0, 3.0]),
            (DVec3::NEG_X, [-3.0, -1.0]),
            (DVec3::Y, [-0.5, 0.5]),
            (DVec3::new(0.6, 0.8, 0.0), [0.2, 1.8]),
        ] {
            let found = cones.range(0, direction);
            assert!((0..2).all(|end| (found[end] - range[end]).abs() < 1e-12), "{found:?}");
        }
        assert_eq!((cones.middle(0), cones.ratio(0)), (DVec3::X * 2.0, 4.0));
        let slice = |distance, mode| Slice { normal: DVec3::X, distance, mode };
        let drops = |slice: Slice| slice.drops_cone(&cones, 0);
        assert!(drops(slice(0.9, SliceMode::Caps)) && !drops(slice(1.1, SliceMode::Caps)));
        assert!(drops(slice(1.9, SliceMode::Remove)) && !drops(slice(2.1, SliceMode::Remove)));
        assert!(!drops(slice(-9.0, SliceMode::Hide)));
    }
}
