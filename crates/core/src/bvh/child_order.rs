//! The order in which a ray visits the children of a node, from a table.
//!
//! Children are put into slots by where they are: bit `a` of a slot is set where the child is on the
//! upper side of axis `a`, as far as that distinguishes eight children. A ray whose direction is
//! negative on the axes of `octant` then meets slot `s` about as the `s ^ octant`-th (Ylitie,
//! Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG
//! 2017). One look-up gives the permutation that puts the children that are hit one after another,
//! the nearest last, where a stack is popped.

use super::{Bounds, WIDTH};

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

/// Returns a slot for each of at most [`WIDTH`] boxes: the pair that agrees best first, then the next.
pub(super) fn slots(boxes: &[Bounds]) -> [usize; WIDTH] {
    let all = boxes.iter().fold(Bounds::EMPTY, |all, bounds| all.union(bounds));
    let mut agreement = [[f32::NEG_INFINITY; WIDTH]; WIDTH];
    for (row, bounds) in agreement.iter_mut().zip(boxes) {
        let [x, y, z] = ((bounds.low - all.low) + (bounds.high - all.high)).to_array();
        for (slot, agreement) in row.iter_mut().enumerate() {
            let toward = |axis: usize, x: f32| if slot >> axis & 1 == 1 { x } else { -x };
            // Where boxes are so large that nothing is finite, any slot does.
            *agreement = (toward(0, x) + toward(1, y) + toward(2, z)).max(f32::MIN);
        }
    }
    let mut best = agreement.map(|row| first_greatest(&row));
    let mut slots = [WIDTH; WIDTH];
    for _ in boxes {
        let (child, _) = first_greatest(&best.map(|(_, agreement)| agreement));
        let slot = best[child].0;
        slots[child] = slot;
        agreement[child] = [f32::NEG_INFINITY; WIDTH];
        for (row, best) in agreement.iter_mut().zip(&mut best) {
            row[slot] = f32::NEG_INFINITY;
            if best.0 == slot {
                *best = first_greatest(row);
            }
        }
    }
    slots
}

/// Returns the place and the value of the first of the greatest values of a row.
fn first_greatest(row: &[f32; WIDTH]) -> (usize, f32) {
    let mut best = (0, row[0]);
    for (i, &x) in row.iter().enumerate() {
        if x > best.1 {
            best = (i, x);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
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
