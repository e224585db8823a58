//! The triangles of a scene, in columns.

use super::{BodyBytes, BodyColumns, FileBodies, Hull, PlacedBodies, hull};
use crate::elementary::{ceil_log2, power_of_two};
use crate::scene::file::{Block, Materials};
use crate::scene::keys::{Path, Point, Section, Visitor, color, key, section_text, solid};
use crate::scene::{FileError, Rgb};
use crate::settings::Limits::Positive;
use glam::DVec3;
use spherule_core::internals::body_rows::BodyKind;
use spherule_core::internals::triangles::{Triangle, TriangleItem};

/// Triangles in columns: flat, seen from both sides, such as the faces of a mesh. Row `i` of every column belongs to triangle `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// Corners, which are not on one line.
    pub corners: Vec<[DVec3; 3]>,
    /// Rows of [`Scene::materials`](crate::scene::Scene::materials), of which none is glass or an emitter.
    pub material: Vec<u32>,
    /// Factors on the material's color.
    pub color: Vec<Rgb>,
}

impl Triangles {
    /// Returns the number of triangles.
    pub fn len(&self) -> usize {
        self.material.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.material.is_empty()
    }

    /// Appends a triangle.
    pub fn push(&mut self, corners: [DVec3; 3], material: u32, color: Rgb) {
        self.corners.push(corners);
        self.material.push(material);
        self.color.push(color);
    }

    /// Moves other triangles to the end; `material` gives their rows here.
    pub(in crate::scene) fn append(&mut self, mut other: Self, material: impl Fn(u32) -> u32) {
        self.corners.append(&mut other.corners);
        self.material.extend(other.material.into_iter().map(material));
        self.color.append(&mut other.color);
    }

    /// Returns whether three corners are on one line, in double precision.
    pub(in crate::scene) fn are_on_a_line([a, b, c]: [DVec3; 3]) -> bool {
        // Exact, so that neither products nor what they lose depend on the size.
        let scaled = |side: DVec3| {
            let size = side.abs().max_element();
            if size > 0.0 { side * power_of_two(-ceil_log2(size).clamp(-1000, 1000)) } else { side }
        };
        scaled(b - a).cross(scaled(c - a)) == DVec3::ZERO
    }
}

impl BodyColumns for Triangles {
    fn kind(&self) -> BodyKind {
        BodyKind::Triangle
    }

    fn lengths(&self) -> (&'static str, Vec<usize>) {
        ("corners", vec![self.corners.len(), self.material.len(), self.color.len()])
    }

    fn materials(&self) -> &[u32] {
        &self.material
    }

    fn colors(&self, row: usize) -> &[Rgb] {
        std::slice::from_ref(&self.color[row])
    }

    fn middle(&self, row: usize) -> DVec3 {
        self.corners[row].into_iter().sum::<DVec3>() / 3.0
    }

    fn hull(&self, row: usize) -> Hull {
        hull(self.corners[row].map(|corner| (corner, 0.0)))
    }

    fn anchor(&self, row: usize) -> (DVec3, f64) {
        let [a, b, c] = self.corners[row];
        (self.middle(row), a.distance(b).max(b.distance(c)).max(c.distance(a)) / 2.0)
    }

    fn bytes_each(&self) -> BodyBytes {
        // Three corners, material and color.
        BodyBytes { columns: 88, building: 172 }
    }

    fn fault(&self, row: usize) -> Option<String> {
        let corners = self.corners[row];
        if !corners.into_iter().all(DVec3::is_finite) {
            return Some(format!("the corners of triangle {row} must be finite"));
        }
        let flat = Self::are_on_a_line(corners);
        flat.then(|| format!("the corners of triangle {row} are on one line"))
    }
}

impl PlacedBodies for Triangles {
    type Shape = Triangle;

    fn place(&self, row: usize, point: impl Fn(DVec3) -> DVec3, _: f64) -> Option<TriangleItem> {
        let corners = self.corners[row].map(|corner| point(corner).as_vec3());
        TriangleItem::new(corners, row as u32).ok()
    }
}

impl FileBodies for Triangles {
    fn section(&self, row: usize, material: String) -> String {
        let (corners, color) = (self.corners[row], self.color[row]);
        section_text(&TriangleKeys { corners, material: Some(material), color })
    }

    fn read(&mut self, root: &Block, materials: &mut Materials) -> Result<(), FileError> {
        super::read(root, materials, self.kind(), |keys: TriangleKeys, material| {
            self.push(keys.corners, material, keys.color);
        })
    }
}

/// `[[triangle]]`.
#[derive(Clone)]
pub(in crate::scene) struct TriangleKeys {
    corners: [DVec3; 3],
    material: Option<String>,
    color: Rgb,
}

impl Section for TriangleKeys {
    const NAME: &'static str = "[[triangle]]";
    const EMPTY: fn() -> Self =
        || Self { corners: [DVec3::ZERO, DVec3::X, DVec3::Y], material: None, color: Rgb::ONE };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { corners: [a, b, c], material, color } = self;
        keys.visit(key("a", "one corner").required("a = [x, y, z]"), Point, a);
        keys.visit(key("b", "another corner").required("b = [x, y, z]"), Point, b);
        let help = "the third corner, not on the line through the others";
        keys.visit(key("c", help).required("c = [x, y, z]"), Point, c);
        if Triangles::are_on_a_line([*a, *b, *c]) {
            keys.refuse(&["c"], "the corners are on one line", Some("move one of them"));
        }
        solid(keys, material);
        self::color(keys, color);
    }
}

/// `[[mesh]]`.
#[derive(Clone)]
pub(in crate::scene) struct MeshKeys {
    pub(in crate::scene) path: String,
    material: Option<String>,
    pub(in crate::scene) color: Rgb,
    pub(in crate::scene) scale: f64,
}

impl Section for MeshKeys {
    const NAME: &'static str = "[[mesh]]";
    const EMPTY: fn() -> Self =
        || Self { path: String::new(), material: None, color: Rgb::ONE, scale: 1.0 };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { path, material, color, scale } = self;
        let own = key("path", "path of a PLY file with faces").required("path = \"mesh.ply\"");
        keys.visit(own, Path, path);
        solid(keys, material);
        self::color(keys, color);
        keys.visit(key("scale", "factor for the file's positions"), Positive, scale);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::bodies::tests::check_slices;

    #[test]
    fn slices_see_corners_and_middles() {
        let mut triangles = Triangles::default();
        triangles.push([DVec3::X, DVec3::X * 4.0, DVec3::new(1.0, 2.0, 0.0)], 0, Rgb::ONE);
        check_slices(&triangles, [1.0, 4.0], 2.0);
    }

    #[test]
    fn corners_on_a_line_are_found_at_any_size() {
        for size in [1e-200, 1.0, 1e200] {
            let at = |x: f64, y: f64| DVec3::new(x, y, 0.0) * size;
            assert!(Triangles::are_on_a_line([at(0.0, 0.0), at(1.0, 2.0), at(2.0, 4.0)]));
            assert!(Triangles::are_on_a_line([at(0.0, 0.0), at(0.0, 0.0), at(2.0, 4.0)]));
            assert!(!Triangles::are_on_a_line([at(0.0, 0.0), at(1.0, 2.0), at(2.0, 4.5)]));
        }
    }
}
