//! Permutations: values move from lane to lane, and bits from place to place.

use super::{F32x4, F32x8, F32x16, Lanes, U32x16, WideMask};

/// In lane `i` the greatest lane of `row[i]`; anything in the last.
#[inline(always)]
pub fn greatest_of<L: Lanes>([x, y, z]: [L; 3]) -> F32x4 {
    let z = z.greatest_four();
    let columns = F32x4::transpose([x.greatest_four(), y.greatest_four(), z, z]);
    let [a, b, c, d] = columns;
    Lanes::max(Lanes::max(a, b), Lanes::max(c, d))
}

/// In row `i` lane `first + i` of each column.
#[inline(always)]
pub fn transpose(columns: [F32x16; 8], first: usize) -> [F32x8; 8] {
    F32x8::transpose(columns.map(|column| bytemuck::cast::<_, [F32x8; 2]>(column)[(first / 8) & 1]))
}

/// In row `i` number `i` of each of sixteen rows.
#[inline(always)]
pub fn columns_of(rows: &[[f32; 8]; 16]) -> [F32x16; 8] {
    let half =
        |first: usize| F32x8::transpose(std::array::from_fn(|i| F32x8::new(rows[first + i])));
    let (low, high) = (half(0), half(8));
    std::array::from_fn(|i| bytemuck::cast([low[i], high[i]]))
}

/// The coordinates x, y and z of sixteen points.
#[inline(always)]
pub fn columns_of_points(points: &[[f32; 3]; 16]) -> [F32x16; 3] {
    let rows: &[[f32; 8]; 6] = bytemuck::cast_ref(points);
    let rows = rows.map(F32x8::new);
    // Coordinate `axis` of point `i` of eight is number `3 i + axis` of 24. So it is in lane `3 i + axis & 7` of one of three
    // rows, and no other point of the eight is in that lane.
    let half = |rows: [F32x8; 3], axis: u32| {
        let lanes = |row: u32| {
            let bit = |lane| u32::from((8 * row + lane) % 3 == axis) << lane;
            F32x8::lanes((0..8).map(bit).sum())
        };
        let [first, second, third] = rows;
        let all = Lanes::select(lanes(0), first, Lanes::select(lanes(1), second, third));
        let order = (0..8).fold(0, |order, i| order | ((3 * i + axis) & 7) << (4 * i));
        shuffle(all, order)
    };
    let [a, b, c, d, e, f] = rows;
    [0, 1, 2].map(|axis| bytemuck::cast([half([a, b, c], axis), half([d, e, f], axis)]))
}

/// The integer parts of numbers from 0 to 2^31; 0 for NaN and for numbers below 0.
#[inline(always)]
pub fn truncated(numbers: F32x16) -> U32x16 {
    bytemuck::cast(numbers.max(F32x16::splat(0.0)).trunc_int())
}

/// Puts number `order >> 4 i & 7` of a row in place `i`.
#[inline(always)]
pub fn shuffle_numbers(row: &[u32; 8], order: u32) -> [u32; 8] {
    const PLACES: wide::u32x8 = wide::u32x8::new([0, 4, 8, 12, 16, 20, 24, 28]);
    let order = wide::u32x8::splat(order) >> PLACES;
    wide::u32x8::new(*row).shuffle_wrapping(order).to_array()
}

/// Puts lane `order >> 4 i & 7` in lane `i`.
#[inline(always)]
pub fn shuffle(row: F32x8, order: u32) -> F32x8 {
    let row: [u32; 8] = bytemuck::cast(row);
    bytemuck::cast(shuffle_numbers(&row, order))
}

/// Returns the lane of the least of eight numbers that are not negative, among the lanes in which `mask` is true; of numbers
/// that differ in their last three bits only, that of the first lane. Anything if `mask` is false in all.
#[inline(always)]
pub fn least_lane(row: F32x8, mask: WideMask<F32x8>) -> usize {
    const LANES: wide::u32x8 = wide::u32x8::new([0, 1, 2, 3, 4, 5, 6, 7]);
    // Numbers that are not negative are in the order of their bits.
    let bits: wide::u32x8 = bytemuck::cast(row);
    let others: wide::u32x8 = bytemuck::cast(!mask.0);
    let keys = bits & wide::u32x8::splat(!7) | LANES | others;
    let [low, high]: [wide::u32x4; 2] = bytemuck::cast(keys);
    let [a, b, c, d] = low.min(high).to_array();
    a.min(c).min(b.min(d)) as usize & 7
}

