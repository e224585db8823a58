//! The order in which a ray visits the children of a node, from a table.
//!
//! Children are put into slots by where they are: bit `a` of a slot is set where the child is on the
//! upper side of axis `a`, as far as that distinguishes eight children. A ray whose direction is
//! negative on the axes of `octant` then meets slot `s` about as the `s ^ octant`-th (Ylitie,
//! Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG
//! 2017). One look-up gives the permutation that puts the children that are hit one after another,
//! the nearest last, where a stack is popped.

use super::{Bounds, WIDTH};
use crate::lanes::{F32x8, Lanes, Mask};

/// By octant and by which slots are hit: their numbers, the farthest first, in four bits each.
static FARTHEST_FIRST: [[u32; 1 << WIDTH]; 8] = table();

const fn table() -> [[u32; 1 << WIDTH]; 8] {
    let mut table = [[0; 1 << WIDTH]; 8];
    let mut i = 0;
    while i < 8 << WIDTH {
        let (octant, hit) = (i >> WIDTH, i % (1 << WIDTH));
        let (mut rank, mut place) = (WIDTH, 0);
        while rank > 0 {
            rank -= 1;
            let slot = rank ^ octant;
            if hit >> slot & 1 == 1 {
                table[octant][hit] |= (slot as u32) << (4 * place);
                place += 1;
            }
        }
        i += 1;
    }
    table
}

/// Returns the permutation for a ray of `octant` that hits the slots in `hit`.
#[inline(always)]
pub(super) fn farthest_first(octant: usize, hit: u32) -> u32 {
    FARTHEST_FIRST[octant & 7][hit as usize & 0xff]
}

/// Returns the permutation that puts the slots in `mask` one after another, in their order.
#[inline(always)]
pub(super) fn in_order(mask: u32) -> u32 {
    // Octant 7 turns the order of the slots around, which the table does once more.
    farthest_first(WIDTH - 1, mask)
}

/// By axis, the side of each slot: 1 on the upper one, -1 on the lower one.
const SIDE: [F32x8; 3] = {
    let (mut side, mut i) = ([[0.0; WIDTH]; 3], 0);
    while i < 3 * WIDTH {
        let (axis, slot) = (i / WIDTH, i % WIDTH);
        side[axis][slot] = if slot >> axis & 1 == 1 { 1.0 } else { -1.0 };
        i += 1;
    }
    [F32x8::new(side[0]), F32x8::new(side[1]), F32x8::new(side[2])]
};

/// Returns a slot for each of at most [`WIDTH`] boxes: the pair that agrees best first, then the next.
pub(super) fn slots(boxes: &[Bounds]) -> [usize; WIDTH] {
    let none = F32x8::splat(f32::NEG_INFINITY);
    let all = boxes.iter().fold(Bounds::EMPTY, |all, bounds| all.union(bounds));
    // By child, the agreement with each slot that is free.
    let mut agreement = [none; WIDTH];
    let mut best = [(0, f32::NEG_INFINITY); WIDTH];
    for ((row, best), bounds) in agreement.iter_mut().zip(&mut best).zip(boxes) {
        let [x, y, z] = ((bounds.low - all.low) + (bounds.high - all.high)).to_array();
        let [x, y, z] =
            [SIDE[0] * F32x8::splat(x), SIDE[1] * F32x8::splat(y), SIDE[2] * F32x8::splat(z)];
        // Where boxes are so large that nothing is finite, any slot does.
        *row = Lanes::max(x + y + z, F32x8::splat(f32::MIN));
        *best = first_greatest(*row);
    }
    let mut slots = [WIDTH; WIDTH];
    for _ in boxes {
        let mut child = 0;
        for other in 1..WIDTH {
            child = if best[other].1 > best[child].1 { other } else { child };
        }
        let slot = best[child].0;
        slots[child] = slot;
        best[child].1 = f32::NEG_INFINITY;
        let taken = F32x8::lanes(1 << slot);
        for (child, row) in agreement.iter_mut().enumerate().take(boxes.len()) {
            *row = Lanes::select(taken, none, *row);
            if best[child].0 == slot && slots[child] == WIDTH {
                best[child] = first_greatest(*row);
            }
        }
    }
    slots
}

/// Returns the place and the value of the first of the greatest values of a row.
#[inline(always)]
fn first_greatest(row: F32x8) -> (usize, f32) {
    let greatest = row.greatest();
    let places = F32x8::splat(greatest).le(row).bits();
    (places.trailing_zeros() as usize % WIDTH, greatest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::numbered;
    use glam::Vec3;

    #[test]
    fn hit_children_come_once_and_the_nearest_last() {
        for octant in 0..8 {
            for hit in 0..1 << WIDTH {
                let order = farthest_first(octant, hit);
                let count = hit.count_ones() as usize;
                let slots: Vec<_> = (0..count).map(|i| (order >> (4 * i)) as usize & 7).collect();
                assert!(slots.iter().all(|slot| hit >> slot & 1 == 1), "{octant} {hit:b}");
                assert!(slots.windows(2).all(|pair| pair[0] ^ octant > pair[1] ^ octant));
            }
        }
    }

    /// The pair that agrees best of all that are left, and so on.
    #[test]
    fn slots_are_those_of_a_search_over_all_pairs() {
        for (seed, count) in (0..1000).zip((1..=WIDTH).cycle()) {
            let number = |i: usize, k| numbered(seed * 64 + i as u64, k);
            let corner = |i, k| Vec3::new(number(i, k), number(i, k + 1), number(i, k + 2));
            let cube = |i| Bounds { low: corner(i, 0) - 1.0, high: corner(i, 3) };
            let boxes: Vec<_> = (0..count).map(cube).collect();
            let all = boxes.iter().fold(Bounds::EMPTY, |all, bounds| all.union(bounds));
            let mut expected = [WIDTH; WIDTH];
            for _ in 0..count {
                let mut best = (f32::NEG_INFINITY, 0, 0);
                for (child, slot) in (0..count).flat_map(|i| (0..WIDTH).map(move |slot| (i, slot)))
                {
                    let bounds = &boxes[child];
                    let from_middle = (bounds.low - all.low) + (bounds.high - all.high);
                    let toward = |a: usize| if slot >> a & 1 == 1 { 1.0 } else { -1.0 };
                    let agreement = (0..3).map(|a| from_middle[a] * toward(a)).sum::<f32>();
                    let is_free = expected[child] == WIDTH && !expected.contains(&slot);
                    if is_free && agreement > best.0 {
                        best = (agreement, child, slot);
                    }
                }
                expected[best.1] = best.2;
            }
            assert_eq!(slots(&boxes), expected, "{seed}");
        }
    }

    #[test]
    fn children_in_octants_get_their_slots() {
        let corner =
            |slot: usize| Vec3::from_array(std::array::from_fn(|a| (slot >> a & 1) as f32));
        let order = [3, 7, 0, 5, 1, 2, 6, 4];
        let boxes =
            order.map(|slot| Bounds { low: corner(slot), high: corner(slot) + Vec3::splat(0.9) });
        assert_eq!(slots(&boxes), order);
        let some = slots(&boxes[..3]);
        assert_eq!(some[..3], order[..3]);
    }
}
