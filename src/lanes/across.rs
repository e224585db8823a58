//! What moves values from lane to lane.

use super::{F32x4, F32x8, Lanes};

/// In lane `i` the greatest lane of `row[i]`; anything in the last.
#[inline(always)]
pub fn greatest_of<L: Lanes>([x, y, z]: [L; 3]) -> F32x4 {
    let z = z.greatest_four();
    let columns = F32x4::transpose([x.greatest_four(), y.greatest_four(), z, z]);
    let [a, b, c, d] = columns;
    Lanes::max(Lanes::max(a, b), Lanes::max(c, d))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_read_by_nibbles() {
        let row: [u32; 8] = std::array::from_fn(|i| 10 + i as u32);
        assert_eq!(shuffle_numbers(&row, 0x7654_3210), row);
        assert_eq!(shuffle_numbers(&row, 0x0123_4567), [17, 16, 15, 14, 13, 12, 11, 10]);
        let lanes = F32x8::new(row.map(|x| x as f32));
        assert_eq!(shuffle(lanes, 0x52).to_array()[..2], [12.0, 15.0]);
    }

    #[test]
    fn the_greatest_lanes_are_found_wherever_they_are() {
        for lane in 0..16 {
            let mut row = [-3.0; 16];
            row[lane] = 2.0;
            let lanes = super::super::F32x16::new(row);
            let lower = lanes - super::super::F32x16::splat(1.0);
            assert_eq!(lanes.greatest(), 2.0);
            assert_eq!(greatest_of([lanes, lower, -lanes]).to_array()[..3], [2.0, 1.0, 3.0]);
        }
        assert_eq!(Lanes::greatest(4.0_f32), 4.0);
    }
}