/// For every set of eight lanes, their numbers in order, in four bits each.
static IN_ORDER: [u32; 256] = in_order();

const fn in_order() -> [u32; 256] {
    let mut table = [0; 256];
    let mut lanes = 0;
    while lanes < 256 {
        let (mut lane, mut place) = (0, 0);
        while lane < 8 {
            if lanes >> lane & 1 == 1 {
                table[lanes] |= lane << (4 * place);
                place += 1;
            }
            lane += 1;
        }
        lanes += 1;
    }
    table
}

/// Packs some of sixteen lanes one after another (stream compaction).
#[derive(Clone, Copy, Debug)]
pub struct Packing {
    /// The lane that moves to each place, in the lowest four bits.
    order: U32x16,
    /// The lanes of the lower and of the upper eight, in four bits each.
    halves: [u32; 2],
    /// Number of packed lanes of the lower eight.
    low: usize,
    count: usize,
}

impl Packing {
    /// Returns the packing of the lanes whose bits are set.
    #[inline(always)]
    pub fn new(lanes: u32) -> Self {
        const PLACES: U32x16 =
            U32x16::new([0, 4, 8, 12, 16, 20, 24, 28, 0, 4, 8, 12, 16, 20, 24, 28]);
        let halves = [lanes, lanes >> 8].map(|half| IN_ORDER[half as usize & 0xff]);
        let low = (lanes & 0xff).count_ones() as usize;
        // The upper lanes come right after those of the lower that there are.
        let upper = u64::from(halves[1] | 0x8888_8888);
        let order = u64::from(halves[0]) | upper << (4 * low);
        let words = [order as u32, (order >> 32) as u32].map(wide::u32x8::splat);
        Self {
            order: bytemuck::cast::<_, U32x16>(words) >> PLACES,
            halves,
            low,
            count: (lanes & 0xffff).count_ones() as usize,
        }
    }

    /// Number of packed lanes.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Writes the lanes to the first places of a column, and anything to the next, up to sixteen.
    ///
    /// # Panics
    /// If the column is shorter.
    #[inline(always)]
    pub fn store_numbers(&self, row: U32x16, column: &mut [u32]) {
        column[..16].copy_from_slice(&look_up(row, self.order).to_array());
    }

    /// [`Packing::store_numbers`] for floats.
    #[inline(always)]
    pub fn store(&self, row: F32x16, column: &mut [f32]) {
        self.store_numbers(bytemuck::cast(row), bytemuck::cast_slice_mut(column));
    }

    /// [`Packing::store_numbers`] for floats of double precision.
    #[inline(always)]
    pub fn store_doubles(&self, row: &[f64; 16], column: &mut [f64]) {
        const PLACES: U32x16 =
            U32x16::new([0, 0, 4, 4, 8, 8, 12, 12, 16, 16, 20, 20, 24, 24, 28, 28]);
        const WORDS: U32x16 = U32x16::new([0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1]);
        let halves: [U32x16; 2] = bytemuck::cast(*row);
        let column = &mut column[..16];
        for (half, first) in [(0, 0), (1, self.low)] {
            let places = U32x16::splat(self.halves[half]) >> PLACES;
            let packed: [f64; 8] = bytemuck::cast(look_up(halves[half], (places << 1_u32) | WORDS));
            column[first..first + 8].copy_from_slice(&packed);
        }
    }
}

/// In each lane the number of `table` at the place that the last four bits of `places` tell.
#[inline(always)]
pub fn look_up(table: U32x16, places: U32x16) -> U32x16 {
    table.shuffle_wrapping(places)
}

