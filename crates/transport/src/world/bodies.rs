//! The sticks, ellipsoids and cones of a scene in world space.

use super::appearance::{Colors, Column};
use super::{Appearance, Materials, Transform, World};
use crate::bodies::BodyTrees;
use crate::body_rows::{BodyKind, BodyRow, BodyRows};
use crate::body_tree::{BodyTree, Shape};
use crate::bvh::Tree;
use crate::bvh::builders::Builder;
use crate::capsules::{Capsule, CapsuleItem};
use crate::cones::{Cone, ConeItem};
use crate::ellipsoids::{Ellipsoid, EllipsoidItem};
use crate::scene::{Rgb, Scene};
use crate::shade::{MaterialId, MaterialKind};
use glam::DVec3;
use std::borrow::Cow;

/// Bodies of one kind in world space, with their tree.
#[derive(Clone, Debug)]
pub struct WorldBodies<S: Shape> {
    /// All bodies.
    pub all: BodyTree<S>,
    /// The bodies that the camera sees; `None` if slices hide none.
    pub visible: Option<VisibleBodies<S>>,
}

/// The bodies that camera rays are tested against.
#[derive(Clone, Debug)]
pub struct VisibleBodies<S: Shape> {
    /// The bodies, in the order of their tree.
    pub tree: BodyTree<S>,
    /// Their rows among all.
    pub row: Vec<u32>,
}

impl<S: Shape> Default for WorldBodies<S> {
    fn default() -> Self {
        Self { all: BodyTree::default(), visible: None }
    }
}

impl<S: Shape> WorldBodies<S> {
    /// Builds the tree of bodies, whose ids are less than `ids`, and that of those that are not hidden.
    fn build(items: &[S::Item], ids: usize, is_hidden: impl Fn(u32) -> bool) -> Self {
        let all = BodyTree::<S>::build(items, Builder::default());
        let seen: Vec<_> =
            items.iter().copied().filter(|item| !is_hidden(S::around(item).2)).collect();
        let visible = (seen.len() < items.len()).then(|| {
            let tree = BodyTree::<S>::build(&seen, Builder::default());
            let mut of_id = vec![0; ids];
            for (row, &id) in all.ids().iter().enumerate() {
                of_id[id as usize] = row as u32;
            }
            let row = tree.ids().iter().map(|&id| of_id[id as usize]).collect();
            VisibleBodies { tree, row }
        });
        Self { all, visible }
    }

    /// Returns the number of bodies.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns the bodies that the camera sees.
    pub(crate) fn seen(&self) -> &BodyTree<S> {
        self.visible.as_ref().map_or(&self.all, |visible| &visible.tree)
    }

    /// Returns the rows among all of those of [`WorldBodies::seen`], if these are fewer.
    fn rows_of_seen(&self) -> Option<&[u32]> {
        self.visible.as_ref().map(|visible| visible.row.as_slice())
    }
}

/// Transforms the sticks that slices leave, and builds their tree.
pub(super) fn sticks(scene: &Scene, transform: &Transform) -> WorldBodies<Capsule> {
    let sticks = &scene.sticks;
    let place = |row: usize| {
        let ends = sticks.ends(row).map(|end| transform.point(end).as_vec3());
        let radius = transform.length(sticks.radius[row]) as f32;
        CapsuleItem { ends, radius, id: row as u32 }
    };
    let items: Vec<_> = scene.shown_sticks().map(place).filter(|item| item.radius > 0.0).collect();
    let is_hidden = |row: u32| hides(scene, sticks.middle(row as usize));
    WorldBodies::build(&items, sticks.len(), is_hidden)
}

/// Transforms the ellipsoids that slices leave, and builds their tree. Those that are too small for single precision are left
/// out.
pub(super) fn ellipsoids(scene: &Scene, transform: &Transform) -> WorldBodies<Ellipsoid> {
    let ellipsoids = &scene.ellipsoids;
    let place = |row: usize| {
        let center = transform.point(ellipsoids.center[row]).as_vec3();
        let semi_axes = ellipsoids.semi_axes[row] * transform.scale;
        EllipsoidItem::new(center, semi_axes, ellipsoids.orientation[row], row as u32).ok()
    };
    let items: Vec<_> = scene.shown_ellipsoids().filter_map(place).collect();
    let is_hidden = |row: u32| hides(scene, ellipsoids.center[row as usize]);
    WorldBodies::build(&items, ellipsoids.len(), is_hidden)
}

/// Transforms the cones that slices leave, and builds their tree. Those that are too small for single precision are left out.
pub(super) fn cones(scene: &Scene, transform: &Transform) -> WorldBodies<Cone> {
    let cones = &scene.cones;
    let place = |row: usize| {
        let [apex, base] =
            [cones.apex[row], cones.base[row]].map(|point| transform.point(point).as_vec3());
        let radius = transform.length(cones.radius[row]) as f32;
        ConeItem::new(apex, base, radius, row as u32).ok()
    };
    let items: Vec<_> = scene.shown_cones().filter_map(place).collect();
    let is_hidden = |row: u32| hides(scene, cones.middle(row as usize));
    WorldBodies::build(&items, cones.len(), is_hidden)
}

fn hides(scene: &Scene, middle: DVec3) -> bool {
    scene.slices.iter().any(|slice| slice.hides(middle))
}

