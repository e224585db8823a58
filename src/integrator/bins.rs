//! Rows by what they hit.

use crate::ray::{GROUND, Hits, MISS};
use crate::world::{Column, Kind, World};

/// Rows by what they hit.
#[derive(Default)]
pub struct Bins {
    /// Nothing.
    pub escaped: Vec<u32>,
    /// A surface of each kind.
    pub kind: [Vec<u32>; Kind::COUNT],
}

/// Number of the bin of what escapes, after those of the kinds.
const ESCAPED: usize = Kind::COUNT;

/// Rows that are sorted together.
const CHUNK: usize = 128;

/// A chunk of rows by bin, and eight bits for how many each bin has.
struct Sorted {
    rows: [[u32; CHUNK]; ESCAPED + 1],
    counts: u64,
}

impl Sorted {
    /// Appends a row, without a branch: which bin comes next cannot be foretold.
    #[inline(always)]
    fn push(&mut self, row: u32, bin: usize) {
        let count = (self.counts >> (8 * bin)) as usize;
        self.rows[bin][count % CHUNK] = row;
        self.counts += 1 << (8 * bin);
    }

    /// The rows of a bin.
    fn bin(&self, bin: usize) -> &[u32] {
        &self.rows[bin][..(self.counts >> (8 * bin)) as usize & 0xff]
    }
}

impl Bins {
    /// How many rows hit something.
    pub fn scattered(&self) -> u64 {
        self.kind.iter().map(|rows| rows.len() as u64).sum()
    }

    /// Sorts rows `0..count` by what they hit.
    pub fn sort(&mut self, world: &World, hits: &Hits, count: usize) {
        self.escaped.clear();
        self.kind.iter_mut().for_each(Vec::clear);
        let hits = &hits.sphere[..count];
        let ground = world.ground.map_or(ESCAPED, |ground| ground.material.kind() as usize);
        match &world.appearance.material {
            Column::Uniform(id) => {
                let kind = id.kind() as usize;
                self.sort_by(hits, ground, |_| kind);
            }
            Column::Rows(ids) if ids.is_empty() => self.sort_by(hits, ground, |_| ESCAPED),
            Column::Rows(ids) => {
                let kind = |hit: u32| ids[(hit as usize).min(ids.len() - 1)].kind() as usize;
                self.sort_by(hits, ground, kind);
            }
        }
    }

    /// The same; `kind` tells the kinds of spheres, and anything of rows that are none.
    #[inline(always)]
    fn sort_by(&mut self, hits: &[u32], ground: usize, kind: impl Fn(u32) -> usize) {
        let mut sorted = Sorted { rows: [[0; CHUNK]; ESCAPED + 1], counts: 0 };
        for (hits, first) in hits.chunks(CHUNK).zip((0..).step_by(CHUNK)) {
            sorted.counts = 0;
            for (&hit, row) in hits.iter().zip(first..) {
                let bin = if hit == GROUND { ground } else { kind(hit) };
                sorted.push(row, if hit == MISS { ESCAPED } else { bin });
            }
            let bins = self.kind.iter_mut().chain([&mut self.escaped]);
            bins.enumerate().for_each(|(bin, rows)| rows.extend_from_slice(sorted.bin(bin)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::default_scene;

    #[test]
    fn every_row_is_in_the_bin_of_what_it_hits_and_in_order() {
        let world = World::build(&default_scene(3)).unwrap();
        let spheres = world.spheres.len() as u32;
        let mut hits = Hits::with_capacity(1000);
        let mut draw = 1_u32;
        for hit in &mut hits.sphere {
            draw = draw.wrapping_mul(747_796_405).wrapping_add(1);
            *hit = match draw >> 16 {
                x if x % 5 == 0 => MISS,
                x if x % 5 == 1 && world.ground.is_some() => GROUND,
                x => x % spheres,
            };
        }
        let mut bins = Bins::default();
        for count in [0, 1, 127, 128, 129, 1000, 300] {
            bins.sort(&world, &hits, count);
            let expected = |bin: Option<Kind>| {
                let of = |hit| (hit != MISS).then(|| world.material(hit).kind());
                let rows = (0..count as u32).filter(|&row| of(hits.sphere[row as usize]) == bin);
                rows.collect::<Vec<_>>()
            };
            assert_eq!(bins.escaped, expected(None));
            for kind in Kind::ALL {
                assert_eq!(bins.kind[kind as usize], expected(Some(kind)), "{kind:?}");
            }
        }
    }
}
