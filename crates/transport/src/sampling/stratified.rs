//! Stratified points: one at random in each cell of a grid, with the cells in shuffled order.

use super::hash::{ONE_BELOW, stream, unit_pair};
use crate::lanes::F32x16;

/// A partition of the unit square into cells of equal area, as near to squares as their number allows.
///
/// The number of columns is the square root of the number of cells, rounded down. Cells are divided
/// equally among columns; the remainder is distributed over the first columns. The width of a column is
/// proportional to its cells. So 16 cells are 4 x 4, 12 are 3 columns of 4, and 7 are a column of 4,
/// 4/7 wide, beside one of 3: every number of samples is stratified in both dimensions, including
/// primes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strata {
    count: u32,
    /// Number of cells in the taller columns, which come first.
    in_taller: u32,
    /// The columns with one cell more.
    taller: Column,
    lower: Column,
    /// Width of a column per cell.
    width: f64,
}

/// A column of cells.
#[derive(Clone, Copy, Debug)]
struct Column {
    rows: f64,
    height: f64,
}

impl Strata {
    /// Creates `count` cells; 0 counts as 1.
    pub(super) fn new(count: u32) -> Self {
        let count = count.max(1);
        let columns = count.isqrt();
        let rows = count / columns;
        let column = |rows| Column { rows: f64::from(rows), height: f64::from(rows).recip() };
        Self {
            count,
            in_taller: count % columns * (rows + 1),
            taller: column(rows + 1),
            lower: column(rows),
            width: f64::from(count).recip(),
        }
    }

    /// Number of cells.
    pub(super) fn count(&self) -> u32 {
        self.count
    }

    /// Returns point `index`, below [`Strata::count`], of the set of a key: over all indices, every
    /// cell has exactly one point.
    #[inline]
    pub(super) fn point(&self, index: u32, key: u64) -> [f32; 2] {
        let cell = permute(index, self.count, key);
        self.jitter(cell, unit_pair(stream(key, u64::from(index))))
    }

    /// Returns a random point of cell `index`, from 0, of the set of a key; cells from
    /// [`Strata::count`] on belong to further sets.
    #[inline]
    pub(super) fn in_cell(&self, index: u32, key: u64) -> [f32; 2] {
        let key = stream(key, u64::from(index));
        self.jitter(if index < self.count { index } else { index % self.count }, unit_pair(key))
    }

    /// [`Strata::in_cell`] from cell `first` on; lanes past the last cell are undefined.
    #[inline(always)]
    pub(super) fn in_cells(&self, first: u32, key: u64) -> [F32x16; 2] {
        let mut rows = [[0.0; 16]; 2];
        for lane in 0..16 {
            let index = first.wrapping_add(lane);
            let point = self.jitter(index, unit_pair(stream(key, u64::from(index))));
            (rows[0][lane as usize], rows[1][lane as usize]) = (point[0], point[1]);
        }
        rows.map(F32x16::new)
    }

    /// Returns a point in a cell, without division or branch. The column is exact: before rounding
    /// down, the value is half a cell away from an integer, far more than the rounding error.
    #[inline(always)]
    fn jitter(&self, cell: u32, [u, v]: [f32; 2]) -> [f32; 2] {
        let tall = cell < self.in_taller;
        let rows = if tall { self.taller.rows } else { self.lower.rows };
        let height = if tall { self.taller.height } else { self.lower.height };
        let start = if tall { 0.0 } else { f64::from(self.in_taller) };
        let cell = f64::from(cell);
        let first = start + ((cell - start + 0.5) * height).floor() * rows;
        let x = (first + rows * f64::from(u)) * self.width;
        let y = (cell - first + f64::from(v)) * height;
        [(x as f32).min(ONE_BELOW), (y as f32).min(ONE_BELOW)]
    }
}

/// Returns the image of `index` under a pseudo-random permutation of `0..length`, chosen by `key`,
/// without a table.
///
/// Kensler, "Correlated Multi-Jittered Sampling", Pixar Technical Memo 13-01, 2013: a hash that is
/// one-to-one on the enclosing power of two, repeated until it is in range.
#[inline]
fn permute(mut index: u32, length: u32, key: u64) -> u32 {
    let mask = length.next_power_of_two() - 1;
    loop {
        index = scramble(index, mask, key as u32);
        if index < length {
            break;
        }
    }
    // A rotation by a number below the length, from the other half of the key.
    let turned = u64::from(index) + (((key >> 32) * u64::from(length)) >> 32);
    (if turned < u64::from(length) { turned } else { turned - u64::from(length) }) as u32
}

