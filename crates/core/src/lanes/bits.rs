//! Lanes that hold numbers that are no floats, and bits that stand for lanes.

use super::{Lanes, MAX_LANES};

/// A number that is no float, in every lane.
#[inline(always)]
pub fn bits<L: Lanes>(number: u32) -> L {
    L::splat(f32::from_bits(number))
}

/// The first `L::WIDTH` numbers of a column that are no floats.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub fn bits_of<L: Lanes>(column: &[u32]) -> L {
    L::load(bytemuck::cast_slice(column))
}

/// The numbers that are no floats of a row, in the first `L::WIDTH` places.
#[inline(always)]
pub fn numbers<L: Lanes>(row: L) -> [u32; MAX_LANES] {
    let mut lanes = [0.0; MAX_LANES];
    row.store(&mut lanes);
    bytemuck::cast(lanes)
}

/// The bits of the first `count` lanes, or of all if there are fewer.
#[inline(always)]
pub fn first_lanes(count: usize) -> u32 {
    ((1_u64 << count.min(MAX_LANES)) - 1) as u32
}

/// The indices of the set bits, lowest first.
#[inline(always)]
pub fn set_bits(bits: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut bits = bits.into();
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros();
        bits &= bits.wrapping_sub(1);
        (lane < u64::BITS).then_some(lane as usize)
    })
}
