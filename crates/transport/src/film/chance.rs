//! Light that paths find by chance: how much noise it is expected to make, by near misses.

use super::{ExactSums, Role};
use serde::{Deserialize, Serialize};
use std::ops::Add;

/// Variance of the mean of n well-distributed samples at edges, times n^(3/2), over that of one sample. From 16
/// samples on it is between 0.2 and 0.6 in images of lamps.
const EDGES: f64 = 0.5;

/// Sums over the near misses of a tile's probes, from [`NearMisses`]: exact, so that they do not depend on the batches
/// and parts in which samples are taken.
///
/// [`NearMisses`]: crate::integrator::near_misses::NearMisses
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChanceLight {
    /// Terms by probe; empty before the first near miss.
    terms: ExactSums,
    /// Light of the hits, by stream and channel; empty before the first.
    hits: ExactSums,
}

/// The variance of samples of a pixel, averaged over channels, by a pair of samples, or a sum of such.
///
/// For rare hits, the variance of a pixel's mean is that of a sample over their number n; for edges, which
/// well-distributed samples resolve, it is less by the square root of n.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// Variance that is expected of rare hits, by near misses.
    pub rare: f64,
    /// Variance that is expected at edges of the images of lights.
    pub edges: f64,
    /// Fourth moment of rare hits.
    pub fourth: f64,
}

/// The variance of the mean of a number of samples that is expected of light found by chance, for a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChanceVariance {
    /// Variance by near misses, per pixel.
    pub expected: f64,
    /// Variance that the hits of the probes make, per pixel.
    pub found: f64,
    /// Variance of `expected`.
    pub uncertainty: f64,
    /// Variance of the squared error of one pixel.
    pub spread: f64,
}

impl ChanceLight {
    /// Adds a term of one probe, of `probes`.
    pub fn add(&mut self, probe: usize, probes: usize, term: Term) {
        add(&mut self.terms, probe, probes, term.all());
    }

    /// Adds the light of a hit to the stream of its sample, of `streams`.
    pub fn add_hit(&mut self, stream: usize, streams: usize, light: [f64; 3]) {
        add(&mut self.hits, stream, streams, light);
    }

    /// Adds other samples of the same probes.
    pub(super) fn merge(&mut self, other: &Self) {
        for (sums, others) in [(&mut self.terms, &other.terms), (&mut self.hits, &other.hits)] {
            if sums.is_empty() {
                sums.clone_from(others);
            } else if !others.is_empty() {
                sums.merge(others);
            }
        }
    }

    /// Returns whether all sums are numbers, and none is negative.
    pub(super) fn is_valid(&self) -> bool {
        let sums = [&self.terms, &self.hits];
        let exact = sums.iter().all(|sums| sums.is_valid());
        exact && sums.iter().flat_map(|sums| sums.rounded()).flatten().all(|sum| sum >= 0.0)
    }

    /// Returns the variance of the mean of `samples` samples, by `probes` probes of each role with as many.
    /// The variance found is that of one role: half the squared difference of the two streams of its probes.
    pub fn variance(&self, role: Role, probes: usize, samples: u32) -> ChanceVariance {
        if probes == 0 || samples == 0 {
            return ChanceVariance::default();
        }
        let (n, pairs) = (f64::from(samples), probes as f64 * f64::from(samples));
        let at_edges = EDGES / n.sqrt();
        let terms =
            || self.terms.rounded().map(|[rare, edges, fourth]| Term { rare, edges, fourth });
        let both = terms().fold(Term::default(), Add::add);
        let squares: f64 = terms().map(|term| (term.rare + term.edges).powi(2)).sum();
        let hits: Vec<[f64; 3]> = self.hits.rounded().collect();
        let of_role = hits.chunks_exact(2).skip(role as usize).step_by(2);
        let squared = of_role.flat_map(|hits| (0..3).map(|c| (hits[0][c] - hits[1][c]).powi(2)));
        ChanceVariance {
            expected: (both.rare + both.edges * at_edges) / (2.0 * pairs) / n,
            found: squared.sum::<f64>() / 6.0 / (pairs * n),
            uncertainty: squares / (2.0 * pairs * n).powi(2),
            spread: both.fourth / (2.0 * pairs) / n.powi(3),
        }
    }
}

/// Adds to one of `count` sums.
fn add(sums: &mut ExactSums, index: usize, count: usize, terms: [f64; 3]) {
    if sums.len() != count {
        *sums = ExactSums::new(count);
    }
    sums.add(index, terms);
}

impl Term {
    fn all(self) -> [f64; 3] {
        [self.rare, self.edges, self.fourth]
    }
}

impl Add for Term {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            rare: self.rare + other.rare,
            edges: self.edges + other.edges,
            fourth: self.fourth + other.fourth,
        }
    }
}
