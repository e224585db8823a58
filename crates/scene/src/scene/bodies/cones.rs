//! The cones of a scene, in columns.

use super::{BodyBytes, BodyColumns, FileBodies, Hull, PlacedBodies, hull, not_positive};
use crate::scene::file::{Block, Materials};
use crate::scene::keys::{Point, RADIUS, Section, Visitor, color, key, section_text, solid};
use crate::scene::{FileError, Rgb, Slice};
use crate::settings::Limits::Positive;
use glam::DVec3;
use spherule_core::internals::body_rows::BodyKind;
use spherule_core::internals::cones::{Cone, ConeItem};

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
    /// Rows of [`Scene::materials`](crate::scene::Scene::materials), of which none is glass or an emitter.
    pub material: Vec<u32>,
    /// Factors on the material's color.
    pub color: Vec<Rgb>,
}

impl Cones {
    /// Maximum number of cones in a scene.
    pub const MAX: usize = 1 << 30;

    /// Maximum ratio of the height and the radius of a cone, in both directions.
    pub const MAX_RATIO: f64 = ConeItem::MAX_RATIO;

    /// Returns the number of cones.
    pub fn len(&self) -> usize {
        self.material.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.material.is_empty()
    }

    /// Appends a cone.
    pub fn push(&mut self, apex: DVec3, base: DVec3, radius: f64, material: u32, color: Rgb) {
        self.apex.push(apex);
        self.base.push(base);
        self.radius.push(radius);
        self.material.push(material);
        self.color.push(color);
    }

    /// Moves other cones to the end; `material` gives their rows here.
    pub(in crate::scene) fn append(&mut self, mut other: Self, material: impl Fn(u32) -> u32) {
        self.apex.append(&mut other.apex);
        self.base.append(&mut other.base);
        self.radius.append(&mut other.radius);
        self.material.extend(other.material.into_iter().map(material));
        self.color.append(&mut other.color);
    }

    /// Returns the ratio of the larger of the height and the radius of a cone to the smaller one.
    fn ratio(apex: DVec3, base: DVec3, radius: f64) -> f64 {
        let height = apex.distance(base);
        height.max(radius) / height.min(radius)
    }

    /// Returns the least and the greatest coordinate of cone `row` along a direction, a unit vector.
    pub fn range(&self, row: usize, direction: DVec3) -> [f64; 2] {
        let axis = (self.base[row] - self.apex[row]).normalize_or_zero();
        let across = (1.0 - axis.dot(direction).powi(2)).max(0.0).sqrt() * self.radius[row];
        let (apex, base) = (self.apex[row].dot(direction), self.base[row].dot(direction));
        [apex.min(base - across), apex.max(base + across)]
    }
}

impl BodyColumns for Cones {
    fn kind(&self) -> BodyKind {
        BodyKind::Cone
    }

    fn lengths(&self) -> (&'static str, Vec<usize>) {
        let Self { apex, base, radius, material, color } = self;
        ("radius", vec![radius.len(), apex.len(), base.len(), material.len(), color.len()])
    }

    fn materials(&self) -> &[u32] {
        &self.material
    }

    fn colors(&self, row: usize) -> &[Rgb] {
        std::slice::from_ref(&self.color[row])
    }

    fn middle(&self, row: usize) -> DVec3 {
        self.apex[row].midpoint(self.base[row])
    }

    fn hull(&self, row: usize) -> Hull {
        hull([(self.apex[row], 0.0), self.anchor(row)])
    }

    fn anchor(&self, row: usize) -> (DVec3, f64) {
        (self.base[row], self.radius[row])
    }

    fn depths(&self, row: usize, slice: &Slice) -> [f64; 2] {
        self.range(row, slice.normal).map(|end| end - slice.distance)
    }

    fn bytes_each(&self) -> BodyBytes {
        // Apex, base, radius, material and color.
        BodyBytes { columns: 72, building: 156 }
    }

    fn fault(&self, row: usize) -> Option<String> {
        let (apex, base, radius) = (self.apex[row], self.base[row], self.radius[row]);
        if !(apex.is_finite() && base.is_finite()) {
            return Some(format!("the apex and the base of cone {row} must be finite"));
        }
        let (ratio, most) = (Self::ratio(apex, base, radius), Self::MAX_RATIO);
        let long = || {
            format!(
                "of the height and the radius of cone {row} one is {ratio} times the other, but at most {most} fit"
            )
        };
        let radius = not_positive(|| format!("the radius of cone {row}"), radius);
        radius.or_else(|| (ratio > most).then(long))
    }
}

impl PlacedBodies for Cones {
    type Shape = Cone;

    fn place(&self, row: usize, point: impl Fn(DVec3) -> DVec3, scale: f64) -> Option<ConeItem> {
        let [apex, base] = [self.apex[row], self.base[row]].map(|end| point(end).as_vec3());
        ConeItem::new(apex, base, (self.radius[row] * scale) as f32, row as u32).ok()
    }
}

impl FileBodies for Cones {
    fn section(&self, row: usize, material: String) -> String {
        section_text(&ConeKeys {
            apex: self.apex[row],
            base: self.base[row],
            radius: self.radius[row],
            material: Some(material),
            color: self.color[row],
        })
    }

    fn read(&mut self, root: &Block, materials: &mut Materials) -> Result<(), FileError> {
        super::read(root, materials, self.kind(), |keys: ConeKeys, material| {
            self.push(keys.apex, keys.base, keys.radius, material, keys.color);
        })
    }
}

/// `[[cone]]`.
#[derive(Clone)]
pub(in crate::scene) struct ConeKeys {
    apex: DVec3,
    base: DVec3,
    radius: f64,
    material: Option<String>,
    color: Rgb,
}

impl Section for ConeKeys {
    const NAME: &'static str = "[[cone]]";
    const EMPTY: fn() -> Self = || {
        let (apex, base) = (DVec3::Y, DVec3::ZERO);
        Self { apex, base, radius: 1.0, material: None, color: Rgb::ONE }
    };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { apex, base, radius, material, color } = self;
        keys.visit(key("apex", "the tip").required("apex = [x, y, z]"), Point, apex);
        let help = "the center of the base, not the apex";
        keys.visit(key("base", help).required("base = [x, y, z]"), Point, base);
        if apex == base {
            keys.refuse(&["base"], "the base is at the apex", Some("move one of them"));
        }
        let help = "radius of the base, not more than 16384 times the height, nor less than it \
                    divided by that";
        keys.visit(key("radius", help).required(RADIUS), Positive, radius);
        let (ratio, most) = (Cones::ratio(*apex, *base, *radius), Cones::MAX_RATIO);
        if ratio > most {
            let message = format!(
                "of the height and the radius one is {ratio} times the other, but at most {most} fit"
            );
            keys.refuse(&["radius"], &message, None);
        }
        solid(keys, material);
        self::color(keys, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::bodies::tests::check_slices;

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
        assert_eq!(cones.middle(0), DVec3::X * 2.0);
        check_slices(&cones, [1.0, 3.0], 2.0);
    }
}
