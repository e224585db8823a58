//! Builders of the tree: by medians, by the surface-area heuristic, by Morton codes.
//!
//! Spheres are cut in two parts, these again, and so on down to leaves of [`LEAF`] spheres. Parts are
//! cut at multiples of a leaf, so all leaves but one are full and the spheres' order is the tree's.
//! Builders differ in where they cut a part ([`Builder`]). The binary tree is then collapsed to wide
//! nodes (`collapse`).
//!
//! All of it is a function of the spheres alone, whatever the number of threads and the order of
//! rows: no two spheres are equal on an axis, as what tells them apart is where they are on the
//! others, then how large they are, and at last the user's order.

mod branch;
mod collapse;
mod cut;
mod item;
mod median;
mod morton;
mod partition;
mod segment;
mod surface_area;
mod sweep;
mod tasks;

use super::Bvh;
use crate::spheres::{LEAF, Spheres};
use branch::Branch;
use cut::Cut;
use glam::DVec3;
pub(crate) use item::Item;
use median::Median;
use morton::Morton;
use rayon::prelude::*;
use segment::Segment;
use std::sync::atomic::Ordering::Relaxed;
use surface_area::SurfaceArea;
pub(crate) use tasks::collected;
use tasks::freeing;

/// With fewer rays than this for each sphere the time to build the best tree does not come back: it
/// takes 0.07 to 0.11 us longer for a sphere (AMD EPYC, Zen 4), and saves 0.02 us of a ray in even scenes and 0.1 us in
/// uneven ones (measured with a quarter of a million spheres and with a million).
const RAYS_PER_SPHERE: u64 = 3;

/// The builder of a tree. Hits do not depend on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Builder {
    /// Halves on the longest axis.
    Median,
    /// The surface-area heuristic: the tree that rays pass through fastest.
    #[default]
    SurfaceArea,
    /// Along a curve that fills space: built fastest.
    Morton,
}

impl Builder {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Median, Self::SurfaceArea, Self::Morton];

    /// Returns the builder that is fastest in total for a number of rays.
    pub fn for_rays(spheres: usize, rays: u64) -> Self {
        let few = (spheres as u64).saturating_mul(RAYS_PER_SPHERE);
        if rays < few { Self::Morton } else { Self::SurfaceArea }
    }
}

/// Exact spheres in the user's order, if the single-precision columns cannot hold them; empty otherwise.
#[derive(Default)]
pub(crate) struct Precise {
    /// Places in the user's order, ascending.
    pub(crate) id: Vec<u32>,
    /// Centers and radii.
    pub(crate) sphere: Vec<(DVec3, f64)>,
}

impl Precise {
    /// Takes the exact spheres out of the columns.
    fn taken(from: &mut Spheres) -> Self {
        let sphere = std::mem::take(&mut from.precise);
        let id = if sphere.is_empty() { Vec::new() } else { std::mem::take(&mut from.id) };
        Self { id, sphere }
    }

    fn of(&self, item: &Item) -> Option<(DVec3, f64)> {
        self.sphere.get(self.id.partition_point(|&id| id < item.id)).copied()
    }

    /// Returns a key that is equal for spheres that coincide.
    fn key(&self, item: &Item) -> [u64; 4] {
        let rounded = || {
            let [x, y, z, radius] = item.sphere.map(f64::from);
            (DVec3::new(x, y, z), radius)
        };
        let (center, radius) = self.of(item).unwrap_or_else(rounded);
        // Adding 0 makes -0 the same as 0.
        [center.x, center.y, center.z, radius].map(|value| (value + 0.0).to_bits())
    }
}

