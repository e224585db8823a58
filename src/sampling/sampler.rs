//! Where samples lie: the random numbers of every path.

use super::hash::{mix, stream, unit};
use super::sobol::{Shuffled, Sobol, block, shuffle};
use super::stratified::Strata;
use crate::lanes::F32x16;
use crate::scene::SamplerKind;
use rand_xoshiro::Xoshiro128PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Sets the keys of split events apart from those of draws.
const SPLIT: u64 = 0x5851_f42d_4c95_7f2d;

/// Sets the keys of replicas apart from those of pixels.
const REPLICA: u64 = 0xbb67_ae85_84ca_a73b;

/// Sets the keys of numbers beyond the Sobol dimensions apart from both.
const BEYOND: u64 = 0xd134_2543_de82_ef95;

/// Sets the keys of the numbers of caustics apart from those of other decisions.
pub(super) const OTHER: u64 = 0x3c6e_f372_fe94_f82b;

/// The source of all randomness of a picture, shared by all threads: it has no state.
///
/// A number is a pure function of (seed, pixel, sample index, dimension), so pictures do not depend on
/// threads, tiles or the order in which anything is asked for. Numbers are at least 0 and less than 1.
///
/// * [`SamplerKind::Sobol`]: Burley, "Practical Hash-based Owen Scrambling", JCGT 2020, one sequence
///   of 256 dimensions, scrambled and shuffled anew for every pixel and every 65 536 samples.
///   Dimensions from the 257th on, some thirty bounces away, are independent random numbers.
/// * [`SamplerKind::Stratified`]: both pairs of every set are jittered in `spp` cells, shuffled
///   independently. Samples from `spp` on start another round.
/// * [`SamplerKind::Independent`]: every set comes from a generator of its own, seeded by a hash of
///   path and set.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    seed: u64,
    pub(super) points: Points,
}

/// Where the numbers come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Points {
    Sobol(Sobol),
    Stratified(Strata),
    Independent,
}

/// What a path carries to draw its numbers: 16 bytes that never change on the way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplerState {
    /// Hash of seed, pixel and, by the kind, the samples that share one set of points.
    pub(super) key: u64,
    /// The path's place among the samples that share `key`.
    pub(super) index: u32,
    /// The same place in the Sobol sequence of `key`.
    pub(super) shuffled: Shuffled,
}

impl SamplerState {
    /// The same path with other numbers at the same decisions.
    #[inline(always)]
    pub(super) fn other(self) -> Self {
        Self { key: self.key ^ OTHER, ..self }
    }
}

impl Sampler {
    /// A sampler of `spp` samples per pixel; 0 counts as 1. Only stratified points depend on `spp`.
    pub fn new(kind: SamplerKind, seed: u64, spp: u32) -> Self {
        let points = match kind {
            SamplerKind::Sobol => Points::Sobol(Sobol::new()),
            SamplerKind::Stratified => Points::Stratified(Strata::new(spp)),
            SamplerKind::Independent => Points::Independent,
        };
        // Mixed, so that the pixels' keys of neighboring seeds do not overlap.
        Self { seed: mix(seed), points }
    }

    /// A sampler of points of the same kind, independent of this one's and of every other replica's:
    /// number 0 is another one too.
    pub fn replica(&self, number: u64) -> Self {
        Self { seed: stream(self.seed ^ REPLICA, number), ..*self }
    }

    /// The state of the path of sample `index`, from 0, of the pixel in column `x` and row `y`.
    #[inline]
    pub fn start(&self, x: u32, y: u32, index: u32) -> SamplerState {
        let pixel = stream(self.seed, u64::from(y) << 32 | u64::from(x));
        let (block, index) = match &self.points {
            Points::Sobol(_) => block(u64::from(index)),
            Points::Stratified(strata) => {
                (u64::from(index / strata.count()), index % strata.count())
            }
            Points::Independent => (u64::from(index), 0),
        };
        let key = stream(pixel, block);
        SamplerState { key, index, shuffled: shuffle(index, key as u32) }
    }

