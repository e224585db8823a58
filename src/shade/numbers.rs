//! The numbers of materials, in rows.

use super::Material;
use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::vec3::Vec3;

/// What tells the numbers of a row of materials: a closure might be a call, through which rows
/// would go by way of memory.
pub trait Numbers<L: Lanes> {
    /// Number `i` of each.
    fn row(&self, i: usize) -> L;

    /// Numbers `i..i + 3` of each.
    #[inline(always)]
    fn color(&self, i: usize) -> Vec3<L> {
        Vec3::new(self.row(i), self.row(i + 1), self.row(i + 2))
    }
}

/// The numbers of one material, in every lane.
pub struct One<'a, M>(pub &'a M);

impl<L: Lanes, M: Material> Numbers<L> for One<'_, M> {
    #[inline(always)]
    fn row(&self, i: usize) -> L {
        L::splat(self.0.number(i))
    }
}

/// The numbers of sixteen materials.
pub struct Each<'a, M>(pub &'a [M; MAX_LANES]);

impl<M: Material> Numbers<F32x16> for Each<'_, M> {
    #[inline(always)]
    fn row(&self, i: usize) -> F32x16 {
        let mut row = [0.0; MAX_LANES];
        row.iter_mut().zip(self.0).for_each(|(lane, material)| *lane = material.number(i));
        F32x16::new(row)
    }
}
