//! The ellipsoids of a scene, in columns.

use super::{BodyBytes, BodyColumns, FileBodies, Hull, PlacedBodies, hull, not_positive};
use crate::scene::file::{Block, Materials};
use crate::scene::keys::{
    List, Point, Quaternion, Section, Visitor, color, key, section_text, solid,
};
use crate::scene::{FileError, Rgb, Slice};
use crate::settings::Limits::Positive;
use glam::{DQuat, DVec3};
use spherule_core::internals::body_rows::BodyKind;
use spherule_core::internals::ellipsoids::{Ellipsoid, EllipsoidItem};

/// Ellipsoids in columns. Row `i` of every column belongs to ellipsoid `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ellipsoids {
    /// Centers.
    pub center: Vec<DVec3>,
    /// Semi-axes along x, y and z before the rotation, more than 0; the longest is at most [`Ellipsoids::MAX_RATIO`] times the
    /// shortest.
    pub semi_axes: Vec<DVec3>,
    /// Rotations, unit quaternions.
    pub orientation: Vec<DQuat>,
    /// Rows of [`Scene::materials`](crate::scene::Scene::materials), of which none is glass or an emitter.
    pub material: Vec<u32>,
    /// Factors on the material's color.
    pub color: Vec<Rgb>,
}

impl Ellipsoids {
    /// Maximum number of ellipsoids in a scene.
    pub const MAX: usize = 1 << 30;

    /// Maximum ratio of two semi-axes of an ellipsoid.
    pub const MAX_RATIO: f64 = EllipsoidItem::MAX_RATIO;

    /// Returns the number of ellipsoids.
    pub fn len(&self) -> usize {
        self.material.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.material.is_empty()
    }

    /// Appends an ellipsoid.
    pub fn push(
        &mut self,
        center: DVec3,
        semi_axes: DVec3,
        orientation: DQuat,
        material: u32,
        color: Rgb,
    ) {
        self.center.push(center);
        self.semi_axes.push(semi_axes);
        self.orientation.push(orientation);
        self.material.push(material);
        self.color.push(color);
    }

    /// Moves other ellipsoids to the end; `material` gives their rows here.
    pub(in crate::scene) fn append(&mut self, mut other: Self, material: impl Fn(u32) -> u32) {
        self.center.append(&mut other.center);
        self.semi_axes.append(&mut other.semi_axes);
        self.orientation.append(&mut other.orientation);
        self.material.extend(other.material.into_iter().map(material));
        self.color.append(&mut other.color);
    }

    /// Returns the extent of ellipsoid `row` from its center in a direction, a unit vector.
    pub fn extent(&self, row: usize, direction: DVec3) -> f64 {
        (self.semi_axes[row] * (self.orientation[row].inverse() * direction)).length()
    }
}

impl BodyColumns for Ellipsoids {
    fn kind(&self) -> BodyKind {
        BodyKind::Ellipsoid
    }

    fn lengths(&self) -> (&'static str, Vec<usize>) {
        let Self { center, semi_axes, orientation, material, color } = self;
        let others = [semi_axes.len(), orientation.len(), material.len(), color.len()];
        ("center", [center.len()].into_iter().chain(others).collect())
    }

    fn materials(&self) -> &[u32] {
        &self.material
    }

    fn colors(&self, row: usize) -> &[Rgb] {
        std::slice::from_ref(&self.color[row])
    }

    fn middle(&self, row: usize) -> DVec3 {
        self.center[row]
    }

    fn hull(&self, row: usize) -> Hull {
        hull([(self.center[row], self.semi_axes[row].max_element())])
    }

    fn depths(&self, row: usize, slice: &Slice) -> [f64; 2] {
        let (middle, extent) = (slice.depth(self.center[row]), self.extent(row, slice.normal));
        [middle - extent, middle + extent]
    }

    fn bytes_each(&self) -> BodyBytes {
        // Center, semi-axes, rotation, material and color.
        BodyBytes { columns: 96, building: 232 }
    }

