//! Sets up rays for traversal, sixteen at a time.
//!
//! Rays start about in their order. So the first of sixteen computes the slabs, the conservative rays
//! and the bounds of all of them, and the others look theirs up.

use super::query::Query;
use super::resolver::{DONE, HitResolver};
use crate::conservative::{ConservativeRay, ConservativeRow};
use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::slabs::{RaySlabs, Slabs};
use crate::vec3::Vec3;

/// A ray that is to be traced one by one.
#[derive(Clone, Copy)]
pub(super) struct RayStart {
    pub(super) row: usize,
    /// True if few rays of its row of lanes are traced: then only this one is set up.
    pub(super) few: bool,
}

/// The setup of sixteen consecutive rays.
pub(super) struct RaySetup {
    /// The first of the rays.
    first: usize,
    slabs: [RaySlabs; MAX_LANES],
    ray: [ConservativeRow; MAX_LANES],
    /// Lower and upper bounds of the distance at which the search ends.
    bounds: [[f32; MAX_LANES]; 2],
}

impl RaySetup {
    /// The setup of no rays.
    pub(super) const NONE: Self = Self {
        first: usize::MAX,
        slabs: [RaySlabs::IDLE; MAX_LANES],
        ray: [ConservativeRow::NONE; MAX_LANES],
        bounds: [[DONE; MAX_LANES]; 2],
    };
}

impl<Q: Query> HitResolver<'_, Q> {
    /// Returns the conservative ray, and bounds of the distance at which its search ends; [`DONE`] if it
    /// needs no answer.
    #[inline(always)]
    pub(super) fn start_ray(
        &mut self,
        RayStart { row, few }: RayStart,
        slabs: &mut RaySlabs,
    ) -> (ConservativeRay<f32>, (f32, f32)) {
        if few {
            let (origin, direction) = (self.rays.origin.row(row), self.rays.direction.row(row));
            *slabs = RaySlabs::new(origin, direction);
            return (ConservativeRay::new(origin.into(), direction.into()), self.bounds(row));
        }
        let place = row % MAX_LANES;
        if self.setup.first != row - place {
            self.set_up_rays(row - place);
        }
        let setup = &self.setup;
        *slabs = setup.slabs[place];
        (setup.ray[place].into(), (setup.bounds[0][place], setup.bounds[1][place]))
    }

    #[inline(never)]
    fn set_up_rays(&mut self, first: usize) {
        let (origin, direction) = (self.rays.origin.load(first), self.rays.direction.load(first));
        let bounds = self.search_bounds::<F32x16>(first, F32x16::lanes(u32::MAX));
        let setup = &mut self.setup;
        let columns = |v: Vec3<F32x16>| [v.x, v.y, v.z];
        RaySlabs::of_rays(columns(origin), columns(direction), &mut setup.slabs);
        ConservativeRay::new(origin, direction).rows(&mut setup.ray);
        setup.bounds = [bounds.0.to_array(), bounds.1.to_array()];
        setup.first = first;
    }
}
