//! Parameters of BSDFs, in rows.
//!
//! Every material has a `#[repr(C)]` struct of single-precision numbers. Rows of lanes pick its fields by
//! their offsets.

use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::vec3::Vec3;
use bytemuck::Pod;

/// A source of the parameters of a row of materials. A trait, since a closure might not be inlined, and
/// rows would then pass through memory.
pub trait Params<L: Lanes> {
    /// Returns the number at an offset, in bytes, of each material's parameters.
    fn float(&self, offset: usize) -> L;

    /// Returns the color at an offset, in bytes, of each material's parameters.
    #[inline(always)]
    fn color(&self, offset: usize) -> Vec3<L> {
        let channel = |i: usize| self.float(offset + i * size_of::<f32>());
        Vec3::new(channel(0), channel(1), channel(2))
    }
}

/// Returns the numbers of a material's parameters.
#[inline(always)]
pub fn floats<P: Pod>(params: &P) -> &[f32] {
    bytemuck::cast_slice(std::slice::from_ref(params))
}

/// The parameters of one material, in every lane.
pub struct BroadcastParams<P>(pub P);

impl<L: Lanes, P: Pod> Params<L> for BroadcastParams<P> {
    #[inline(always)]
    fn float(&self, offset: usize) -> L {
        L::splat(floats(&self.0)[offset / size_of::<f32>()])
    }
}

/// The parameters of sixteen materials.
pub struct GatheredParams<P>(pub [P; MAX_LANES]);

impl<P: Pod> Params<F32x16> for GatheredParams<P> {
    #[inline(always)]
    fn float(&self, offset: usize) -> F32x16 {
        let mut row = [0.0; MAX_LANES];
        for (lane, params) in row.iter_mut().zip(&self.0) {
            *lane = floats(params)[offset / size_of::<f32>()];
        }
        F32x16::new(row)
    }
}
