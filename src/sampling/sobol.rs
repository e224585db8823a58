//! Owen-scrambled Sobol points, four dimensions at a time.
//!
//! The points are those of [`sobol_burley::sample_4d`]: Burley, "Practical Hash-based Owen
//! Scrambling", JCGT 2020. Its loop over the bits of the index ends at a place that the processor
//! cannot foresee when paths take turns, which costs more than the arithmetic. Here the index,
//! shuffled once per path, is looked up by nibbles: the same sum of direction vectors, without a
//! branch.

use sobol_burley::NUM_DIMENSION_SETS_4D;
use sobol_burley::parts::{Int4, hash, hash_int4};
use sobol_burley::parts::{owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev};
use std::fmt;
use std::sync::LazyLock;

/// The tables of direction vectors end after 2^16 points.
const INDEX_BITS: u32 = 16;

/// For each nibble of the index, from its last bits on, the sum of its direction vectors by value.
type Nibbles = [[Int4; 16]; 4];

static TABLE: LazyLock<Vec<Nibbles>> =
    LazyLock::new(|| (0..NUM_DIMENSION_SETS_4D).map(tabulate).collect());

/// Sums of direction vectors for every set of dimensions: 64 KiB, of which a path uses 1 KiB per
/// set.
#[derive(Clone, Copy)]
pub(super) struct Sobol {
    sets: &'static [Nibbles],
}

/// The place of a point in a scrambled sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shuffled(u32);

impl Sobol {
    pub(super) fn new() -> Self {
        Self { sets: &TABLE }
    }

    /// Four numbers in [0, 1), multiples of 2^-23, of the sequence that belongs to `seed`; `None`
    /// beyond its 256 dimensions. The place must have been shuffled by the same seed.
    #[inline]
    pub(super) fn draw4(&self, place: Shuffled, set: u32, seed: u32) -> Option<[f32; 4]> {
        self.sets.get(set as usize).map(|nibbles| scrambled(nibbles, place, set, seed))
    }

    /// The first two dimensions of the sequence that belongs to `seed`, at an index below 2^16.
    #[inline]
    pub(super) fn pair(&self, index: u32, seed: u32) -> [f32; 2] {
        let [u, v, ..] = scrambled(&self.sets[0], shuffle(index, seed), 0, seed);
        [u, v]
    }
}

#[inline]
fn scrambled(nibbles: &Nibbles, place: Shuffled, set: u32, seed: u32) -> [f32; 4] {
    let mut sum = Int4::from([0; 4]);
    for (i, table) in nibbles.iter().enumerate() {
        sum ^= table[(place.0 >> (4 * i) & 15) as usize];
    }
    let mut scramble = Int4::from([0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8]);
    scramble ^= [seed.wrapping_mul(0x9c8f_2d3b) ^ set; 4].into();
    owen_scramble_int4_rev(sum, hash_int4(scramble)).reverse_bits().to_f32_norm()
}

impl fmt::Debug for Sobol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sobol").finish_non_exhaustive()
    }
}

/// Shuffles an index below 2^16 within the sequence of `seed`; aligned blocks of 2^k indices stay
/// together.
#[inline]
pub(super) fn shuffle(index: u32, seed: u32) -> Shuffled {
    Shuffled(owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a)) >> INDEX_BITS)
}

/// Splits a position into the block of 2^16 points in which it lies, and its index there.
#[inline]
pub(super) fn block(position: u64) -> (u64, u32) {
    (position >> INDEX_BITS, position as u32 & ((1 << INDEX_BITS) - 1))
}

fn tabulate(set: u32) -> Nibbles {
    std::array::from_fn(|nibble| {
        std::array::from_fn(|value| {
            sobol_int4_rev((value as u32) << (INDEX_BITS as usize + 4 * nibble), set)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sobol_burley::sample_4d;

    #[test]
    fn the_points_are_those_of_the_crate() {
        let sobol = Sobol::new();
        for seed in [0, 1, 0xdead_beef, u32::MAX] {
            for index in (0..64).chain((64..1 << INDEX_BITS).step_by(1009)).chain([65_535]) {
                for set in [0, 1, 2, 30, NUM_DIMENSION_SETS_4D - 1] {
                    let draw = sobol.draw4(shuffle(index, seed), set, seed);
                    assert_eq!(draw, Some(sample_4d(index, set, seed)), "{seed} {index} {set}");
                }
            }
        }
    }

    #[test]
    fn dimensions_end() {
        assert_eq!(Sobol::new().draw4(shuffle(0, 0), NUM_DIMENSION_SETS_4D, 0), None);
    }

    #[test]
    fn blocks_follow_one_another() {
        assert_eq!(block(65_535), (0, 65_535));
        assert_eq!(block(65_536), (1, 0));
        assert_eq!(block(u64::from(u32::MAX) + 2), (1 << 16, 1));
    }
}
