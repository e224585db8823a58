//! Parameters of materials, in rows.

use super::Material;
use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::vec3::Vec3;

/// A source of the parameters of a row of materials. A trait, since a closure might not be inlined, and
/// rows would then pass through memory.
pub trait Params<L: Lanes> {
    /// Returns parameter `i` of each material.
    fn row(&self, i: usize) -> L;

    /// Returns parameters `i..i + 3` of each material.
    #[inline(always)]
    fn color(&self, i: usize) -> Vec3<L> {
        Vec3::new(self.row(i), self.row(i + 1), self.row(i + 2))
    }
}

/// The parameters of one material, in every lane.
pub struct BroadcastParams<'a, M>(pub &'a M);

impl<L: Lanes, M: Material> Params<L> for BroadcastParams<'_, M> {
    #[inline(always)]
    fn row(&self, i: usize) -> L {
        L::splat(self.0.param(i))
    }
}

/// The parameters of sixteen materials.
pub struct GatheredParams<'a, M>(pub &'a [M; MAX_LANES]);

impl<M: Material> Params<F32x16> for GatheredParams<'_, M> {
    #[inline(always)]
    fn row(&self, i: usize) -> F32x16 {
        let mut row = [0.0; MAX_LANES];
        row.iter_mut().zip(self.0).for_each(|(lane, material)| *lane = material.param(i));
        F32x16::new(row)
    }
}
