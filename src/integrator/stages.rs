//! The stages that integrators share, in the order of a path's life.

use super::Job;
use super::block::row;
use super::clock::Stage;
use super::surface::solve;
use super::workspace::Workspace;
use crate::film::View;
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask, U32x16, bits, bits_of, first_lanes};
use crate::ray::{Hits, MISS, Rays};
use crate::sampling;
use crate::shade::Material;
use crate::trace;
use crate::world::{Kind, MaterialId, World};
use glam::Vec3;

/// Finds what each path hits next, where, and sorts the rows by what it is.
pub fn intersect(job: &Job, work: &mut Workspace) {
    if let Some(ground) = job.unseen_ground() {
        trace::stop_at(&ground, &work.rays, &mut work.hits);
    }
    match std::mem::replace(&mut work.view, View::Anything) {
        View::Background => trace::closest_ground(job.world, &work.rays, &mut work.hits),
        View::Anything => {
            work.counters.exact_decisions +=
                trace::closest(job.tracer, job.world, &work.rays, &mut work.hits);
        }
    }
    work.clock.end(Stage::Trace);
    solve(job.world, work);
    work.sort(job.world);
    work.clock.end(Stage::Surface);
}

/// The surface that a row has hit, as its material sees it.
#[derive(Clone, Copy)]
pub struct Local {
    /// To world space and back; z is the normal on the side that is looked at.
    pub frame: sampling::Frame,
    /// Local unit vector toward where the path came from.
    pub outgoing: Vec3,
    /// Whether the sphere is seen from inside.
    pub inside: bool,
}

impl Local {
    /// The surface under row `row`.
    #[inline]
    pub fn new(work: &Workspace, row: usize) -> Self {
        let direction = work.rays.direction.row(row);
        let normal = work.surface.normal.row(row);
        let inside = normal.dot(direction.as_dvec3()) > 0.0;
        let facing = if inside { -normal } else { normal };
        let frame = sampling::Frame::new(facing.as_vec3());
        let mut outgoing = frame.to_local(-direction);
        // At the limb, rounding may put the viewer below the horizon.
        outgoing.z = outgoing.z.max(f32::EPSILON);
        Self { frame, outgoing, inside }
    }

    /// A sampled direction in world space, of unit length.
    #[inline]
    pub fn to_world(&self, incoming: Vec3) -> Vec3 {
        self.frame.to_world(incoming).normalize()
    }
}

/// Traces the shadow rays and gives their light to the paths that it reaches.
pub fn occlude(job: &Job, work: &mut Workspace) {
    work.clock.end(Stage::Shade);
    let shadows = &mut work.shadows;
    work.counters.exact_decisions += find_hidden(job, &shadows.rays, &mut shadows.hits);
    for first in (0..shadows.rays.len()).step_by(MAX_LANES) {
        let there = first_lanes(shadows.rays.len() - first);
        let hits: F32x16 = bits_of(&shadows.hits.sphere[first..]);
        let lit = hits.has_bits_of(bits(MISS)).bits() & there;
        let place = U32x16::new(*row(&shadows.place, first));
        work.paths.add(place, shadows.light.load(first), lit);
    }
    work.counters.shadow_rays += shadows.rays.len() as u64;
    shadows.rays.truncate(0);
    work.clock.end(Stage::Shadow);
}

/// Finds which shadow rays something is in the way of.
pub(super) fn find_hidden(job: &Job, rays: &Rays, hits: &mut Hits) -> u64 {
    if let Some(ground) = job.unseen_ground() {
        trace::hide_behind(&ground, rays, hits);
    }
    if job.skips.nearest_occluder {
        trace::occluded(job.tracer, job.world, rays, hits)
    } else {
        trace::closest(job.tracer, job.world, rays, hits)
    }
}

/// What is done for each kind of material.
pub trait ByKind {
    /// Does it for one kind, whose materials `table` finds.
    fn visit<M: Material>(&mut self, kind: Kind, table: impl Fn(MaterialId) -> M);
}

/// Runs a system over every kind of material but glass.
pub fn by_kind(world: &World, system: &mut impl ByKind) {
    let tables = &world.materials;
    system.visit(Kind::Lambertian, |id| tables.lambertian[id.row()]);
    system.visit(Kind::Conductor, |id| tables.conductor[id.row()]);
    system.visit(Kind::Plastic, |id| tables.plastic[id.row()]);
    system.visit(Kind::Reflective, |id| tables.reflective[id.row()]);
    system.visit(Kind::Emitter, |id| tables.emitter[id.row()].surface());
}
