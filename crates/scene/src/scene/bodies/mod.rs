//! Bodies other than spheres, in columns: one module for each kind says its columns, its keys in scene files, what may be wrong with a
//! body, and where it is. All else asks the list of the kinds, [`Scene::other_bodies`](super::Scene::other_bodies).

mod cones;
mod ellipsoids;
mod sticks;
mod triangles;

pub use cones::Cones;
pub use ellipsoids::Ellipsoids;
pub use sticks::Sticks;
pub use triangles::Triangles;

pub(in crate::scene) use cones::ConeKeys;
pub(in crate::scene) use ellipsoids::EllipsoidKeys;
pub(in crate::scene) use sticks::StickKeys;
pub(in crate::scene) use triangles::{MeshKeys, TriangleKeys};

use super::file::{Block, Materials, solid_row};
use super::keys::{Schema, Section};
use super::{FileError, Rgb, Slice, SliceMode};
use glam::DVec3;
use spherule_core::internals::body_rows::BodyKind;
use spherule_core::internals::body_tree::Shape;
use std::iter::Take;

/// Columns of bodies of one kind.
pub trait BodyColumns {
    /// The kind.
    fn kind(&self) -> BodyKind;

    /// The name of a column that each body has a row of, and the lengths of all columns, this one first.
    fn lengths(&self) -> (&'static str, Vec<usize>);

    /// Rows of [`Scene::materials`](super::Scene::materials).
    fn materials(&self) -> &[u32];

    /// Factors on the material's color, for each hit of body `row` ([`BodyKind::hits`]).
    fn colors(&self, row: usize) -> &[Rgb];

    /// The point of body `row` by which slices decide.
    fn middle(&self, row: usize) -> DVec3;

    /// Spheres whose convex hull holds body `row`.
    fn hull(&self, row: usize) -> Hull;

    /// A sphere that stands for body `row` where the scene's middle is looked for.
    fn anchor(&self, row: usize) -> (DVec3, f64) {
        self.hull(row).next().unwrap_or_default()
    }

    /// The least and the greatest depth of body `row` in a slice.
    fn depths(&self, row: usize, slice: &Slice) -> [f64; 2] {
        self.hull(row).fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], (at, radius)| {
            let depth = slice.depth(at);
            [least.min(depth - radius), most.max(depth + radius)]
        })
    }

    /// Returns whether the bodies stand by themselves: others only join these, and count neither in [`Scene::bounds`](super::Scene::bounds) nor as what is cut.
    fn stand_alone(&self) -> bool {
        true
    }

    /// Memory of a body.
    fn bytes_each(&self) -> BodyBytes;

    /// Returns what is wrong with body `row` but for its material and colors; `None` if nothing is.
    fn fault(&self, row: usize) -> Option<String>;

    /// Number of bodies.
    fn len(&self) -> usize {
        self.materials().len()
    }

    /// Returns whether there is none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Columns of bodies of which trees are built.
pub trait PlacedBodies: BodyColumns {
    /// The bodies of the tree.
    type Shape: Shape;

    /// Returns body `row` in a world: points are mapped by a function, and lengths multiplied; `None` if it is too small for single precision.
    fn place(
        &self,
        row: usize,
        point: impl Fn(DVec3) -> DVec3,
        scale: f64,
    ) -> Option<<Self::Shape as Shape>::Item>;
}

/// Columns that scene files describe.
pub(in crate::scene) trait FileBodies: BodyColumns {
    /// The section of body `row`, with the name of its material.
    fn section(&self, row: usize, material: String) -> String;

    /// Reads all sections of the kind.
    fn read(&mut self, root: &Block, materials: &mut Materials) -> Result<(), FileError>;
}

/// Spheres, center and radius, whose convex hull holds a body.
pub type Hull = Take<std::array::IntoIter<(DVec3, f64), 3>>;

/// Returns a hull of `N` spheres, at most three.
fn hull<const N: usize>(spheres: [(DVec3, f64); N]) -> Hull {
    let place = |i: usize| spheres.get(i).copied().unwrap_or_default();
    std::array::from_fn(place).into_iter().take(N)
}

/// Bytes of memory of bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyBytes {
    /// In the scene's columns.
    pub columns: u64,
    /// While their tree is built, in addition: rows and their copy, the spheres around them, their blocks, and materials and colors of their
    /// hits.
    pub building: u64,
}

impl BodyBytes {
    /// Those of `count` bodies.
    pub fn of(self, count: usize) -> Self {
        let all = |bytes: u64| bytes.saturating_mul(count as u64);
        Self { columns: all(self.columns), building: all(self.building) }
    }

    /// Those of both.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            columns: self.columns.saturating_add(other.columns),
            building: self.building.saturating_add(other.building),
        }
    }
}

impl Slice {
    /// Returns whether a body is removed: as a sphere is, by its [middle](BodyColumns::middle); caps remove it if they leave nothing of it.
    #[doc(hidden)]
    pub fn drops_body(&self, bodies: &dyn BodyColumns, row: usize) -> bool {
        match self.mode {
            SliceMode::Remove => self.depth(bodies.middle(row)) > 0.0,
            SliceMode::Caps => bodies.depths(row, self)[0] >= 0.0,
            SliceMode::Hide => false,
        }
    }

    /// Returns whether any part of a body is cut away or hidden.
    pub(super) fn cuts_body(&self, bodies: &dyn BodyColumns, row: usize) -> bool {
        match self.mode {
            SliceMode::Caps => bodies.depths(row, self)[1] > 0.0,
            SliceMode::Remove | SliceMode::Hide => self.depth(bodies.middle(row)) > 0.0,
        }
    }
}

/// Returns what is wrong with a value of a body that must be finite and more than 0; `None` if nothing is.
fn not_positive(name: impl FnOnce() -> String, value: f64) -> Option<String> {
    let valid = value > 0.0 && value < f64::INFINITY;
    (!valid).then(|| format!("{} is {value}, but must be finite and more than 0", name()))
}

/// Reads all sections of a kind; `push` appends a body, with the row of its material.
fn read<K: Section>(
    root: &Block,
    materials: &mut Materials,
    kind: BodyKind,
    mut push: impl FnMut(K, u32),
) -> Result<(), FileError> {
    for block in root.blocks(Schema::of::<K>())? {
        let keys = block.read()?;
        push(keys, solid_row(&block, materials, &kind.with_article())?);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drops(bodies: &dyn BodyColumns, distance: f64, mode: SliceMode) -> bool {
        Slice { normal: DVec3::X, distance, mode }.drops_body(bodies, 0)
    }

    /// Checks a body between two planes across the x axis, and its middle.
    pub(super) fn check_slices(bodies: &dyn BodyColumns, [low, high]: [f64; 2], middle: f64) {
        let [caps, remove] = [SliceMode::Caps, SliceMode::Remove];
        assert!(drops(bodies, low - 0.1, caps) && !drops(bodies, low + 0.1, caps));
        assert!(drops(bodies, middle - 0.1, remove) && !drops(bodies, middle + 0.1, remove));
        assert!(!drops(bodies, -9.0, SliceMode::Hide));
        let cuts = |distance| Slice { normal: DVec3::X, distance, mode: caps }.cuts_body(bodies, 0);
        assert!(cuts(high - 0.1) && !cuts(high + 0.1));
    }
}
