//! Hashing of counters into random bits, and of bits into numbers in [0, 1).
//!
//! The hash is `SplitMix64` used as a counter-based generator: Steele, Lea & Flood, "Fast
//! Splittable Pseudorandom Number Generators", OOPSLA 2014, with the finalizer "variant 13" of
//! Stafford's "Better Bit Mixing", 2011.

/// The odd 64-bit integer nearest to 2^64 divided by the golden ratio: the increment of
/// `SplitMix64`.
const GOLDEN_GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;

/// The largest `f32` below 1, 1 - 2^-24, to which draws are clamped that would round to 1.
pub const ONE_BELOW: f32 = 1.0 - f32::EPSILON / 2.0;

/// Mixes bits one-to-one: every input bit flips each output bit about half of the time.
#[inline]
pub const fn mix(mut bits: u64) -> u64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// Returns output number `position` (from 0) of the generator `SplitMix64` that is seeded with `key`.
///
/// Outputs of one key are distinct. Keys should be hashes themselves: the streams of two keys that
/// differ by a multiple of the generator's increment overlap.
#[inline]
pub const fn stream(key: u64, position: u64) -> u64 {
    mix(key.wrapping_add(position.wrapping_add(1).wrapping_mul(GOLDEN_GAMMA)))
}

/// Converts the upper 24 bits exactly to a multiple of 2^-24 in [0, 1); all values are equally likely.
#[inline]
pub const fn unit(bits: u32) -> f32 {
    const STEP: f32 = 1.0 / (1_u32 << 24) as f32;
    (bits >> 8) as f32 * STEP
}

/// Converts both halves of a hash to numbers in [0, 1).
#[inline]
pub const fn unit_pair(bits: u64) -> [f32; 2] {
    [unit((bits >> 32) as u32), unit(bits as u32)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::assert_chi_squared;
    use rand_xoshiro::SplitMix64;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    #[test]
    fn the_stream_is_splitmix64() {
        for key in [0, 1, 0x0123_4567_89ab_cdef, u64::MAX] {
            let mut reference = SplitMix64::seed_from_u64(key);
            for position in 0..8 {
                assert_eq!(stream(key, position), reference.next_u64());
            }
        }
    }

    #[test]
    fn extremes_of_the_unit_interval() {
        assert_eq!(unit(0), 0.0);
        assert_eq!(unit(0xff), 0.0);
        assert_eq!(unit(0x100), f32::EPSILON / 2.0);
        assert_eq!(unit(u32::MAX), ONE_BELOW);
        assert_eq!(ONE_BELOW, 1.0_f32.next_down());
    }

    #[test]
    fn neighboring_counters_give_uniform_pairs() {
        let mut observed = vec![0_u64; 256];
        for position in 0..65_536 {
            let [u, v] = unit_pair(stream(mix(7), position));
            observed[(u * 16.0) as usize * 16 + (v * 16.0) as usize] += 1;
        }
        assert_chi_squared(&observed, &[1.0 / 256.0; 256]);
    }

    #[test]
    fn every_input_bit_flips_half_of_the_output() {
        for bit in 0..64 {
            let flipped: u32 = (0..256_u64)
                .map(|i| (mix(stream(1, i)) ^ mix(stream(1, i) ^ (1 << bit))).count_ones())
                .sum();
            let mean = f64::from(flipped) / 256.0;
            // Standard deviation of the mean of 256 counts of 64 fair bits: 4 / 16.
            assert!((mean - 32.0).abs() < 5.0 * 0.25, "bit {bit}: {mean}");
        }
    }
}