/// One round of Kensler's hash, one-to-one on `0..=mask`.
#[inline]
fn scramble(mut i: u32, mask: u32, key: u32) -> u32 {
    i = (i ^ key).wrapping_mul(0xe170_893d);
    i ^= key >> 16;
    i ^= (i & mask) >> 4;
    i = (i ^ (key >> 8)).wrapping_mul(0x0929_eb3f);
    i ^= key >> 23;
    i ^= (i & mask) >> 1;
    i = i.wrapping_mul(1 | (key >> 27)).wrapping_mul(0x6935_fa69);
    i ^= (i & mask) >> 11;
    i = i.wrapping_mul(0x74dc_b303);
    i ^= (i & mask) >> 2;
    i = i.wrapping_mul(0x9e50_1cc3);
    i ^= (i & mask) >> 2;
    i = i.wrapping_mul(0xc860_a3df) & mask;
    i ^ (i >> 5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::hash::mix;
    use crate::sampling::statistics::assert_chi_squared;

    fn stratified_pair(index: u32, count: u32, key: u64) -> [f32; 2] {
        Strata::new(count).point(index, key)
    }

    #[test]
    fn permutations_are_one_to_one() {
        for length in [1, 2, 3, 7, 12, 16, 100, 257, 1024] {
            for key in [0, 1, 0xdead_beef, u64::MAX] {
                let mut images: Vec<u32> = (0..length).map(|i| permute(i, length, key)).collect();
                images.sort_unstable();
                assert!(images.into_iter().eq(0..length), "{length} {key}");
            }
        }
    }

    /// Compiled from the C code of Kensler's memo, the function `permute` there rotates by the whole
    /// key.
    #[test]
    fn permutations_are_those_of_the_memo() {
        let truths = [
            (12, 0xdead_beef_u32, [4, 9, 0, 3, 10, 8]),
            (1000, 0x0000_0001, [998, 803, 104, 663, 527, 857]),
            (1000, 0x5163_3e2d, [226, 630, 892, 82, 403, 495]),
            (1 << 20, 0xdead_beef, [900_072, 542_096, 492_225, 811_299, 607_727, 1_002_318]),
            (1 << 20, 0x5163_3e2d, [840_458, 911_152, 866_104, 254_205, 84_371, 711_801]),
        ];
        for (length, key, truth) in truths {
            let images: [u32; 6] = std::array::from_fn(|i| {
                let turned = permute(i as u32 * (length / 6), length, u64::from(key));
                ((u64::from(turned) + u64::from(key)) % u64::from(length)) as u32
            });
            assert_eq!(images, truth, "{length} {key:#x}");
        }
    }

    #[test]
    fn every_index_is_mapped_to_all() {
        const LENGTH: u32 = 12;
        for index in 0..LENGTH {
            let mut observed = vec![0_u64; LENGTH as usize];
            for key in 0..6000 {
                observed[permute(index, LENGTH, mix(key)) as usize] += 1;
            }
            assert_chi_squared(&observed, &[1.0 / f64::from(LENGTH); LENGTH as usize]);
        }
    }

    #[test]
    fn grids_of_products_have_one_point_per_cell() {
        for (columns, rows) in [(4, 4), (3, 4), (1, 1), (1, 2), (4, 5), (16, 16)] {
            let count = columns * rows;
            let mut cells: Vec<u32> = (0..count)
                .map(|index| stratified_pair(index, count, mix(u64::from(count))))
                .map(|[u, v]| (u * columns as f32) as u32 * rows + (v * rows as f32) as u32)
                .collect();
            cells.sort_unstable();
            assert!(cells.into_iter().eq(0..count), "{columns} x {rows}");
        }
    }

    #[test]
    fn primes_are_stratified_in_both_dimensions() {
        // Seven cells: a column of four that is 4/7 wide, and one of three.
        let points = (0..7).map(|index| stratified_pair(index, 7, mix(3)));
        let (left, right): (Vec<_>, Vec<_>) = points.partition(|[u, _]| *u < 4.0 / 7.0);
        for (column, rows) in [(left, 4), (right, 3)] {
            let mut cells: Vec<u32> =
                column.into_iter().map(|[_, v]| (v * rows as f32) as u32).collect();
            cells.sort_unstable();
            assert!(cells.into_iter().eq(0..rows));
        }
    }

    #[test]
    fn every_point_of_a_set_is_uniform_over_keys() {
        for count in [7, 12] {
            let mut observed = vec![0_u64; 49];
            for key in 0..40_000 {
                let [u, v] = stratified_pair(2, count, mix(key));
                observed[(u * 7.0) as usize * 7 + (v * 7.0) as usize] += 1;
            }
            assert_chi_squared(&observed, &[1.0 / 49.0; 49]);
        }
    }

    #[test]
    fn corner_cells_stay_below_one() {
        for count in [1, 3, 7, 16, 1_000_003] {
            let strata = Strata::new(count);
            let [u, v] = strata.jitter(count - 1, [ONE_BELOW; 2]);
            assert!(u < 1.0 && v < 1.0, "{count}");
        }
    }

    #[test]
    fn further_cells_are_of_another_set() {
        let strata = Strata::new(16);
        let (first, further) = (strata.in_cell(3, mix(1)), strata.in_cell(19, mix(1)));
        assert_ne!(first, further);
        let cell = |[u, v]: [f32; 2]| ((u * 4.0) as u32, (v * 4.0) as u32);
        assert_eq!(cell(first), cell(further));
        for index in 0..16 {
            let [first, further] = [index, index + 16].map(|index| strata.in_cell(index, mix(2)));
            assert_eq!(cell(first), cell(further), "{index}");
        }
        let [u, v] = Strata::new(0).in_cell(u32::MAX, mix(1));
        assert!((0.0..1.0).contains(&u) && (0.0..1.0).contains(&v));
    }
}
