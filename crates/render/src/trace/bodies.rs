//! The bodies that rays may hit: spheres, and sticks.

use super::{Query, Tracer};
use crate::bodies::{self, BodyTrees};
use crate::bvh::Tree;
use crate::capsules::{CapsuleRow, Capsules};
use crate::ray::{Hits, Rays};
use crate::translucency::{OpticalDepth, TranslucentBodies};
use crate::world::World;

/// Spheres and sticks, all or those that the camera sees. Hits are rows of the spheres, and after them two for each stick.
#[derive(Clone, Copy)]
pub(super) struct Bodies<'a> {
    tree: Tree<'a>,
    sticks: &'a Capsules,
}

impl<'a> Bodies<'a> {
    /// All bodies of a world.
    pub(super) fn all(world: &'a World) -> Self {
        let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
        Self { tree, sticks: &world.sticks.all }
    }

    /// The bodies that the camera sees.
    pub(super) fn visible(world: &'a World) -> Self {
        let mut bodies = Self::all(world);
        if let Some(visible) = &world.camera_visible {
            bodies.tree = Tree { bvh: &visible.bvh, spheres: &visible.spheres };
        }
        if let Some(visible) = &world.sticks.visible {
            bodies.sticks = &visible.capsules;
        }
        bodies
    }

    /// Returns the hit in a world of a hit on a body that the camera sees.
    pub(super) fn hit_in(&self, world: &World, hit: u32) -> u32 {
        let spheres = self.tree.spheres.len();
        if let Some(row) = CapsuleRow::of_hit(hit, spheres).filter(|_| !self.sticks.is_empty()) {
            let rows = world.sticks.visible.as_ref().map(|visible| &visible.row);
            let capsule = rows.map_or(row.capsule, |rows| rows[row.capsule] as usize);
            return CapsuleRow { capsule, ..row }.hit(world.spheres.len());
        }
        let rows = world.camera_visible.as_ref().map(|visible| &visible.row);
        rows.and_then(|rows| rows.get(hit as usize)).copied().unwrap_or(hit)
    }

    /// The same bodies, with what light loses at each, by its hit.
    pub(super) fn translucent<D: Fn(u32) -> OpticalDepth>(
        self,
        depth: D,
    ) -> TranslucentBodies<'a, D> {
        TranslucentBodies { tree: self.tree, capsules: self.sticks, depth }
    }

    /// Traces rays with the processor.
    pub(super) fn trace(self, tracer: Tracer, query: Query, rays: &Rays, hits: &mut Hits) -> u64 {
        let exact = match query {
            Query::Closest => tracer.closest(self.tree, rays, hits),
            Query::Any => tracer.occluded(self.tree, rays, hits),
        };
        exact + self.trace_sticks(query, rays, hits)
    }

    /// Traces rays whose hits on spheres are known.
    #[inline(always)]
    pub(super) fn trace_sticks(self, query: Query, rays: &Rays, hits: &mut Hits) -> u64 {
        if self.sticks.is_empty() {
            return 0;
        }
        let bodies =
            BodyTrees { spheres: self.tree.spheres, capsules: self.sticks, ellipsoids: None };
        match query {
            Query::Closest => bodies::closest(bodies, rays, hits),
            Query::Any => bodies::occluded(bodies, rays, hits),
        }
    }

    /// Returns the hit on the cap of the body that contains a point; `None` if none does.
    pub(super) fn enclosing(&self, point: glam::Vec3) -> Option<u32> {
        let Self { tree, sticks } = self;
        tree.bvh.enclosing_sphere(tree.spheres, point).or_else(|| {
            let capsule = sticks.enclosing(point.as_dvec3())?;
            Some(self.cap_of_stick(capsule, point))
        })
    }

    /// Returns the hits on the caps of all bodies that contain a point, in their order on the cut: the first is that of
    /// [`Bodies::enclosing`].
    pub(super) fn all_enclosing(self, point: glam::Vec3) -> impl Iterator<Item = u32> {
        let Self { tree, sticks } = self;
        let sticks = sticks.all_enclosing(point.as_dvec3());
        let sticks = sticks.into_iter().map(move |capsule| self.cap_of_stick(capsule, point));
        tree.bvh.enclosing_spheres(tree.spheres, point).into_iter().chain(sticks)
    }

    /// The hit on the cap of a stick at a point.
    fn cap_of_stick(&self, capsule: usize, point: glam::Vec3) -> u32 {
        let body = self.sticks.body(capsule);
        let half = usize::from(body.normal(point.as_dvec3() - body.ends[0]).1 > 0.5);
        CapsuleRow { capsule, half }.hit(self.tree.spheres.len())
    }
}
