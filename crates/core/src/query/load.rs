//! Loads rays sixteen at a time: a power of two scales them to the tree's units, and single precision must
//! hold the result exactly.

use super::batch::CHUNK;
use super::scaled_ray::REACH;
use super::{RayColumns, SphereTree};
use crate::lanes::{F32x16, Lanes, Mask};
use crate::ray::Rays;
use std::ops::Range;

/// Number of rays that are loaded together.
pub(super) const PACKET: usize = F32x16::WIDTH;

/// No direction with a larger coordinate than this, or none larger than its reciprocal, is plain.
const LONGEST: f32 = (1_u128 << 100) as f32;

/// Rays in the units of the tree.
pub(super) struct LoadedRays {
    /// By packet, whether single precision holds its rays.
    pub(super) packets: [bool; CHUNK / PACKET],
    /// By ray, the power of two that its direction was multiplied by.
    pub(super) shrink: [f32; CHUNK],
    /// The reciprocals of `shrink`.
    pub(super) stretch: [f32; CHUNK],
}

impl SphereTree {
    /// Appends some rays in the tree's units, and tells which are plain: all that they are fits single
    /// precision, and they start no farther than [`REACH`].
    pub(super) fn load(
        &self,
        columns: &RayColumns,
        rows: Range<usize>,
        rays: &mut Rays,
    ) -> LoadedRays {
        let mut plain = LoadedRays {
            packets: [false; CHUNK / PACKET],
            shrink: [1.0; CHUNK],
            stretch: [1.0; CHUNK],
        };
        let scale = self.scale as f32;
        let scalable = f64::from(scale) == self.scale && scale.is_normal();
        for (packet, first) in rows.clone().step_by(PACKET).enumerate() {
            let lanes = PACKET.min(rows.end - first);
            let column = |x: &[f32], rest: f32| {
                let mut row = [rest; PACKET];
                row[..lanes].copy_from_slice(&x[first..first + lanes]);
                F32x16::new(row)
            };
            let origin = columns.origin.map(|x| column(x, 0.0));
            let direction = columns.direction.map(|x| column(x, 1.0));
            let [x, y, z] = direction.map(Lanes::abs);
            let longest = Lanes::max(Lanes::max(x, y), z);
            let shrink = longest.to_array().map(reciprocal_power);
            plain.shrink[packet * PACKET..][..PACKET].copy_from_slice(&shrink);
            let stretch = F32x16::splat(1.0) / F32x16::new(shrink);
            stretch.store(&mut plain.stretch[packet * PACKET..]);
            let moved = origin.map(|x| x * F32x16::splat(scale));
            let turned = direction.map(|x| x * F32x16::new(shrink));
            let mut all =
                F32x16::splat(LONGEST.recip()).le(longest) & longest.le(F32x16::splat(LONGEST));
            for axis in 0..3 {
                all = all & is_exact(moved[axis], origin[axis]);
                all = all & is_exact(turned[axis], direction[axis]);
                all = all & Lanes::abs(moved[axis]).le(F32x16::splat(REACH as f32));
            }
            plain.packets[packet] = scalable && all.bits() == u32::from(u16::MAX);
            rays.append(lanes, &moved, &turned);
        }
        plain
    }
}

/// The reciprocal of the largest power of two that is not above a number within [`LONGEST`].
fn reciprocal_power(x: f32) -> f32 {
    const EXPONENT: u32 = 0xff << 23;
    f32::from_bits((254_u32 << 23).wrapping_sub(x.to_bits() & EXPONENT))
}

/// The lanes in which multiplication by a power of two has not underflowed.
fn is_exact(product: F32x16, of: F32x16) -> <F32x16 as Lanes>::Mask {
    let zero = F32x16::splat(0.0);
    F32x16::splat(f32::MIN_POSITIVE).le(Lanes::abs(product)) | Lanes::abs(of).le(zero)
}
