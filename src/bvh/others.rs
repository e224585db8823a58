//! Which rays go each on its own.

use super::ready::Start;
use crate::lanes::{Lanes, MAX_LANES, Packing, U32x16, set_bits};
use crate::ray::CHUNK;
use std::ops::Range;

/// The numbers of lanes.
const LANES: [u32; MAX_LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// Set in a ray's place where few of its row of lanes are to begin.
const FEW: u32 = 1 << 31;

/// Rays of a chunk, in their order.
pub(super) struct Others {
    /// The chunk's first ray.
    first: usize,
    /// Places in the chunk, and [`FEW`].
    place: [u32; CHUNK],
    count: usize,
}

impl Others {
    /// None yet.
    #[inline(always)]
    pub(super) fn of_chunk(first: usize) -> Self {
        Self { first, place: [0; CHUNK], count: 0 }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Appends lanes of the row of rays from `row` on, whose bits are set.
    #[inline(always)]
    pub(super) fn push<L: Lanes>(&mut self, row: usize, lanes: u32) {
        if lanes == 0 {
            return;
        }
        let count = lanes.count_ones() as usize;
        let first = (row - self.first) as u32 | if is_few(count) { FEW } else { 0 };
        let places = &mut self.place[self.count..];
        if L::WIDTH == MAX_LANES {
            // Whole rows are written: no more than are left.
            let numbers = U32x16::splat(first) + U32x16::new(LANES);
            Packing::new(lanes).store_numbers(numbers, places);
        } else {
            set_bits(lanes).zip(places).for_each(|(lane, place)| *place = first + lane as u32);
        }
        self.count += count;
    }

    /// All of them.
    #[inline(always)]
    pub(super) fn starts(&self) -> impl Iterator<Item = Start> {
        self.place[..self.count].iter().map(|&place| Start {
            row: self.first + (place & !FEW) as usize,
            few: place & FEW != 0,
        })
    }
}

/// All rays of some rows.
#[inline(always)]
pub(super) fn starts(rows: Range<usize>) -> impl Iterator<Item = Start> {
    let few = is_few(rows.len());
    rows.map(move |row| Start { row, few })
}

/// To make a row of lanes ready takes about as long as eight rays one by one.
fn is_few(count: usize) -> bool {
    2 * count < MAX_LANES
}
