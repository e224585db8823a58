//! Loads rays sixteen at a time: a power of two scales them to the tree's units, and single precision must
//! hold the result exactly.

use super::SphereTree;
use super::batch::CHUNK;
use super::chunk::{ChunkRays, RayPacket};
use crate::lanes::{F32x16, Lanes, Mask, set_bits};
use crate::ray::{Hits, MISS, Rays};
use crate::vec3::Vec3;
use glam::Vec3 as Point;

/// Number of rays that are loaded together.
pub(super) const PACKET: usize = F32x16::WIDTH;

/// No direction with a larger coordinate than this, or none larger than its reciprocal, is plain.
pub(super) const LONGEST: f32 = (1_u128 << 126) as f32;

/// Rays in the units of the tree.
pub(super) struct LoadedRays {
    /// By packet, the lanes whose rays single precision holds: a bit for each.
    pub(super) plain: [u32; CHUNK / PACKET],
    /// By ray, the power of two that its direction was multiplied by.
    pub(super) shrink: [f32; CHUNK],
}

impl SphereTree {
    /// Replaces rays and bounds by those of a chunk in the tree's units, and tells which are plain: all that they
    /// are fits single precision, they start within the tree's reach, and their bound is a number. Others get
    /// bounds at which no search begins.
    pub(super) fn load(
        &self,
        chunk: &impl ChunkRays,
        bounds: &[f64],
        rays: &mut Rays,
        hits: &mut Hits,
    ) -> LoadedRays {
        let mut loaded = LoadedRays { plain: [0; CHUNK / PACKET], shrink: [1.0; CHUNK] };
        let [scale, unscale] = self.single_scale.map(|x| F32x16::splat(x.to_array()[0]));
        let reach = F32x16::splat(self.reach.to_array()[0]);
        let mut coarse = u32::MAX;
        rays.truncate(0);
        for (packet, first) in (0..chunk.len()).step_by(PACKET).enumerate() {
            let RayPacket { origin, direction, bound } = chunk.packet(first, bounds);
            let [x, y, z] = direction.map(Lanes::abs);
            let longest = Lanes::max(Lanes::max(x, y), z);
            let shrink = longest.to_array().map(reciprocal_power);
            loaded.shrink[first..][..PACKET].copy_from_slice(&shrink);
            // The reciprocal of a power of two is one.
            let stretch = F32x16::new(shrink.map(f32::recip));
            let moved = origin.map(|x| x * scale);
            let turned = direction.map(|x| x * F32x16::new(shrink));
            let mut all =
                F32x16::splat(LONGEST.recip()).le(longest) & longest.le(F32x16::splat(LONGEST));
            for axis in 0..3 {
                all = all & is_exact(moved[axis], origin[axis], unscale);
                all = all & is_exact(turned[axis], direction[axis], stretch);
                all = all & Lanes::abs(moved[axis]).le(reach);
            }
            let (t, sphere) = (&mut hits.t[first..][..PACKET], &mut hits.sphere[first..][..PACKET]);
            sphere.fill(MISS);
            let mut numbers = 0;
            for lane in 0..PACKET {
                t[lane] = bound[lane] * self.scale[0] * f64::from(shrink[lane].recip());
                numbers |= u32::from(!bound[lane].is_nan()) << lane;
            }
            let plain = all.bits() & numbers;
            loaded.plain[packet] = plain;
            let [x, y, z] = moved;
            coarse &= Vec3::new(x, y, z).is_coarse().bits() | !plain;
            rays.append(PACKET.min(chunk.len() - first), &moved, &turned);
            // Nothing counts below 0. Such rays keep no others from being plain.
            for row in set_bits(!plain & u32::from(u16::MAX)).map(|lane| first + lane) {
                hits.t[row] = -1.0;
                rays.set(row, Point::ZERO, Point::ONE, MISS);
            }
        }
        rays.coarse = coarse & u32::from(u16::MAX) == u32::from(u16::MAX);
        loaded
    }
}

/// The reciprocal of the largest power of two that is not above a number within [`LONGEST`].
#[inline(always)]
pub(super) fn reciprocal_power(x: f32) -> f32 {
    const EXPONENT: u32 = 0xff << 23;
    f32::from_bits((254_u32 << 23).wrapping_sub(x.to_bits() & EXPONENT))
}

/// The lanes in which a product by a power of two is exact; `inverse` is that of the power.
#[inline(always)]
pub(super) fn is_exact<L: Lanes>(product: L, of: L, inverse: L) -> L::Mask {
    let back = product * inverse;
    back.le(of) & of.le(back)
}