impl World {
    /// Returns all bodies.
    #[inline(always)]
    pub fn trees(&self) -> BodyTrees<'_> {
        BodyTrees {
            tree: Tree { bvh: &self.bvh, spheres: &self.spheres },
            capsules: Some(&self.sticks.all),
            ellipsoids: Some(&self.ellipsoids.all),
            cones: Some(&self.cones.all),
        }
    }

    /// Returns the bodies that the camera sees.
    pub(crate) fn visible_trees(&self) -> BodyTrees<'_> {
        let visible = self.camera_visible.as_ref();
        let (bvh, spheres) =
            visible.map_or((&self.bvh, &self.spheres), |visible| (&visible.bvh, &visible.spheres));
        BodyTrees {
            tree: Tree { bvh, spheres },
            capsules: Some(self.sticks.seen()),
            ellipsoids: Some(self.ellipsoids.seen()),
            cones: Some(self.cones.seen()),
        }
    }

    /// Returns the row among all bodies of a row of [`World::visible_trees`].
    pub(crate) fn row_of_visible(&self, body: BodyRow) -> BodyRow {
        let rows = match body.kind {
            BodyKind::Sphere => self.camera_visible.as_ref().map(|visible| &*visible.row),
            BodyKind::Capsule => self.sticks.rows_of_seen(),
            BodyKind::Ellipsoid => self.ellipsoids.rows_of_seen(),
            BodyKind::Cone => self.cones.rows_of_seen(),
        };
        BodyRow { row: rows.map_or(body.row, |rows| rows[body.row] as usize), ..body }
    }

    /// Returns the numbers of hits on bodies.
    #[inline(always)]
    pub(crate) fn body_rows(&self) -> BodyRows {
        self.trees().rows()
    }

    /// Returns the number of hits on bodies, of which each half of a stick is one.
    pub fn body_count(&self) -> usize {
        self.body_rows().all_hits()
    }

    /// Returns whether there are bodies other than spheres.
    #[inline(always)]
    pub fn has_other_bodies(&self) -> bool {
        !self.sticks.is_empty() || !self.ellipsoids.is_empty() || !self.cones.is_empty()
    }

    /// Returns the body of a hit; `None` for the ground, and for none.
    #[inline(always)]
    pub fn body(&self, hit: u32) -> Option<BodyRow> {
        self.body_rows().row(hit)
    }

    /// Returns how many bodies of a kind, which is not that of spheres, have a kind of material.
    pub(super) fn count_of(&self, kind: BodyKind, material: MaterialKind) -> u64 {
        let rows = self.body_rows();
        let hits = (rows.first(kind)..).step_by(kind.hits()).take(rows.count(kind));
        hits.filter(|&hit| self.appearance.material.row(hit).kind() == material).count() as u64
    }
}

/// All bodies that are no spheres.
pub(super) struct OtherBodies<'a> {
    pub(super) sticks: &'a WorldBodies<Capsule>,
    pub(super) ellipsoids: &'a WorldBodies<Ellipsoid>,
    pub(super) cones: &'a WorldBodies<Cone>,
}

impl OtherBodies<'_> {
    /// Returns the material and the color of each hit: of the halves of sticks, then of ellipsoids, then of cones.
    fn appearances(
        &self,
        scene: &Scene,
        materials: &Materials,
    ) -> impl Iterator<Item = (MaterialId, Rgb)> {
        let Scene { sticks, ellipsoids, cones, .. } = scene;
        let halves = self.sticks.all.ids().iter().flat_map(|&id| {
            let row = id as usize;
            sticks.colors[row].map(|color| (sticks.material[row], color))
        });
        let of_ellipsoids = self.ellipsoids.all.ids().iter();
        let of_ellipsoids = of_ellipsoids
            .map(|&id| (ellipsoids.material[id as usize], ellipsoids.color[id as usize]));
        let of_cones = self.cones.all.ids().iter();
        let of_cones = of_cones.map(|&id| (cones.material[id as usize], cones.color[id as usize]));
        let all = halves.chain(of_ellipsoids).chain(of_cones);
        all.map(|(material, color)| (materials.id(material), color))
    }

    /// Appends rows for these bodies to the appearance of `spheres` spheres.
    pub(super) fn append_appearance(
        &self,
        appearance: &mut Appearance,
        scene: &Scene,
        materials: &Materials,
        spheres: usize,
    ) {
        let rows = || self.appearances(scene, materials);
        let Some((first, _)) = rows().next() else { return };
        let uniform = match &appearance.material {
            Column::Uniform(id) => spheres == 0 || *id == first,
            Column::Rows(rows) => rows.is_empty(),
        };
        appearance.material = if uniform && rows().all(|(id, _)| id == first) {
            Column::Uniform(first)
        } else {
            let own = (0..spheres).map(|row| appearance.material.row(row));
            Column::Rows(own.chain(rows().map(|(id, _)| id)).collect())
        };
        if appearance.color.is_some() || !rows().all(|(_, color)| color == Rgb::ONE) {
            let own = (0..spheres).map(|row| match &appearance.color {
                Some(colors) => colors.row(row),
                None => Rgb::ONE,
            });
            let all: Vec<Rgb> = own.chain(rows().map(|(_, color)| color)).collect();
            appearance.color = Some(Colors::new(Cow::Owned(all)));
        }
    }
}
