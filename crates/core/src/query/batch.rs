//! Batches of rays: those that single precision holds are traced in packets, the others one by one.

use super::answers::{Answers, FoundHit};
use super::chunk::{ChunkRays, Rows};
use super::columns::{RayTable, Tally};
use super::load::PACKET;
use super::reorder::{SORTED_RAYS, SortedRays};
use super::surface::PendingSurfaces;
use super::{NOTHING, SphereTree};
use crate::bvh::{Query, Traversal, decide_found, trace};
use crate::intersect::Pair;
use crate::lanes::{F32x16, Lanes, Mask, bits, bits_of, first_lanes, set_bits};
use crate::ray::{self, MISS, Rays};

/// Rays that are traced together: they stay in the second-level cache.
pub(super) const CHUNK: usize = 2048;

/// The rays of a chunk in the tree's units, and what they hit; chunks share the memory.
struct TracedRays {
    rays: Rays,
    hits: ray::Hits,
}

impl SphereTree {
    /// Traces rays in chunks, and writes the answers of those that hit something; `known` is what they hit in the tree,
    /// if that has been found elsewhere ([`decide_found`]).
    pub(super) fn run<Q: Query>(
        &self,
        table: &impl RayTable,
        answers: &mut impl Answers,
        known: Option<&[u32]>,
    ) -> Tally {
        let mut tally = Tally::default();
        let count = table.len();
        let mut traced = TracedRays {
            rays: Rays::with_capacity(CHUNK.min(count)),
            hits: ray::Hits::with_capacity(CHUNK.min(count)),
        };
        let mut sorted = SortedRays::taken();
        for first in (0..count).step_by(SORTED_RAYS) {
            let batch = Rows { table, rows: first..count.min(first + SORTED_RAYS) };
            let is_sorted =
                known.is_none() && self.sort_rays(&batch, answers.bounds(), &mut sorted);
            for first in (0..batch.rows.len()).step_by(CHUNK) {
                let places = first..batch.rows.len().min(first + CHUNK);
                let (traced, tally) = (&mut traced, &mut tally);
                if is_sorted {
                    let chunk = sorted.chunk(places);
                    self.run_chunk::<Q>(table, &chunk, traced, known, answers, tally);
                } else {
                    let chunk = batch.chunk(places);
                    self.run_chunk::<Q>(table, &chunk, traced, known, answers, tally);
                }
            }
        }
        sorted.give_back();
        tally
    }

    /// Traces the rays of a chunk, and writes their answers.
    #[inline(always)]
    fn run_chunk<Q: Query>(
        &self,
        table: &impl RayTable,
        chunk: &impl ChunkRays,
        traced: &mut TracedRays,
        known: Option<&[u32]>,
        answers: &mut impl Answers,
        tally: &mut Tally,
    ) {
        let TracedRays { rays, hits } = traced;
        let loaded = self.load(chunk, answers.bounds(), rays, hits);
        tally.exact += match known {
            Some(known) => decide_found::<Q>(self.tree(), rays, hits, |k| known[chunk.row(k)]),
            None => trace::<F32x16, Q>(Traversal::Auto, self.tree(), rays, hits),
        };
        // Powers of two, whose product does not round.
        let unit = |row: usize| f64::from(loaded.shrink[row]) * self.scale[1];
        let mut pending = PendingSurfaces::NONE;
        for first in (0..chunk.len()).step_by(PACKET) {
            let plain = loaded.plain[first / PACKET];
            let lanes = first_lanes(chunk.len() - first);
            let hit = F32x16::lanes(plain)
                & !bits_of::<F32x16>(&hits.sphere[first..]).has_bits_of(bits(MISS));
            let found = |row: usize| {
                let sphere = hits.sphere[row] as usize;
                let id = if Q::ANY { NOTHING } else { self.spheres.id[sphere] };
                FoundHit { sphere, id, t: hits.t[row] * unit(row) }
            };
            // What is decided ray by ray: rays that are not plain, and all where there are strays.
            let alone = if self.strays.is_empty() { !plain & lanes } else { lanes };
            let hit = hit.bits() & lanes;
            for row in set_bits(hit & !alone).map(|lane| first + lane) {
                let (i, hit) = (chunk.row(row), found(row));
                answers.set(i, &hit);
                let Some(surfaces) = answers.surfaces() else { continue };
                let pair = Pair { row: row as u32, sphere: hit.sphere as u32 };
                if !self.spheres.precise.is_empty() {
                    surfaces[i] = self.surface_of_ray(table.row(i), &hit);
                } else if pending.push(pair, i) {
                    self.flush_surfaces(&mut pending, rays, hits, table, unit, surfaces);
                }
            }
            for lane in set_bits(alone) {
                let i = chunk.row(first + lane);
                let (ray, bound) = (table.row(i), answers.bounds()[i]);
                let hit = if plain >> lane & 1 == 1 {
                    let hit = (hit >> lane & 1 == 1).then(|| found(first + lane));
                    self.with_strays::<Q>(ray, bound, hit, tally)
                } else {
                    self.trace_one::<Q>(ray, bound, tally)
                };
                let Some(hit) = hit else { continue };
                answers.set(i, &hit);
                if let Some(surfaces) = answers.surfaces() {
                    surfaces[i] = self.surface_of_ray(ray, &hit);
                }
            }
        }
        if let Some(surfaces) = answers.surfaces() {
            self.flush_surfaces(&mut pending, rays, hits, table, unit, surfaces);
        }
    }
}
