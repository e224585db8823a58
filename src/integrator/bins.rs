//! Rows by what they hit.

use crate::ray::{Hits, MISS};
use crate::world::{Kind, World};

/// Rows by what they hit.
#[derive(Default)]
pub struct Bins {
    /// Nothing.
    pub escaped: Vec<u32>,
    /// A surface of each kind.
    pub kind: [Vec<u32>; Kind::COUNT],
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
        for row in 0..count {
            let hit = hits.sphere[row];
            if hit == MISS {
                self.escaped.push(row as u32);
            } else {
                self.kind[world.material(hit).kind() as usize].push(row as u32);
            }
        }
    }
}
