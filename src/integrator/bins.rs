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

/// A chunk of rows by bin.
type Sorted = [[u32; CHUNK]; ESCAPED + 1];

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
        let kinds = &world.features.spheres_by_kind;
        let mut present = (0..Kind::COUNT).filter(|&kind| kinds[kind] > 0);
        match (&world.appearance.material, present.next(), present.next()) {
            (Column::Rows(ids), _, Some(_)) if !ids.is_empty() => {
                let kind = |hit: u32| ids[(hit as usize).min(ids.len() - 1)].kind() as usize;
                self.sort_by(hits, ground, kind);
            }
            (_, only, _) => {
                let only = only.unwrap_or(ESCAPED);
                self.sort_by(hits, ground, |_| only);
            }
        }
    }

    /// The same; `kind` tells the kinds of spheres, and anything of rows that are none.
    #[inline(always)]
    fn sort_by(&mut self, hits: &[u32], ground: usize, kind: impl Fn(u32) -> usize) {
        let mut sorted: Sorted = [[0; CHUNK]; ESCAPED + 1];
        for (hits, first) in hits.chunks(CHUNK).zip((0..).step_by(CHUNK)) {
            // Eight bits for how many rows each bin has.
            let mut counts = 0_u64;
            for (&hit, row) in hits.iter().zip(first..) {
                let bin = if hit == GROUND { ground } else { kind(hit) };
                let bin = if hit == MISS { ESCAPED } else { bin };
                // Without a branch: which bin comes next cannot be foretold.
                sorted[bin][(counts >> (8 * bin)) as usize % CHUNK] = row;
                counts += 1 << (8 * bin);
            }
            let bins = self.kind.iter_mut().chain([&mut self.escaped]);
            for (rows, (bin, sorted)) in bins.zip(sorted.iter().enumerate()) {
                rows.extend_from_slice(&sorted[..(counts >> (8 * bin)) as usize & 0xff]);
            }
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

    /// The world keeps the census of what was taken out.
    #[test]
    fn where_the_spheres_were_taken_out_nothing_is_hit() {
        let mut world = World::build(&default_scene(3)).unwrap();
        world.appearance.material = Column::Rows(Vec::new());
        let mut bins = Bins::default();
        bins.sort(&world, &Hits::with_capacity(3), 3);
        assert_eq!((&bins.escaped[..], bins.scattered()), (&[0, 1, 2][..], 0));
    }
}