    fn fault(&self, row: usize) -> Option<String> {
        if !self.center[row].is_finite() {
            return Some(format!("the center of ellipsoid {row} must be finite"));
        }
        let axes = self.semi_axes[row];
        let short = axes
            .to_array()
            .into_iter()
            .find_map(|axis| not_positive(|| format!("a semi-axis of ellipsoid {row}"), axis));
        let (ratio, most) = (axes.max_element() / axes.min_element(), Self::MAX_RATIO);
        let long = || {
            format!(
                "a semi-axis of ellipsoid {row} is {ratio} times another, but at most {most} fit"
            )
        };
        let turned = || format!("the orientation of ellipsoid {row} must be a unit quaternion");
        let rotation = self.orientation[row];
        let is_rotation = rotation.is_finite() && rotation.is_normalized();
        short.or_else(|| (ratio > most).then(long)).or_else(|| (!is_rotation).then(turned))
    }
}

impl PlacedBodies for Ellipsoids {
    type Shape = Ellipsoid;

    fn place(
        &self,
        row: usize,
        point: impl Fn(DVec3) -> DVec3,
        scale: f64,
    ) -> Option<EllipsoidItem> {
        let (center, semi_axes) = (point(self.center[row]).as_vec3(), self.semi_axes[row] * scale);
        EllipsoidItem::new(center, semi_axes, self.orientation[row], row as u32).ok()
    }
}

impl FileBodies for Ellipsoids {
    fn section(&self, row: usize, material: String) -> String {
        section_text(&EllipsoidKeys {
            center: self.center[row],
            semi_axes: self.semi_axes[row].to_array(),
            orientation: self.orientation[row],
            material: Some(material),
            color: self.color[row],
        })
    }

    fn read(&mut self, root: &Block, materials: &mut Materials) -> Result<(), FileError> {
        super::read(root, materials, self.kind(), |keys: EllipsoidKeys, material| {
            let EllipsoidKeys { center, semi_axes, orientation, color, .. } = keys;
            self.push(center, semi_axes.into(), orientation, material, color);
        })
    }
}

/// `[[ellipsoid]]`.
#[derive(Clone)]
pub(in crate::scene) struct EllipsoidKeys {
    center: DVec3,
    semi_axes: [f64; 3],
    orientation: DQuat,
    material: Option<String>,
    color: Rgb,
}

impl Section for EllipsoidKeys {
    const NAME: &'static str = "[[ellipsoid]]";
    const EMPTY: fn() -> Self = || {
        let (center, orientation) = (DVec3::ZERO, DQuat::IDENTITY);
        Self { center, semi_axes: [1.0; 3], orientation, material: None, color: Rgb::ONE }
    };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { center, semi_axes, orientation, material, color } = self;
        keys.visit(key("center", "center").required("center = [x, y, z]"), Point, center);
        let example = "semi_axes = three numbers greater than 0";
        let help = "half of the lengths along x, y and z, before the rotation, none more than 16384 \
                    times another";
        keys.visit(key("semi_axes", help).required(example), List(Positive), semi_axes);
        let axes = DVec3::from(*semi_axes);
        let (ratio, most) = (axes.max_element() / axes.min_element(), Ellipsoids::MAX_RATIO);
        if ratio > most {
            let message = format!(
                "the longest semi-axis is {ratio} times the shortest, but at most {most} fit"
            );
            keys.refuse(&["semi_axes"], &message, None);
        }
        keys.visit(key("orientation", "rotation"), Quaternion, orientation);
        solid(keys, material);
        self::color(keys, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::bodies::tests::check_slices;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn extents_are_those_of_the_turned_axes() {
        let mut ellipsoids = Ellipsoids::default();
        let turned = DQuat::from_rotation_z(FRAC_PI_2);
        ellipsoids.push(DVec3::X, DVec3::new(3.0, 2.0, 1.0), turned, 0, Rgb::ONE);
        for (direction, extent) in [(DVec3::X, 2.0), (DVec3::Y, 3.0), (DVec3::NEG_Z, 1.0)] {
            assert!((ellipsoids.extent(0, direction) - extent).abs() < 1e-12, "{direction}");
        }
        check_slices(&ellipsoids, [-1.0, 3.0], 1.0);
    }
}