    /// Four numbers in [0, 1): set number `set` of the path's dimensions, in any order of calls.
    ///
    /// The first two are well distributed together, as are the last two. Integrators draw through
    /// [`Sampler::pixel`] and its like, which know which set is whose.
    #[inline]
    pub fn draw4(&self, path: &SamplerState, set: u32) -> [f32; 4] {
        match &self.points {
            Points::Sobol(sobol) => {
                sobol.draw4(path.shuffled, set, path.key as u32).unwrap_or_else(|| {
                    independent(stream(path.key ^ BEYOND, u64::from(path.index)), set)
                })
            }
            Points::Stratified(strata) => {
                let pair = |i| strata.point(path.index, stream(path.key, 2 * u64::from(set) + i));
                let ([a, b], [c, d]) = (pair(0), pair(1));
                [a, b, c, d]
            }
            Points::Independent => independent(path.key, set),
        }
    }

    /// The points in the unit square of one event of a path that is sampled `count` times. `event`
    /// tells such events of one path apart.
    ///
    /// Sobol points of one event go on from sample to sample, so that all samples of a pixel together
    /// are well distributed as well if they give an event the same `count`; best is a power of two.
    #[inline]
    pub fn split(&self, path: &SamplerState, event: u32, count: u32) -> Split {
        let key = stream(path.key ^ SPLIT, u64::from(event));
        match &self.points {
            Points::Sobol(sobol) => {
                let first = u64::from(path.index) * u64::from(count);
                Split { key, points: SplitPoints::Sobol(*sobol, first) }
            }
            Points::Stratified(_) => {
                let key = stream(key, u64::from(path.index));
                Split { key, points: SplitPoints::Stratified(Strata::new(count)) }
            }
            Points::Independent => Split { key, points: SplitPoints::Independent },
        }
    }
}

/// Points in the unit square for one event, well distributed over their indices.
#[derive(Clone, Copy, Debug)]
pub struct Split {
    key: u64,
    points: SplitPoints,
}

#[derive(Clone, Copy, Debug)]
enum SplitPoints {
    /// From this position of the sequence on.
    Sobol(Sobol, u64),
    Stratified(Strata),
    Independent,
}

impl Split {
    /// Point `index`, from 0; all of the event's together are what is well distributed.
    #[inline]
    pub fn pair(&self, index: u32) -> [f32; 2] {
        match &self.points {
            SplitPoints::Sobol(sobol, first) => {
                let (block, position) = block(first + u64::from(index));
                sobol.pair(position, stream(self.key, block) as u32)
            }
            SplitPoints::Stratified(strata) => strata.in_cell(index, self.key),
            SplitPoints::Independent => {
                let [u, v, ..] = independent(self.key, index);
                [u, v]
            }
        }
    }

    /// The points of `count` indices from `first` on, at most sixteen; further lanes are of no use.
    #[inline(always)]
    pub fn row(&self, first: u32, count: usize) -> [F32x16; 2] {
        if let SplitPoints::Stratified(strata) = &self.points {
            return strata.in_cells(first, self.key);
        }
        let mut rows = [[0.0; 16]; 2];
        let [us, vs] = &mut rows;
        for (index, (u, v)) in (first..).zip(us.iter_mut().zip(vs).take(count)) {
            [*u, *v] = self.pair(index);
        }
        rows.map(F32x16::new)
    }
}

/// Four numbers of the generator that belongs to (key, set): it lives as long as the call, and nobody
/// shares it.
#[inline]
fn independent(key: u64, set: u32) -> [f32; 4] {
    let mut generator = Xoshiro128PlusPlus::seed_from_u64(stream(key, u64::from(set)));
    std::array::from_fn(|_| unit(generator.next_u32()))
}

#[cfg(test)]
mod tests;
