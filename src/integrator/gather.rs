//! Rows of paths: what each of sixteen brings to the surface that it has hit.

use super::pick::{padded, pick, pick_colors, pick_row};
use super::stages::Local;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes};
use crate::sampling::{Frames, PathRow};
use crate::vec3::Vec3;
use crate::world::{ROW, ReceiverRow};

/// Where a row of shadow rays starts.
pub struct Starts {
    /// Rows of the paths; lanes without a path are like the first.
    pub rows: [u32; ROW],
    /// The surfaces, on the sides that are looked at.
    pub at: ReceiverRow,
    /// Lanes whose sphere is seen from inside.
    pub inside: u32,
}

/// A row of paths at surfaces.
pub struct Gathered {
    /// Where they are.
    pub starts: Starts,
    /// Lanes that have a path.
    pub lanes: u32,
    /// To world space and back; z is the normal on the side that is looked at.
    pub frames: Frames<F32x16>,
    /// Local unit vectors toward where the paths came from.
    pub outgoing: Vec3<F32x16>,
    /// Product of the weights so far.
    pub throughput: Vec3<F32x16>,
    /// Where in their sequences of samples the paths are.
    pub sample: PathRow,
}

impl Starts {
    /// All from the surface that the path in `row` has hit.
    pub fn one(work: &Workspace, row: usize, local: &Local) -> Self {
        let splat = |v: glam::Vec3| Vec3::from(v).map(F32x16::splat);
        Self {
            rows: [row as u32; ROW],
            at: ReceiverRow {
                point: splat(work.surface.point.row(row)),
                normal: splat(local.frame.normal),
                own: [work.hits.sphere[row]; ROW],
            },
            inside: if local.inside { u32::from(u16::MAX) } else { 0 },
        }
    }

    /// Of the paths in at most sixteen rows.
    #[inline(always)]
    fn of(work: &Workspace, some: &[u32]) -> Self {
        let rows = padded(some);
        let (point, normal) = (&work.surface.point, &work.surface.facing);
        Self {
            rows,
            at: ReceiverRow {
                point: pick_row(point, &rows),
                normal: pick_row(normal, &rows),
                own: pick(&work.hits.sphere, &rows),
            },
            inside: work.surface.inside(&rows),
        }
    }
}

impl Gathered {
    /// The paths in at most sixteen rows.
    #[inline(always)]
    pub fn new(work: &Workspace, some: &[u32]) -> Self {
        let starts = Starts::of(work, some);
        let place = pick(&work.place, &starts.rows);
        let frames = Frames::about(starts.at.normal);
        let mut outgoing = frames.to_local(-pick_row(&work.rays.direction, &starts.rows));
        // At the limb, rounding may put the viewer below the horizon.
        outgoing.z = Lanes::max(outgoing.z, F32x16::splat(f32::EPSILON));
        Self {
            starts,
            lanes: (1 << some.len()) - 1,
            frames,
            outgoing,
            throughput: pick_colors(&work.paths.throughput, &place),
            sample: work.samples(some),
        }
    }

    /// Local directions in world space, of unit length.
    #[inline(always)]
    pub fn to_world(&self, local: Vec3<F32x16>) -> Vec3<F32x16> {
        self.frames.to_world(local).normalize()
    }
}
