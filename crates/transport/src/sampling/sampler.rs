//! Samplers: the random numbers of every path.

use super::hash::{mix, stream, unit};
use super::sobol::{Shuffled, Sobol, block, shuffle};
use super::stratified::Strata;
use crate::lanes::F32x16;
use crate::settings::SamplerKind;
use rand_xoshiro::Xoshiro128PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Salt of the keys of split events.
const SPLIT: u64 = 0x5851_f42d_4c95_7f2d;

/// Salt of the keys of replicas.
const REPLICA: u64 = 0xbb67_ae85_84ca_a73b;

/// Salt of the keys of numbers beyond the Sobol dimensions.
const BEYOND: u64 = 0xd134_2543_de82_ef95;

/// Salt of the keys of alternate numbers, which caustics use.
pub(super) const ALTERNATE: u64 = 0x3c6e_f372_fe94_f82b;

/// The source of all random numbers of a picture, without state, so that all threads use it.
///
/// A number is a pure function of (seed, pixel, sample index, dimension), so that pictures do not
/// depend on threads, tiles or the order of calls. Numbers are at least 0 and less than 1.
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
    pub(super) seed: u64,
    pub(super) points: Points,
}

/// The source of the numbers.
#[derive(Clone, Copy, Debug)]
pub(super) enum Points {
    Sobol(Sobol),
    Stratified(Strata),
    Independent,
}

/// The sampler's state of a path: 16 bytes that do not change along the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SamplerState {
    /// Hash of seed, pixel and, depending on the kind, the set of points that several samples share.
    pub(super) key: u64,
    /// Index of the path among the samples of `key`.
    pub(super) index: u32,
    /// Position of the path in the Sobol sequence of `key`.
    pub(super) shuffled: Shuffled,
}

impl SamplerState {
    /// Returns the same path with other numbers for the same decisions.
    #[inline(always)]
    pub(super) fn alternate(self) -> Self {
        Self { key: self.key ^ ALTERNATE, ..self }
    }
}

impl Sampler {
    /// Creates a sampler for `spp` samples per pixel; 0 counts as 1. Only stratified points depend on
    /// `spp`.
    pub fn new(kind: SamplerKind, seed: u64, spp: u32) -> Self {
        let points = match kind {
            SamplerKind::Sobol => Points::Sobol(Sobol::new()),
            SamplerKind::Stratified => Points::Stratified(Strata::new(spp)),
            SamplerKind::Independent => Points::Independent,
        };
        // Mixed, so that the pixels' keys of neighboring seeds do not overlap.
        Self { seed: mix(seed), points }
    }

    /// Returns the hash of the seed, from which the keys of pixels are made.
    pub fn hashed_seed(&self) -> u64 {
        self.seed
    }

    /// Returns the sums of Sobol's direction vectors, by set of dimensions, nibble of the index from the lowest bits on, and
    /// value of the nibble; empty for points of another kind.
    pub fn table(&self) -> Vec<[u32; 4]> {
        match &self.points {
            Points::Sobol(sobol) => sobol.table().collect(),
            Points::Stratified(_) | Points::Independent => Vec::new(),
        }
    }

    /// Returns a sampler of the same kind, independent of this one and of all other replicas; number 0
    /// is a replica too.
    pub fn replica(&self, number: u64) -> Self {
        Self { seed: stream(self.seed ^ REPLICA, number), ..*self }
    }

    /// Returns the state of the path of sample `index`, from 0, of the pixel in column `x` and row `y`.
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

    /// Returns four numbers in [0, 1): set number `set` of the path's dimensions, in any order of
    /// calls.
    ///
    /// The first two are well distributed jointly, as are the last two. Integrators use
    /// [`Sampler::pixel`] and similar functions, which assign sets to decisions.
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

    /// Returns the points in the unit square of an event that is sampled `count` times on a path.
    /// `event` distinguishes such events of one path.
    ///
    /// Sobol points of an event continue from sample to sample, so that the points of all samples of a
    /// pixel are jointly well distributed if an event's `count` is always the same, best a power of
    /// two.
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
    /// Returns point `index`, from 0; all points of the event are jointly well distributed.
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

    /// Returns the points of `count` indices from `first` on, at most sixteen; further lanes are
    /// undefined.
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

/// Returns four numbers of a generator of its own for (key, set).
#[inline]
fn independent(key: u64, set: u32) -> [f32; 4] {
    let mut generator = Xoshiro128PlusPlus::seed_from_u64(stream(key, u64::from(set)));
    std::array::from_fn(|_| unit(generator.next_u32()))
}

#[cfg(test)]
mod tests;