/// Builds the tree and permutes `spheres` so that every leaf is a block.
///
/// Only the first of coincident spheres, in the user's order, is ever hit. Where many coincide, so that a
/// traversal would visit every leaf in their box, the others are omitted.
pub fn build(spheres: &mut Spheres, builder: Builder) -> Bvh {
    let mut from = std::mem::take(spheres);
    let items = collected(from.len(), |row| Item::of(&from, row));
    let precise = Precise::taken(&mut from);
    drop(from);
    let bvh;
    (*spheres, bvh) = build_items(items, &precise, builder);
    bvh
}

/// Builds the tree over items; returns the spheres in its order.
pub(crate) fn build_items(
    mut items: Vec<Item>,
    precise: &Precise,
    builder: Builder,
) -> (Spheres, Bvh) {
    let mut binary = Binary::over(&mut items, builder);
    if binary.crowded {
        drop(binary);
        // They are in another order then, also where none coincide.
        leave_out_hidden(&mut items, precise);
        binary = Binary::over(&mut items, builder);
    }
    let mut spheres = Spheres::from_rows(items.len(), |row| (items[row].sphere, items[row].id));
    if !precise.sphere.is_empty() {
        spheres.precise = items.iter().filter_map(|item| precise.of(item)).collect();
    }
    let bvh = Bvh::new(freeing(items, || collapse::nodes(binary.branches, &spheres)));
    (spheres, bvh)
}

/// Builds a tree over bodies that are not spheres, each given by a sphere around it; the ids of the items are the rows
/// of the bodies, and come back in the order of the tree. Its boxes hold the spheres: [`Bvh::refitted`] makes them tight.
pub(crate) fn build_around(mut items: Vec<Item>, builder: Builder) -> (Vec<u32>, Bvh) {
    let binary = Binary::over(&mut items, builder);
    let around = Spheres::from_rows(items.len(), |row| (items[row].sphere, items[row].id));
    let bvh = Bvh::new(collapse::nodes(binary.branches, &around));
    (around.id, bvh)
}

/// Keeps the first of the user's spheres of all that coincide.
fn leave_out_hidden(items: &mut Vec<Item>, precise: &Precise) {
    items.par_sort_unstable_by_key(|item| (precise.key(item), item.id));
    items.dedup_by_key(|item| precise.key(item));
}

/// The tree while it is binary.
struct Binary {
    branches: Vec<Branch>,
    /// True if there are crowds of equal centers.
    crowded: bool,
}

impl Binary {
    /// Over `items`, which are put into the order of the leaves.
    fn over(items: &mut [Item], builder: Builder) -> Self {
        match builder {
            Builder::Median => Self::with_copy(items, &Median::default()),
            Builder::SurfaceArea => Self::with_copy(items, &SurfaceArea::default()),
            Builder::Morton => {
                let (morton, memory) = Morton::sort(items);
                freeing(memory, || Self::cut(items, &mut [], &morton))
            }
        }
    }

    fn with_copy(items: &mut [Item], how: &impl Cut) -> Self {
        // Any values will do.
        let mut spare = collected(items.len(), |row| items[row]);
        Self::cut(items, &mut spare, how)
    }

    fn cut(items: &mut [Item], spare: &mut [Item], how: &impl Cut) -> Self {
        let count = items.len().div_ceil(LEAF).saturating_sub(1);
        let mut branches = collected(count, |_| Branch::NONE);
        if !items.is_empty() {
            branch::grow(how, Segment::new(items, spare), &mut branches, 0, 0);
        }
        Self { branches, crowded: how.median().crowded.load(Relaxed) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_rays_chooses_the_builder() {
        assert_eq!(Builder::for_rays(400, 960 * 540 * 16), Builder::SurfaceArea);
        assert_eq!(Builder::for_rays(10_000_000, 960 * 540), Builder::Morton);
        assert_eq!(Builder::for_rays(10_000_000, 1 << 36), Builder::SurfaceArea);
        assert_eq!(Builder::for_rays(usize::MAX, u64::MAX), Builder::SurfaceArea);
        assert_eq!(Builder::for_rays(0, 0), Builder::SurfaceArea);
    }
}
