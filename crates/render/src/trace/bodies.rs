//! The bodies that rays may hit: spheres, sticks, ellipsoids and cones.

use super::{Query, Tracer};
use crate::bodies::{self, BodyTrees};
use crate::body_rows::{BodyRow, BodyRows};
use crate::bvh::Tree;
use crate::capsules::{CapsuleRow, Capsules};
use crate::cones::Cones;
use crate::ellipsoids::Ellipsoids;
use crate::ray::{Hits, Rays};
use crate::translucency::{OpticalDepth, TranslucentBodies};
use crate::world::World;

/// Bodies of all kinds, all or those that the camera sees. Hits are numbered as [`BodyRows`] says.
#[derive(Clone, Copy)]
pub(super) struct Bodies<'a> {
    tree: Tree<'a>,
    sticks: &'a Capsules,
    ellipsoids: &'a Ellipsoids,
    cones: &'a Cones,
}

impl<'a> Bodies<'a> {
    /// All bodies of a world.
    pub(super) fn all(world: &'a World) -> Self {
        let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
        Self {
            tree,
            sticks: &world.sticks.all,
            ellipsoids: &world.ellipsoids.all,
            cones: &world.cones.all,
        }
    }

    /// The bodies that the camera sees.
    pub(super) fn visible(world: &'a World) -> Self {
        let visible = world.camera_visible.as_ref();
        let (bvh, spheres) = visible
            .map_or((&world.bvh, &world.spheres), |visible| (&visible.bvh, &visible.spheres));
        Self {
            tree: Tree { bvh, spheres },
            sticks: world.sticks.seen(),
            ellipsoids: world.ellipsoids.seen(),
            cones: world.cones.seen(),
        }
    }

    /// The numbers of hits.
    fn rows(&self) -> BodyRows {
        BodyRows {
            spheres: self.tree.spheres.len(),
            capsules: self.sticks.len(),
            ellipsoids: self.ellipsoids.len(),
        }
    }

    /// Returns the hit in a world of a hit on a body that the camera sees.
    pub(super) fn hit_in(&self, world: &World, hit: u32) -> u32 {
        let Some(row) = self.rows().row(hit) else { return hit };
        let row = match row {
            BodyRow::Sphere(row) => {
                let rows = world.camera_visible.as_ref().map(|visible| &visible.row);
                BodyRow::Sphere(rows.map_or(row, |rows| rows[row] as usize))
            }
            BodyRow::Capsule(CapsuleRow { capsule, half }) => {
                BodyRow::Capsule(CapsuleRow { capsule: world.sticks.row_of_seen(capsule), half })
            }
            BodyRow::Ellipsoid(row) => BodyRow::Ellipsoid(world.ellipsoids.row_of_seen(row)),
            BodyRow::Cone(row) => BodyRow::Cone(world.cones.row_of_seen(row)),
        };
        world.body_rows().hit(row)
    }

    /// The same bodies, with what light loses at each, by its hit.
    pub(super) fn translucent<D: Fn(u32) -> OpticalDepth>(
        self,
        depth: D,
    ) -> TranslucentBodies<'a, D> {
        let Self { tree, sticks, ellipsoids, cones } = self;
        TranslucentBodies { tree, capsules: sticks, ellipsoids, cones, depth }
    }

    /// Traces rays with the processor.
    pub(super) fn trace(self, tracer: Tracer, query: Query, rays: &Rays, hits: &mut Hits) -> u64 {
        let exact = match query {
            Query::Closest => tracer.closest(self.tree, rays, hits),
            Query::Any => tracer.occluded(self.tree, rays, hits),
        };
        exact + self.trace_others(query, rays, hits)
    }

    /// Traces rays among bodies other than spheres, whose hits are known.
    #[inline(always)]
    fn trace_others(self, query: Query, rays: &Rays, hits: &mut Hits) -> u64 {
        if self.sticks.is_empty() && self.ellipsoids.is_empty() && self.cones.is_empty() {
            return 0;
        }
        let bodies = BodyTrees {
            spheres: self.tree.spheres,
            capsules: self.sticks,
            ellipsoids: (!self.ellipsoids.is_empty()).then_some(self.ellipsoids),
            cones: (!self.cones.is_empty()).then_some(self.cones),
        };
        match query {
            Query::Closest => bodies::closest(bodies, rays, hits),
            Query::Any => bodies::occluded(bodies, rays, hits),
        }
    }

    /// Returns the hit on the cap of the body that contains a point; `None` if none does.
    pub(super) fn enclosing(&self, point: glam::Vec3) -> Option<u32> {
        let (tree, exact) = (&self.tree, point.as_dvec3());
        let stick = || Some(self.cap_of_stick(self.sticks.enclosing(exact)?, point));
        let cap = |row: BodyRow| self.rows().hit(row);
        let ellipsoid = || Some(cap(BodyRow::Ellipsoid(self.ellipsoids.enclosing(exact)?)));
        let cone = || Some(cap(BodyRow::Cone(self.cones.enclosing(exact)?)));
        let sphere = tree.bvh.enclosing_sphere(tree.spheres, point);
        sphere.or_else(stick).or_else(ellipsoid).or_else(cone)
    }

    /// Returns the hits on the caps of all bodies that contain a point, in their order on the cut: the first is that of
    /// [`Bodies::enclosing`].
    pub(super) fn all_enclosing(self, point: glam::Vec3) -> impl Iterator<Item = u32> {
        let (tree, exact) = (self.tree, point.as_dvec3());
        let sticks = self.sticks.all_enclosing(exact);
        let sticks = sticks.into_iter().map(move |capsule| self.cap_of_stick(capsule, point));
        let ellipsoids = self.ellipsoids.all_enclosing(exact);
        let cones = self.cones.all_enclosing(exact);
        let rows = ellipsoids.into_iter().map(BodyRow::Ellipsoid);
        let rows = rows.chain(cones.into_iter().map(BodyRow::Cone));
        let others = rows.map(move |row| self.rows().hit(row));
        let spheres = tree.bvh.enclosing_spheres(tree.spheres, point);
        spheres.into_iter().chain(sticks).chain(others)
    }

    /// The hit on the cap of a stick at a point.
    fn cap_of_stick(&self, capsule: usize, point: glam::Vec3) -> u32 {
        let body = self.sticks.body(capsule);
        let half = usize::from(body.normal(point.as_dvec3() - body.ends[0]).1 > 0.5);
        self.rows().hit(BodyRow::Capsule(CapsuleRow { capsule, half }))
    }
}
