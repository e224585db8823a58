//! Rows of sixteen hits as their materials see them, with the states of the paths.

use super::columns::LaneRows;
use super::material_queues::MaterialQueue;
use super::path_state::PathStateRow;
use crate::lanes::{F32x16, Lanes, U32x16};
use crate::sampling::Bases;
use crate::vec3::Vec3;
use crate::world::{ReceiverRow, World};

/// A row of surface points from which shadow rays or next rays start.
pub struct SurfaceLanes {
    /// Rows of the rays that hit the points; arbitrary in lanes without a path.
    pub rows: U32x16,
    /// Points, normals on the sides that the rays come from, and spheres.
    pub at: ReceiverRow,
    /// Lanes whose sphere is hit from inside.
    pub inside: u32,
    /// States of the paths.
    pub state: PathStateRow,
}

/// A row of surface points with their local bases.
pub struct ShadingRow<'a> {
    /// The surface points.
    pub surface_row: &'a SurfaceLanes,
    /// Lanes that have a path.
    pub lanes: u32,
    /// Transforms to world space and back; z is the normal on the side that the ray comes from.
    pub bases: Bases<F32x16>,
    /// Local unit vectors toward the origins of the rays.
    pub outgoing: Vec3<F32x16>,
}

impl SurfaceLanes {
    /// Loads sixteen hits of a queue.
    #[inline(always)]
    pub fn load(queue: &MaterialQueue, first: usize) -> Self {
        Self {
            rows: queue.ray_row(first),
            at: ReceiverRow {
                point: queue.point_row(first),
                normal: queue.facing_row(first),
                own: queue.hit_row(first).to_array(),
            },
            inside: queue.inside(first),
            state: queue.state_row(first),
        }
    }

    /// Returns the characteristic colors at the points: [`World::albedo`].
    #[inline(always)]
    pub fn albedo(&self, world: &World) -> Vec3<F32x16> {
        let colors = self.at.own.map(|hit| world.albedo(hit));
        let channel = |i: usize| F32x16::new(colors.map(|color| color[i]));
        Vec3::new(channel(0), channel(1), channel(2))
    }
}

impl<'a> ShadingRow<'a> {
    /// Creates a row from sixteen hits of a queue and their surface points.
    #[inline(always)]
    pub fn new(queue: &MaterialQueue, rows: LaneRows, surface_row: &'a SurfaceLanes) -> Self {
        let bases = Bases::about(surface_row.at.normal);
        let mut outgoing = bases.to_local(-queue.direction_row(rows.first));
        // At grazing angles, rounding may move the direction below the horizon.
        outgoing.z = Lanes::max(outgoing.z, F32x16::splat(f32::EPSILON));
        Self { surface_row, lanes: rows.lanes, bases, outgoing }
    }

    /// Transforms local directions to world space, of unit length.
    #[inline(always)]
    pub fn to_world(&self, local: Vec3<F32x16>) -> Vec3<F32x16> {
        self.bases.to_world(local).normalize()
    }
}
