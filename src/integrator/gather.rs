//! Rows of paths: what each of sixteen brings to the surface that it has hit.

use super::bins::Bin;
use super::carried::CarriedRow;
use super::stages::Local;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, U32x16};
use crate::sampling::Frames;
use crate::vec3::Vec3;
use crate::world::{ROW, ReceiverRow};

/// Where a row of shadow rays, or of paths, starts.
pub struct Starts {
    /// Rows of the rays that have come there; anything in lanes without a path.
    pub rows: U32x16,
    /// The surfaces, on the sides that are looked at.
    pub at: ReceiverRow,
    /// Lanes whose sphere is seen from inside.
    pub inside: u32,
    /// What the paths bring.
    pub carried: CarriedRow,
}

/// A row of paths at surfaces.
pub struct Gathered<'a> {
    /// Where they are.
    pub starts: &'a Starts,
    /// Lanes that have a path.
    pub lanes: u32,
    /// To world space and back; z is the normal on the side that is looked at.
    pub frames: Frames<F32x16>,
    /// Local unit vectors toward where the paths came from.
    pub outgoing: Vec3<F32x16>,
}

impl Starts {
    /// All from the surface that the path in `row` has hit.
    pub fn one(work: &Workspace, row: usize, local: &Local) -> Self {
        let splat = |v: glam::Vec3| Vec3::from(v).map(F32x16::splat);
        Self {
            rows: U32x16::splat(row as u32),
            at: ReceiverRow {
                point: splat(work.surface.point.row(row)),
                normal: splat(local.frame.normal),
                own: [work.hits.sphere[row]; ROW],
            },
            inside: if local.inside { u32::from(u16::MAX) } else { 0 },
            carried: work.carried.one(row),
        }
    }

    /// Of the paths in sixteen rows of a bin.
    #[inline(always)]
    pub fn of(bin: &Bin, first: usize) -> Self {
        Self {
            rows: bin.ray_row(first),
            at: ReceiverRow {
                point: bin.point_row(first),
                normal: bin.facing_row(first),
                own: bin.hit_row(first).to_array(),
            },
            inside: bin.inside(first),
            carried: bin.carried_row(first),
        }
    }
}

impl<'a> Gathered<'a> {
    /// The paths in those of sixteen rows of a bin that there are, which start there.
    #[inline(always)]
    pub fn new(bin: &Bin, (first, lanes): (usize, u32), starts: &'a Starts) -> Self {
        let frames = Frames::about(starts.at.normal);
        let mut outgoing = frames.to_local(-bin.direction_row(first));
        // At the limb, rounding may put the viewer below the horizon.
        outgoing.z = Lanes::max(outgoing.z, F32x16::splat(f32::EPSILON));
        Self { starts, lanes, frames, outgoing }
    }

    /// Local directions in world space, of unit length.
    #[inline(always)]
    pub fn to_world(&self, local: Vec3<F32x16>) -> Vec3<F32x16> {
        self.frames.to_world(local).normalize()
    }
}
