//! The bodies of a scene other than spheres, in world space.

use super::appearance::{Colors, Column};
use super::{Appearance, Transform};
use crate::bodies::BodyTrees;
use crate::body_rows::BodyKind;
use crate::body_tree::{BodyTree, Shape};
use crate::bvh::Tree;
use crate::bvh::builders::Builder;
use crate::capsules::Capsule;
use crate::cones::Cone;
use crate::ellipsoids::Ellipsoid;
use crate::scene::{PlacedBodies, Rgb, Scene};
use crate::shade::Materials;
use spherule_core::internals::triangles::Triangle;
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

    /// Returns the bodies that the camera sees.
    fn seen(&self) -> &BodyTree<S> {
        self.visible.as_ref().map_or(&self.all, |visible| &visible.tree)
    }

    /// Returns the rows among all of those of [`WorldBodies::seen`], if these are fewer.
    fn rows_of_seen(&self) -> Option<&[u32]> {
        self.visible.as_ref().map(|visible| visible.row.as_slice())
    }
}

/// All bodies of a scene that are no spheres.
#[derive(Clone, Debug, Default)]
pub struct OtherBodies {
    /// Sticks, whose halves have rows of the appearance after those of the spheres.
    pub sticks: WorldBodies<Capsule>,
    /// Ellipsoids, which have rows after those.
    pub ellipsoids: WorldBodies<Ellipsoid>,
    /// Cones, which have rows after those.
    pub cones: WorldBodies<Cone>,
    /// Triangles, which have rows after those.
    pub triangles: WorldBodies<Triangle>,
}

impl OtherBodies {
    /// Transforms the bodies that slices leave, and builds their trees. Those that are too small for single precision are left out.
    pub(super) fn build(scene: &Scene, transform: &Transform) -> Self {
        Self {
            sticks: placed(&scene.sticks, scene, transform),
            ellipsoids: placed(&scene.ellipsoids, scene, transform),
            cones: placed(&scene.cones, scene, transform),
            triangles: placed(&scene.triangles, scene, transform),
        }
    }

    /// Joins the bodies with the spheres of a tree.
    #[inline(always)]
    pub(super) fn trees<'a>(&'a self, tree: Tree<'a>) -> BodyTrees<'a> {
        BodyTrees {
            tree,
            capsules: Some(&self.sticks.all),
            ellipsoids: Some(&self.ellipsoids.all),
            cones: Some(&self.cones.all),
            triangles: Some(&self.triangles.all),
        }
    }

    /// Joins the bodies that the camera sees with the spheres of a tree.
    pub(super) fn seen<'a>(&'a self, tree: Tree<'a>) -> BodyTrees<'a> {
        BodyTrees {
            tree,
            capsules: Some(self.sticks.seen()),
            ellipsoids: Some(self.ellipsoids.seen()),
            cones: Some(self.cones.seen()),
            triangles: Some(self.triangles.seen()),
        }
    }

    /// The rows among all of the bodies of a kind that the camera sees, if these are fewer.
    pub(super) fn rows_of_seen(&self, kind: BodyKind) -> Option<&[u32]> {
        match kind {
            BodyKind::Sphere => None,
            BodyKind::Capsule => self.sticks.rows_of_seen(),
            BodyKind::Ellipsoid => self.ellipsoids.rows_of_seen(),
            BodyKind::Cone => self.cones.rows_of_seen(),
            BodyKind::Triangle => self.triangles.rows_of_seen(),
        }
    }

    /// Returns whether slices hide any from the camera.
    pub(super) fn any_hidden(&self) -> bool {
        BodyKind::ALL.into_iter().any(|kind| self.rows_of_seen(kind).is_some())
    }
}

/// Transforms the bodies of a kind that slices leave, and builds their tree.
fn placed<B: PlacedBodies>(
    bodies: &B,
    scene: &Scene,
    transform: &Transform,
) -> WorldBodies<B::Shape> {
    let place = |row| bodies.place(row, |point| transform.point(point), transform.scale);
    let items: Vec<_> = scene.shown_of(bodies).filter_map(place).collect();
    let is_hidden = |row: u32| {
        let middle = bodies.middle(row as usize);
        scene.slices.iter().any(|slice| slice.hides(middle))
    };
    WorldBodies::build(&items, bodies.len(), is_hidden)
}

/// Appends rows for bodies that are no spheres to the appearance of `spheres` spheres.
pub(super) fn append_appearance(
    appearance: &mut Appearance,
    trees: BodyTrees,
    scene: &Scene,
    materials: &Materials,
) {
    let spheres = trees.rows().count(BodyKind::Sphere);
    // The material and the color of each hit.
    let rows = || {
        scene.other_bodies().into_iter().flat_map(|bodies| {
            trees.ids(bodies.kind()).iter().flat_map(move |&id| {
                let material = materials.id(bodies.materials()[id as usize]);
                bodies.colors(id as usize).iter().map(move |&color| (material, color))
            })
        })
    };
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
