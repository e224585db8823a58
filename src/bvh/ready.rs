//! Rays that are made ready in lanes, and go on each on its own.
//!
//! They come about in their order: so what sixteen of them begin with is worked out at once, and found
//! by all but the first.

use super::decide::{DONE, Decider};
use super::walk::Query;
use crate::filter::{FilterRay, FilterRow};
use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::slabs::Slabs;
use crate::vec3::Vec3;

/// Which ray is to begin.
#[derive(Clone, Copy)]
pub(super) struct Start {
    pub(super) row: usize,
    /// Whether only few rays of its row of lanes are to begin: then there is no use in making all ready.
    pub(super) few: bool,
}

/// What walks want to know of a row of rays that have not begun.
pub(super) struct Ready {
    /// The first of the rays.
    first: usize,
    slabs: [Slabs; MAX_LANES],
    filter: [FilterRow; MAX_LANES],
    /// Bounds of the distances that count.
    bounds: [[f32; MAX_LANES]; 2],
}

impl Ready {
    /// Of no rays.
    pub(super) const NONE: Self = Self {
        first: usize::MAX,
        slabs: [Slabs::IDLE; MAX_LANES],
        filter: [FilterRow::NONE; MAX_LANES],
        bounds: [[DONE; MAX_LANES]; 2],
    };
}

impl<Q: Query> Decider<'_, Q> {
    /// What a ray begins with, and bounds of the distance that still counts; [`DONE`] if none does.
    #[inline(always)]
    pub(super) fn begin(
        &mut self,
        Start { row, few }: Start,
        slabs: &mut Slabs,
    ) -> (FilterRay<f32>, (f32, f32)) {
        if few {
            let (origin, direction) = (self.rays.origin.row(row), self.rays.direction.row(row));
            *slabs = Slabs::new(origin, direction);
            return (FilterRay::new(origin.into(), direction.into()), self.bounds(row));
        }
        let place = row % MAX_LANES;
        if self.ready.first != row - place {
            self.make_ready(row - place);
        }
        let ready = &self.ready;
        *slabs = ready.slabs[place];
        (ready.filter[place].into(), (ready.bounds[0][place], ready.bounds[1][place]))
    }

    #[inline(never)]
    fn make_ready(&mut self, first: usize) {
        let (origin, direction) = (self.rays.origin.load(first), self.rays.direction.load(first));
        let bounds = self.start::<F32x16>(first, F32x16::lanes(u32::MAX));
        let ready = &mut self.ready;
        let columns = |v: Vec3<F32x16>| [v.x, v.y, v.z];
        Slabs::of_rays(columns(origin), columns(direction), &mut ready.slabs);
        FilterRay::new(origin, direction).rows(&mut ready.filter);
        ready.bounds = [bounds.0.to_array(), bounds.1.to_array()];
        ready.first = first;
    }
}
