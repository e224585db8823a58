//! Places on Morton curves, and sorting by such keys, digit by digit.

use std::ops::{BitAnd, BitOr, Shl};

/// Bits that are sorted by in one pass.
pub(crate) const DIGIT: u32 = 11;

/// Sorts keys by the bits from `first` on, in `passes` passes of [`DIGIT`] bits; keys that agree in these stay in
/// their order. A pass in which all keys agree is left out. `spare` is memory, whatever is in it.
pub(crate) fn sort_by_digits(keys: &mut Vec<u64>, spare: &mut Vec<u64>, first: u32, passes: u32) {
    for shift in (first..).step_by(DIGIT as usize).take(passes as usize) {
        let digit = |key: u64| (key >> shift) as usize % (1 << DIGIT);
        let mut places = [0_u32; 1 << DIGIT];
        for &key in &*keys {
            places[digit(key)] += 1;
        }
        if keys.first().is_none_or(|&key| places[digit(key)] as usize == keys.len()) {
            continue;
        }
        let mut below = 0;
        for place in &mut places {
            below += std::mem::replace(place, below);
        }
        spare.resize(keys.len(), 0);
        for &key in &*keys {
            let place = &mut places[digit(key)];
            spare[*place as usize] = key;
            *place += 1;
        }
        std::mem::swap(keys, spare);
    }
}

/// The lowest ten bits with two zeros above each: one of three coordinates of a place on a Morton curve. Of a number,
/// or of numbers in lanes.
#[inline(always)]
pub(crate) fn spaced<N>(x: N) -> N
where
    N: Copy + BitOr<Output = N> + BitAnd<Output = N> + Shl<u32, Output = N> + From<u32>,
{
    let step = |x: N, shift: u32, mask: u32| (x | x << shift) & N::from(mask);
    let x = step(step(x, 16, 0x0300_00ff), 8, 0x0300_f00f);
    step(step(x, 4, 0x030c_30c3), 2, 0x0924_9249)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn keys_are_sorted_by_their_digits_alone() {
        for (mask, passes) in [(u64::MAX, 2), (u64::MAX, 3), (0xff_ffff_ffff, 3), (7, 1)] {
            let mut random = Random::new(1);
            let mut key = || (random.unit() * (1_u64 << 60) as f64) as u64 & mask;
            let mut keys: Vec<u64> = (0..5000).map(|_| key()).collect();
            let mut sorted = keys.clone();
            let digits = |key: &u64| (key >> 20) % (1 << (DIGIT * passes));
            sorted.sort_by_key(digits);
            sort_by_digits(&mut keys, &mut Vec::new(), 20, passes);
            assert!(keys == sorted, "{mask:x} {passes}");
        }
        sort_by_digits(&mut Vec::new(), &mut Vec::new(), 0, 3);
    }
}
