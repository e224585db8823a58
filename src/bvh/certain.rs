//! Hits that single precision is sure of, until their distances are computed.
//!
//! Centers and radii are kept where they were tested: to gather them again from the tree's leaves, lane
//! by lane, would take longer than all the arithmetic on them.

use crate::lanes::{Lanes, bits};
use crate::ray::MISS;
use crate::vec3::Vec3;

/// What rays in a row hit for certain, though the hits do not know of it yet.
#[derive(Clone, Copy)]
pub(super) struct Certain<L> {
    /// The bits of the sphere; [`MISS`] where there is none, and the rest has no meaning.
    pub(super) sphere: L,
    pub(super) center: Vec3<L>,
    pub(super) radius: L,
}

impl<L: Lanes> Certain<L> {
    /// Nothing is hit.
    #[inline(always)]
    pub(super) fn none() -> Self {
        let zero = L::splat(0.0);
        Self { sphere: bits(MISS), center: Vec3::new(zero, zero, zero), radius: zero }
    }

    /// The lanes in which there is a sphere.
    #[inline(always)]
    pub(super) fn there(&self) -> L::Mask {
        !self.sphere.has_bits_of(bits(MISS))
    }

    /// `yes` where `mask` is true, `no` elsewhere.
    #[inline(always)]
    pub(super) fn select(mask: L::Mask, yes: &Self, no: &Self) -> Self {
        let select = |yes, no| L::select(mask, yes, no);
        let (a, b) = (yes.center, no.center);
        Self {
            sphere: select(yes.sphere, no.sphere),
            center: Vec3::new(select(a.x, b.x), select(a.y, b.y), select(a.z, b.z)),
            radius: select(yes.radius, no.radius),
        }
    }
}
