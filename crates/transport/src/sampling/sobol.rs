//! Owen-scrambled Sobol points, four dimensions at a time.
//!
//! The points are those of [`sobol_burley::sample_4d`]: Burley, "Practical Hash-based Owen Scrambling",
//! JCGT 2020. The crate's loop over the bits of the index has an unpredictable end when paths
//! alternate, which costs more than the arithmetic. Here the index, shuffled once per path, is looked
//! up by nibbles: the same sum of direction vectors, without a branch.

use crate::lanes::{F32x16, U32x16, look_up, reverse_bits};
use sobol_burley::NUM_DIMENSION_SETS_4D;
use sobol_burley::parts::{Int4, hash, hash_int4};
use sobol_burley::parts::{owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev};
use std::fmt;
use std::sync::LazyLock;

/// Number of bits of an index: the tables of direction vectors end after 2^16 points.
const INDEX_BITS: u32 = 16;

/// For each nibble of the index, from the lowest bits on, the sum of its direction vectors by value.
type Nibbles = [[Int4; 16]; 4];

/// The same for a row of paths: a lookup table by dimension and nibble.
type RowNibbles = [[U32x16; 4]; 4];

static TABLE: LazyLock<Vec<Nibbles>> =
    LazyLock::new(|| (0..NUM_DIMENSION_SETS_4D).map(tabulate).collect());

static ROW_TABLE: LazyLock<Vec<RowNibbles>> =
    LazyLock::new(|| TABLE.iter().map(by_dimension).collect());

/// Sums of direction vectors for all sets of dimensions: 64 KiB for single paths and as much for rows
/// of paths. A path uses 1 KiB per set.
#[derive(Clone, Copy)]
pub(super) struct Sobol {
    sets: &'static [Nibbles],
    row_sets: &'static [RowNibbles],
}

/// The position of a point in a scrambled sequence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shuffled(pub(super) u32);

impl Sobol {
    pub(super) fn new() -> Self {
        Self { sets: &TABLE, row_sets: &ROW_TABLE }
    }

    /// Returns the sums of direction vectors: for each set and nibble, by value.
    pub(super) fn table(&self) -> impl Iterator<Item = [u32; 4]> {
        self.sets.iter().flatten().flatten().map(|&sums| sums.into())
    }

    /// Returns four numbers in [0, 1), multiples of 2^-23, of the sequence of `seed`; `None` beyond its
    /// 256 dimensions. The position must have been shuffled by the same seed.
    #[inline]
    pub(super) fn draw4(&self, position: Shuffled, set: u32, seed: u32) -> Option<[f32; 4]> {
        self.sets.get(set as usize).map(|nibbles| scrambled(nibbles, position, set, seed))
    }

    /// [`Sobol::draw4`] for a row of positions, each with its seed.
    #[inline(always)]
    pub(super) fn draw4_row(
        &self,
        positions: U32x16,
        set: u32,
        seeds: U32x16,
    ) -> Option<[F32x16; 4]> {
        self.row_sets.get(set as usize).map(|nibbles| scrambled_row(nibbles, positions, set, seeds))
    }

    /// Returns the first two dimensions of the sequence of `seed`, at an index below 2^16.
    #[inline]
    pub(super) fn pair(&self, index: u32, seed: u32) -> [f32; 2] {
        let [u, v, ..] = scrambled(&self.sets[0], shuffle(index, seed), 0, seed);
        [u, v]
    }
}

#[inline]
fn scrambled(nibbles: &Nibbles, position: Shuffled, set: u32, seed: u32) -> [f32; 4] {
    let mut sum = Int4::from([0; 4]);
    for (i, table) in nibbles.iter().enumerate() {
        sum ^= table[(position.0 >> (4 * i) & 15) as usize];
    }
    let mut scramble = Int4::from(DIMENSIONS);
    scramble ^= [seed.wrapping_mul(0x9c8f_2d3b) ^ set; 4].into();
    owen_scramble_int4_rev(sum, hash_int4(scramble)).reverse_bits().to_f32_norm()
}

/// Burley's constants, which distinguish the four dimensions of a set.
const DIMENSIONS: [u32; 4] = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8];

#[inline(always)]
fn scrambled_row(nibbles: &RowNibbles, positions: U32x16, set: u32, seeds: U32x16) -> [F32x16; 4] {
    let seeds = (seeds * U32x16::splat(0x9c8f_2d3b)) ^ U32x16::splat(set);
    let [a, b, c, d] = nibbles;
    // Not `map`, whose closure may become a call that passes rows through memory.
    [
        dimension_row(a, positions, seeds ^ U32x16::splat(DIMENSIONS[0])),
        dimension_row(b, positions, seeds ^ U32x16::splat(DIMENSIONS[1])),
        dimension_row(c, positions, seeds ^ U32x16::splat(DIMENSIONS[2])),
        dimension_row(d, positions, seeds ^ U32x16::splat(DIMENSIONS[3])),
    ]
}

