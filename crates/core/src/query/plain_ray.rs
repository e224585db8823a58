//! Calls for one ray that single precision holds, as it does almost all.

use super::load::{LONGEST, is_exact, reciprocal_power};
use super::surface::surface_of;
use super::{Hit, SphereTree, Surface};
use crate::bvh::{PlainAnswer, PlainRay};
use crate::lanes::{F32x4, Lanes, Mask};

/// A ray that is not plain, or that is not decided yet.
pub(super) struct Undecided;

impl SphereTree {
    /// Returns a ray in the tree's units, and the power of two that its direction was multiplied by; `None` if it is not
    /// plain, as in [`SphereTree::load`], or if the tree has spheres that single precision does not hold.
    #[inline(always)]
    fn plain_ray(&self, [x, y, z]: [f32; 3], [dx, dy, dz]: [f32; 3]) -> Option<(PlainRay, f32)> {
        let longest = Lanes::max(Lanes::max(dx.abs(), dy.abs()), dz.abs());
        let shrink = reciprocal_power(longest);
        let [scale, unscale] = self.single_scale;
        let (origin, direction) = (F32x4::new([x, y, z, 0.0]), F32x4::new([dx, dy, dz, 1.0]));
        let (moved, turned) = (origin * scale, direction * F32x4::splat(shrink));
        let stretch = F32x4::splat(reciprocal_power(shrink));
        let plain = Lanes::abs(moved).le(self.reach)
            & is_exact(moved, origin, unscale)
            & is_exact(turned, direction, stretch);
        let plain = plain.bits() & 7 == 7
            && (LONGEST.recip()..=LONGEST).contains(&longest)
            && self.strays.is_empty()
            && self.spheres.precise.is_empty();
        plain.then_some((PlainRay { origin: moved, direction: turned }, shrink))
    }

    /// Does what [`SphereTree::intersect_within`] does, for almost all rays.
    #[inline(always)]
    pub(super) fn intersect_plain(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        t_max: f64,
    ) -> Result<Option<Hit>, Undecided> {
        if t_max.is_nan() {
            return Err(Undecided);
        }
        let (ray, shrink) = self.plain_ray(origin, direction).ok_or(Undecided)?;
        match ray.intersect(self.tree(), t_max * self.scale[0] * f64::from(shrink.recip())) {
            PlainAnswer::Miss => Ok(None),
            PlainAnswer::Undecided => Err(Undecided),
            PlainAnswer::Hit(hit) => {
                let exact = || (ray.exact(), self.spheres.exact(hit.sphere));
                let Surface { point, normal } = surface_of(&hit.pair, exact, hit.t, self.scale[1]);
                // Powers of two, whose product does not round.
                let t = hit.t * (f64::from(shrink) * self.scale[1]);
                Ok(Some(Hit { sphere: self.spheres.id[hit.sphere], t, point, normal }))
            }
        }
    }

    /// Does what [`SphereTree::occluded`] does, for almost all rays.
    #[inline(always)]
    pub(super) fn occluded_plain(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        t_max: f64,
    ) -> Option<bool> {
        if t_max.is_nan() {
            return None;
        }
        let (ray, shrink) = self.plain_ray(origin, direction)?;
        ray.occluded(self.tree(), t_max * self.scale[0] * f64::from(shrink.recip()))
    }
}
