//! The sticks of a scene: capsules, in columns.

use super::{BodyBytes, BodyColumns, FileBodies, Hull, PlacedBodies, hull, not_positive};
use crate::scene::file::{Block, Materials};
use crate::scene::keys::{
    List, Optional, Point, RADIUS, Section, Visitor, key, section_text, solid,
};
use crate::scene::{FileError, Rgb};
use crate::settings::Limits::{Positive, Share};
use glam::DVec3;
use spherule_core::internals::body_rows::BodyKind;
use spherule_core::internals::capsules::{Capsule, CapsuleItem};

/// Sticks in columns: cylinders with round ends, all points within a radius of a line segment. Row `i` of every column belongs
/// to stick `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sticks {
    /// The first ends of the segments.
    pub from: Vec<DVec3>,
    /// The second ends, which may be the first ones: then the stick is a sphere.
    pub to: Vec<DVec3>,
    /// Radii, more than 0.
    pub radius: Vec<f64>,
    /// Rows of [`Scene::materials`](crate::scene::Scene::materials), of which none is glass or an emitter.
    pub material: Vec<u32>,
    /// Factors on the material's color, of the half at the first end and of that at the second.
    pub colors: Vec<[Rgb; 2]>,
}

impl Sticks {
    /// Maximum number of sticks in a scene.
    pub const MAX: usize = 1 << 30;

    /// Returns the number of sticks.
    pub fn len(&self) -> usize {
        self.material.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.material.is_empty()
    }

    /// Appends a stick.
    pub fn push(&mut self, ends: [DVec3; 2], radius: f64, material: u32, colors: [Rgb; 2]) {
        self.from.push(ends[0]);
        self.to.push(ends[1]);
        self.radius.push(radius);
        self.material.push(material);
        self.colors.push(colors);
    }

    /// The ends of stick `row`.
    pub fn ends(&self, row: usize) -> [DVec3; 2] {
        [self.from[row], self.to[row]]
    }

    /// Moves other sticks to the end; `material` gives their rows here.
    pub(in crate::scene) fn append(&mut self, mut other: Self, material: impl Fn(u32) -> u32) {
        self.from.append(&mut other.from);
        self.to.append(&mut other.to);
        self.radius.append(&mut other.radius);
        self.material.extend(other.material.into_iter().map(material));
        self.colors.append(&mut other.colors);
    }
}

impl BodyColumns for Sticks {
    fn kind(&self) -> BodyKind {
        BodyKind::Capsule
    }

    fn lengths(&self) -> (&'static str, Vec<usize>) {
        let Self { from, to, radius, material, colors } = self;
        ("radius", vec![radius.len(), from.len(), to.len(), material.len(), colors.len()])
    }

    fn materials(&self) -> &[u32] {
        &self.material
    }

    fn colors(&self, row: usize) -> &[Rgb] {
        &self.colors[row]
    }

    fn middle(&self, row: usize) -> DVec3 {
        self.from[row].midpoint(self.to[row])
    }

    fn hull(&self, row: usize) -> Hull {
        hull(self.ends(row).map(|end| (end, self.radius[row])))
    }

    fn stand_alone(&self) -> bool {
        false
    }

    fn bytes_each(&self) -> BodyBytes {
        // Ends, radius, material and two colors.
        BodyBytes { columns: 84, building: 172 }
    }

    fn fault(&self, row: usize) -> Option<String> {
        if !(self.from[row].is_finite() && self.to[row].is_finite()) {
            return Some(format!("the ends of stick {row} must be finite"));
        }
        not_positive(|| format!("the radius of stick {row}"), self.radius[row])
    }
}

impl PlacedBodies for Sticks {
    type Shape = Capsule;

    fn place(&self, row: usize, point: impl Fn(DVec3) -> DVec3, scale: f64) -> Option<CapsuleItem> {
        let ends = self.ends(row).map(|end| point(end).as_vec3());
        let radius = (self.radius[row] * scale) as f32;
        (radius > 0.0).then_some(CapsuleItem { ends, radius, id: row as u32 })
    }
}

impl FileBodies for Sticks {
    fn section(&self, row: usize, material: String) -> String {
        let (ends, radius) = (self.ends(row), self.radius[row]);
        let (material, colors) = (Some(material), Some(self.colors[row]));
        section_text(&StickKeys { ends, radius, material, color: None, colors })
    }

    fn read(&mut self, root: &Block, materials: &mut Materials) -> Result<(), FileError> {
        super::read(root, materials, self.kind(), |keys: StickKeys, material| {
            let colors = keys.colors.unwrap_or([keys.color.unwrap_or(Rgb::ONE); 2]);
            self.push(keys.ends, keys.radius, material, colors);
        })
    }
}

/// `[[stick]]`.
#[derive(Clone)]
pub(in crate::scene) struct StickKeys {
    ends: [DVec3; 2],
    radius: f64,
    material: Option<String>,
    color: Option<Rgb>,
    colors: Option<[Rgb; 2]>,
}

impl Section for StickKeys {
    const NAME: &'static str = "[[stick]]";
    const EMPTY: fn() -> Self = || {
        let ends = [DVec3::ZERO, DVec3::Y];
        Self { ends, radius: 1.0, material: None, color: None, colors: None }
    };

    fn visit<V: Visitor>(&mut self, keys: &mut V) {
        let Self { ends: [from, to], radius, material, color, colors } = self;
        keys.visit(key("from", "one end of the segment").required("from = [x, y, z]"), Point, from);
        keys.visit(key("to", "the other end of the segment").required("to = [x, y, z]"), Point, to);
        keys.visit(key("radius", "radius").required(RADIUS), Positive, radius);
        solid(keys, material);
        keys.visit(key("color", "factor for the material's color").or("1"), Optional(Share), color);
        let help = "factors for the half at `from` and for that at `to`, in place of `color`";
        keys.visit(key("colors", help), Optional(List(Share)), colors);
        if colors.is_some() {
            keys.forbid(&["color"], "colors", "it gives the colors of both halves");
        }
    }
}
