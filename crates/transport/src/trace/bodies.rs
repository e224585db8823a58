//! The bodies that rays may hit.

use super::{Query, Tracer};
use crate::bodies::{self, BodyTrees};
use crate::ray::{Hits, Rays};
use crate::translucency::{OpticalDepth, TranslucentBodies};
use crate::world::World;
use glam::Vec3;

/// Bodies of all kinds, all or those that the camera sees.
#[derive(Clone, Copy)]
pub(super) struct Bodies<'a>(BodyTrees<'a>);

impl<'a> Bodies<'a> {
    /// All bodies of a world.
    pub(super) fn all(world: &'a World) -> Self {
        Self(world.trees())
    }

    /// The bodies that the camera sees.
    pub(super) fn visible(world: &'a World) -> Self {
        Self(world.visible_trees())
    }

    /// Returns the hit in a world of a hit on a body that the camera sees.
    pub(super) fn hit_in(&self, world: &World, hit: u32) -> u32 {
        let Some(row) = self.0.rows().row(hit) else { return hit };
        world.body_rows().hit(world.row_of_visible(row))
    }

    /// The same bodies, with what light loses at each, by its hit.
    pub(super) fn translucent<D: Fn(u32) -> OpticalDepth>(
        self,
        depth: D,
    ) -> TranslucentBodies<'a, D> {
        TranslucentBodies { bodies: self.0, depth }
    }

    /// Traces rays with the processor.
    pub(super) fn trace(self, tracer: Tracer, query: Query, rays: &Rays, hits: &mut Hits) -> u64 {
        match query {
            Query::Closest => {
                tracer.closest(self.0.tree, rays, hits) + bodies::closest(self.0, rays, hits)
            }
            Query::Any => {
                tracer.occluded(self.0.tree, rays, hits) + bodies::occluded(self.0, rays, hits)
            }
        }
    }

    /// Returns the hit on the cap of the body that contains a point; `None` if none does.
    pub(super) fn enclosing(&self, point: Vec3) -> Option<u32> {
        self.0.enclosing(point)
    }

    /// Returns the hits on the caps of all bodies that contain a point, in their order on the cut: the first is that of
    /// [`Bodies::enclosing`].
    pub(super) fn all_enclosing(self, point: Vec3) -> impl Iterator<Item = u32> {
        self.0.all_enclosing(point)
    }
}