#[inline(always)]
fn dimension_row([a, b, c, d]: &[U32x16; 4], positions: U32x16, seeds: U32x16) -> F32x16 {
    let sum = look_up(*a, positions)
        ^ look_up(*b, positions >> 4)
        ^ look_up(*c, positions >> 8)
        ^ look_up(*d, positions >> 12);
    norm_row(reverse_bits(owen_scramble_row(sum, hash_row(seeds))))
}

/// [`hash`] for a row.
#[inline(always)]
fn hash_row(mut n: U32x16) -> U32x16 {
    n ^= U32x16::splat(0xe6fe_3beb);
    n ^= n >> 16;
    n *= U32x16::splat(0x7feb_352d);
    n ^= n >> 15;
    n *= U32x16::splat(0x846c_a68b);
    n ^ n >> 16
}

/// [`owen_scramble_rev`] for a row.
#[inline(always)]
fn owen_scramble_row(mut n: U32x16, scramble: U32x16) -> U32x16 {
    n ^= n * U32x16::splat(0x3d20_adea);
    n += scramble;
    n *= scramble >> 16 | U32x16::splat(1);
    n ^= n * U32x16::splat(0x0552_6c56);
    n ^ (n * U32x16::splat(0x53a2_2864))
}

/// Converts the upper 23 bits to numbers in [0, 1), as [`Int4::to_f32_norm`].
#[inline(always)]
fn norm_row(bits: U32x16) -> F32x16 {
    let from_one: F32x16 = bytemuck::cast(bits >> 9 | U32x16::splat(1.0_f32.to_bits()));
    from_one - F32x16::splat(1.0)
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

/// [`shuffle`] for the indices from `first` on, which must be in one block.
#[inline(always)]
pub(super) fn shuffle_from(first: u32, seed: u32) -> U32x16 {
    let indices = U32x16::new(std::array::from_fn(|i| first + i as u32));
    let scramble = U32x16::splat(hash(seed ^ 0x79c6_8e4a));
    owen_scramble_row(reverse_bits(indices), scramble) >> INDEX_BITS
}

/// [`shuffle`] for a row of indices, each with its seed.
#[inline(always)]
pub(super) fn shuffle_row(indices: U32x16, seeds: U32x16) -> U32x16 {
    let scramble = hash_row(seeds ^ U32x16::splat(0x79c6_8e4a));
    owen_scramble_row(reverse_bits(indices), scramble) >> INDEX_BITS
}

/// Splits a position into the number of its block of 2^16 points and its index there.
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

fn by_dimension(nibbles: &Nibbles) -> RowNibbles {
    std::array::from_fn(|dimension| {
        nibbles.map(|table| U32x16::new(table.map(|sums| <[u32; 4]>::from(sums)[dimension])))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::MAX_LANES;
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
    fn rows_are_what_their_lanes_are() {
        let sobol = Sobol::new();
        for (row, set) in [0, 1, 2, 30, NUM_DIMENSION_SETS_4D - 1].into_iter().enumerate() {
            let seeds: [u32; MAX_LANES] =
                std::array::from_fn(|lane| hash((MAX_LANES * row + lane) as u32));
            let positions = seeds.map(|seed| shuffle(seed >> INDEX_BITS, seed));
            let lanes = U32x16::new(positions.map(|position| position.0));
            let rows = sobol
                .draw4_row(lanes, set, U32x16::new(seeds))
                .map(|row| row.map(wide::f32x16::to_array));
            for lane in 0..MAX_LANES {
                let one = sobol.draw4(positions[lane], set, seeds[lane]);
                assert_eq!(rows.map(|rows| rows.map(|row| row[lane])), one);
            }
        }
        let each = std::array::from_fn(|i| shuffle(65_520 + i as u32, 7).0);
        assert_eq!(shuffle_from(65_520, 7).to_array(), each);
    }

    #[test]
    fn dimensions_are_limited() {
        let (sobol, zero) = (Sobol::new(), U32x16::splat(0));
        assert_eq!(sobol.draw4(shuffle(0, 0), NUM_DIMENSION_SETS_4D, 0), None);
        assert!(sobol.draw4_row(zero, NUM_DIMENSION_SETS_4D, zero).is_none());
    }

    #[test]
    fn blocks_follow_one_another() {
        assert_eq!(block(65_535), (0, 65_535));
        assert_eq!(block(65_536), (1, 0));
        assert_eq!(block(u64::from(u32::MAX) + 2), (1 << 16, 1));
    }
}