/// The bits of each lane from last to first.
#[inline(always)]
pub fn reverse_bits(row: U32x16) -> U32x16 {
    let swap = |row: U32x16, width: u32, mask: u32| {
        let mask = U32x16::splat(mask);
        (row >> width & mask) | (row & mask) << width
    };
    let row = swap(row, 1, 0x5555_5555);
    let row = swap(row, 2, 0x3333_3333);
    let row = swap(row, 4, 0x0f0f_0f0f);
    let row = swap(row, 8, 0x00ff_00ff);
    row >> 16 | row << 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_reversed_and_places_wrap() {
        let row: [u32; 16] = std::array::from_fn(|i| 0x9e37_79b9_u32.wrapping_mul(i as u32));
        let reversed = reverse_bits(U32x16::new(row)).to_array();
        assert_eq!(reversed, row.map(u32::reverse_bits));
        let places: [u32; 16] = std::array::from_fn(|i| 16 * i as u32 + 15 - i as u32);
        let found = look_up(U32x16::new(row), U32x16::new(places)).to_array();
        assert_eq!(found, std::array::from_fn(|i| row[15 - i]));
    }

    #[test]
    fn columns_become_rows() {
        let columns = std::array::from_fn(|i| {
            F32x16::new(std::array::from_fn(|lane| (100 * i + lane) as f32))
        });
        for first in [0, 8] {
            for (i, row) in transpose(columns, first).into_iter().enumerate() {
                assert_eq!(row.to_array(), std::array::from_fn(|k| (100 * k + first + i) as f32));
            }
        }
    }

    #[test]
    fn lanes_are_put_one_after_another() {
        let row: [u32; 16] = std::array::from_fn(|i| 100 + i as u32);
        for lanes in 0..=u32::from(u16::MAX) {
            let packing = Packing::new(lanes);
            let mut column = [0; 19];
            packing.store_numbers(U32x16::new(row), &mut column[1..]);
            let expected: Vec<u32> =
                super::super::set_bits(lanes).map(|lane| 100 + lane as u32).collect();
            assert_eq!(packing.count(), expected.len());
            assert_eq!(column[1..=expected.len()], expected, "{lanes:x}");
            assert_eq!((column[0], &column[17..]), (0, &[0, 0][..]));
            let mut column = [0.0; 19];
            packing.store_doubles(&row.map(f64::from), &mut column[1..]);
            assert!(column[1..].iter().zip(&expected).all(|(&a, &b)| a == f64::from(b)));
            assert_eq!((column[0], &column[17..]), (0.0, &[0.0, 0.0][..]));
        }
    }

    #[test]
    fn shuffles_take_one_nibble_per_lane() {
        let row: [u32; 8] = std::array::from_fn(|i| 10 + i as u32);
        assert_eq!(shuffle_numbers(&row, 0x7654_3210), row);
        assert_eq!(shuffle_numbers(&row, 0x0123_4567), [17, 16, 15, 14, 13, 12, 11, 10]);
        let lanes = F32x8::new(row.map(|x| x as f32));
        assert_eq!(shuffle(lanes, 0x52).to_array()[..2], [12.0, 15.0]);
    }

    #[test]
    fn the_least_lane_is_the_first_of_those_that_count() {
        let rows = [[0.0, 1.0, 0.0, 2.0, f32::MAX, 1e-30, f32::INFINITY, 0.5], [3.0; 8]];
        for row in rows {
            for lanes in 1..=u32::from(u8::MAX) {
                let counted = super::super::set_bits(lanes);
                let least = counted.reduce(|a, b| if row[b] < row[a] { b } else { a });
                let found = least_lane(F32x8::new(row), F32x8::lanes(lanes));
                assert_eq!(Some(found), least, "{lanes:b}");
            }
        }
    }

    #[test]
    fn the_greatest_lanes_are_found_wherever_they_are() {
        for lane in 0..16 {
            let mut row = [-3.0; 16];
            row[lane] = 2.0;
            let lanes = F32x16::new(row);
            let lower = lanes - F32x16::splat(1.0);
            assert_eq!(lanes.greatest(), 2.0);
            assert_eq!(greatest_of([lanes, lower, -lanes]).to_array()[..3], [2.0, 1.0, 3.0]);
        }
        assert_eq!(Lanes::greatest(4.0_f32), 4.0);
    }
}
