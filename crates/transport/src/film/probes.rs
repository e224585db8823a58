//! Probes: pixels that are rendered twice in addition to the picture, to measure the difference of two
//! equal renders.
//!
//! Samples of probes are no part of the picture: all their streams have random numbers of their own. So
//! decisions that depend on probes are independent of the picture's own samples (see the module `noise` of the renderer).

use super::{ChanceLight, ChanceVariance, Sums, Tile};
use crate::color::Rgb;
use crate::sampling::{Sampler, mix, stream};
use serde::{Deserialize, Serialize};

/// Salt of the hashes that place probes.
const PROBE_SALT: u64 = 0x6a09_e667_f3bc_c909;

/// Salt of the hashes that place the pilot's samples.
const PILOT_SALT: u64 = 0x3c6e_f372_fe94_f82b;

/// Sampler replica of the pilot's samples; those of probes follow it; the picture's is none.
const PILOT: u64 = 1;

/// The role of a probe. Steering probes do not judge: a tile whose noise is underestimated by chance
/// would not be refined, and would be judged by the same chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Decides which tiles need more samples.
    Steer,
    /// Estimates the error of the picture.
    Judge,
}

/// Streams of samples per probe.
const PAIR: usize = 2;

/// The density of probes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Density {
    /// Number of neighboring pixels that share a probe of each role: a power of two.
    pub block: u32,
    /// Number of probes of each role in each block, at different pixels.
    pub replicas: u32,
}

/// The probes of a tile, and its pilot.
#[derive(Clone, Debug, Default)]
pub struct Probes {
    /// Samples in each of the streams.
    pub samples: u32,
    /// Rays of these samples.
    pub rays: u64,
    /// Light that these samples find by chance.
    pub chance: ChanceLight,
    /// Probes of both roles, alternating.
    list: Vec<Probe>,
    /// Two streams for each probe, one after the other.
    pub(super) sums: Sums,
    /// Estimate from a few samples of all pixels before the render, once they were taken.
    pub pilot: Option<Pilot>,
}

/// A probe's pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Probe {
    x: u32,
    y: u32,
    /// Number of pixels that it represents.
    weight: f64,
}

/// An estimate of the sum over a tile's pixels, and its variance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pilot {
    /// Sum of the pixels' radiance, averaged over the channels.
    pub sum: f64,
    /// Variance of the sum; an upper estimate if pixels differ.
    pub variance: f64,
}

/// A probe's pixel and the means of its two streams.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbePair {
    /// Column of the picture.
    pub x: u32,
    /// Row of the picture.
    pub y: u32,
    /// Number of pixels that the probe represents.
    pub weight: f64,
    /// Mean radiance of each stream, by channel.
    pub means: [[f64; 3]; PAIR],
}

impl ProbePair {
    /// Estimates the squared error of a pixel that is independent of the streams, averaged over channels, without bias:
    /// it may be negative.
    pub fn squared_error(&self, pixel: [f32; 3]) -> f64 {
        let [a, b] = self.means;
        let product = |channel: usize| {
            let pixel = f64::from(pixel[channel]);
            (pixel - a[channel]) * (pixel - b[channel])
        };
        (0..3).map(product).sum::<f64>() / 3.0
    }
}

/// The reading of one probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Number of pixels that the probe represents.
    pub weight: f64,
    /// Mean over channels and both streams.
    pub radiance: f64,
    /// Half the squared difference of the streams' means, averaged over channels: an unbiased estimate
    /// of the variance of the mean of one stream.
    pub squared: f64,
    /// The same for independent samples: their variance over their number.
    pub independent: f64,
}

impl Density {
    /// Returns the density for a picture with this number of pixels: one in 64 has a probe of each
    /// role, which are a sixteenth of all samples; more in small pictures, which would have too few.
    pub fn of(pixels: u64) -> Self {
        let block = match pixels {
            65_536.. => 64,
            4096.. => 32,
            _ => 1 << (pixels / 128).max(1).ilog2(),
        };
        Self { block, replicas: 32_u64.div_ceil(pixels.clamp(1, 32)) as u32 }
    }
}

impl Probes {
    /// Places the probes of a tile, by a hash of `seed` and block: all pixels of a block are equally
    /// likely.
    pub fn new(tile: &Tile, density: Density, seed: u64) -> Self {
        let pixels: Vec<_> = tile.pixels().collect();
        let key = key(tile, mix(seed ^ PROBE_SALT));
        let blocks = pixels.chunks(density.block as usize);
        let list: Vec<Probe> = (0..density.replicas)
            .flat_map(|_| blocks.clone())
            .flat_map(|block| [block; 2])
            .zip(0..)
            .map(|(block, number)| place_probe(block, stream(key, number), density))
            .collect();
        let sums = Sums::new(list.len() * PAIR, true);
        Self { list, sums, ..Self::default() }
    }

    /// Returns the number of streams; 0 if nothing is measured.
    pub fn streams(&self) -> usize {
        self.list.len() * PAIR
    }

    /// Returns pixel and sampler of each stream. The streams and the picture are independent.
    pub fn starts<'a>(
        &'a self,
        sampler: &'a Sampler,
    ) -> impl Iterator<Item = (u32, u32, Sampler)> + 'a {
        let replicas = PILOT + 1..;
        let both = self.list.iter().flat_map(|probe| [probe; PAIR]);
        both.zip(replicas).map(|(probe, number)| (probe.x, probe.y, sampler.replica(number)))
    }

    /// Adds `count` samples to every stream, as [`Sums::add`] does.
    pub fn add(&mut self, radiance: &[Rgb], count: u32) -> u64 {
        self.samples += count;
        self.sums.add(radiance, count)
    }

    /// Adds other samples of the same probes. Returns false if the numbers of probes differ.
    pub(super) fn merge(&mut self, other: &Self) -> bool {
        self.samples += other.samples;
        self.rays += other.rays;
        self.chance.merge(&other.chance);
        self.list.len() == other.list.len() && self.sums.merge(&other.sums)
    }

    /// Returns the pixels and means of the probes of one role.
    pub fn pairs(&self, role: Role) -> impl Iterator<Item = ProbePair> + '_ {
        let means: Vec<_> = self.sums.means(self.samples).collect();
        (role as usize..self.list.len()).step_by(2).map(move |index| {
            let Probe { x, y, weight } = self.list[index];
            ProbePair { x, y, weight, means: [means[PAIR * index], means[PAIR * index + 1]] }
        })
    }

    /// Returns the readings of the probes of one role.
    pub fn readings(&self, role: Role) -> impl Iterator<Item = Reading> + '_ {
        let means: Vec<_> = self.sums.means(self.samples).collect();
        let variances: Vec<_> = self.sums.variances(self.samples).collect();
        let count = f64::from(self.samples.max(1));
        (role as usize..self.list.len()).step_by(2).map(move |index| {
            let [a, b] = [means[PAIR * index], means[PAIR * index + 1]];
            let spread = [variances[PAIR * index], variances[PAIR * index + 1]];
            Reading {
                weight: self.list[index].weight,
                radiance: f64::midpoint(average(a), average(b)),
                squared: average(std::array::from_fn(|i| (a[i] - b[i]).powi(2) / 2.0)),
                independent: spread.map(average).iter().sum::<f64>() / 2.0 / count,
            }
        })
    }

    /// Returns the variance of a pixel's mean that is expected of light found by chance; of the hits, those
    /// of the probes of one role are known.
    pub fn chance_variance(&self, role: Role) -> ChanceVariance {
        self.chance.variance(role, self.list.len() / 2, self.samples)
    }

    /// Returns the mean number of rays of a sample.
    pub fn rays_per_sample(&self) -> f64 {
        self.rays as f64 / (self.samples as f64 * self.streams() as f64).max(1.0)
    }
}

impl Pilot {
    /// Returns pixel, sampler and number of represented pixels for one of each `block` neighbors of a
    /// tile.
    pub fn starts(
        tile: &Tile,
        sampler: &Sampler,
        seed: u64,
        block: u32,
    ) -> Vec<(u32, u32, Sampler, f64)> {
        let (pixels, key): (Vec<_>, _) =
            (tile.pixels().collect(), key(tile, mix(seed ^ PILOT_SALT)));
        let blocks = pixels.chunks(block as usize).zip(0..);
        let sampler = sampler.replica(PILOT);
        blocks
            .map(|(block, number)| {
                let (x, y) = choose_pixel(block, stream(key, number));
                (x, y, sampler, block.len() as f64)
            })
            .collect()
    }

    /// Estimates the sum from `radiance`, with `count` samples of each pixel, and the numbers of pixels
    /// that each represents.
    ///
    /// The variance is that of neighbors in the column, whose differences contain noise and content.
    pub fn new(radiance: &[Rgb], count: u32, weights: impl Iterator<Item = f64>) -> Self {
        let value = |sample: &Rgb| average(sample.to_array().map(f64::from));
        let weighted = radiance.chunks_exact(count as usize).zip(weights);
        let values: Vec<f64> = weighted
            .flat_map(|(samples, weight)| samples.iter().map(move |s| weight * value(s)))
            .collect();
        let sum: f64 = values.iter().sum();
        let squares: f64 = values.windows(2).map(|pair| (pair[1] - pair[0]).powi(2) / 2.0).sum();
        let (number, count) = (values.len() as f64, f64::from(count));
        let variance = if values.len() > 1 { squares * number / (number - 1.0) } else { sum * sum };
        Self { sum: sum / count, variance: variance / (count * count) }
    }
}

/// Returns the hash of a tile's position.
fn key(tile: &Tile, seed: u64) -> u64 {
    stream(seed, u64::from(tile.region.y) << 32 | u64::from(tile.region.x))
}

/// Returns a pixel of a block, by the upper half of a hash.
fn choose_pixel(block: &[(u32, u32)], hash: u64) -> (u32, u32) {
    // The upper half of the product is less than the number of pixels.
    block[(((hash >> 32) * block.len() as u64) >> 32) as usize]
}

fn place_probe(block: &[(u32, u32)], hash: u64, density: Density) -> Probe {
    let (x, y) = choose_pixel(block, hash);
    Probe { x, y, weight: block.len() as f64 / f64::from(density.replicas) }
}

fn average(channels: [f64; 3]) -> f64 {
    channels.iter().sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Film, Region};
    use crate::settings::SamplerKind;

    fn film(width: u32, height: u32) -> Film {
        let mut film = Film::new(Region { x: 3, y: 5, width, height }, false).unwrap();
        let density = Density::of(film.pixels());
        film.place_probes(density, 7, |_| true);
        film
    }

    #[test]
    fn probes_represent_every_pixel_once() {
        for (width, height) in [(1, 1), (3, 2), (16, 16), (40, 33), (100, 80), (300, 260)] {
            let film = film(width, height);
            for role in [Role::Steer, Role::Judge] {
                let readings = || film.tiles.iter().flat_map(|tile| tile.probes.readings(role));
                let weight: f64 = readings().map(|reading| reading.weight).sum();
                let pixels = f64::from(width) * f64::from(height);
                assert!((weight - pixels).abs() < 1e-9 * pixels, "{width} x {height}: {weight}");
                assert!(readings().count() >= 32, "{width} x {height}");
            }
        }
    }

    #[test]
    fn probes_lie_in_their_tile_and_all_streams_differ() {
        let film = film(40, 33);
        let sampler = Sampler::new(SamplerKind::Sobol, 1, 16);
        for tile in &film.tiles {
            let inside: Vec<_> = tile.pixels().collect();
            let starts: Vec<_> = tile.probes.starts(&sampler).collect();
            let mut states: Vec<_> = inside
                .iter()
                .flat_map(|&(x, y)| [(x, y, sampler), (x, y, sampler.replica(PILOT))])
                .chain(starts)
                .inspect(|&(x, y, _)| assert!(inside.contains(&(x, y))))
                .map(|(x, y, sampler)| format!("{:?}", sampler.start(x, y, 0)))
                .collect();
            let count = states.len();
            states.sort_unstable();
            states.dedup();
            assert_eq!(states.len(), count);
        }
    }

    #[test]
    fn half_the_squared_difference_of_a_pair_is_its_variance() {
        let mut film = film(1, 1);
        let probes = &mut film.tiles[0].probes;
        let samples: Vec<Rgb> = (0..probes.streams()).map(|i| Rgb::splat((i % 2) as f32)).collect();
        probes.add(&samples, 1);
        for reading in probes.readings(Role::Judge) {
            assert_eq!((reading.squared, reading.radiance, reading.independent), (0.5, 0.5, 0.0));
        }
    }

    #[test]
    fn pilots_estimate_variance_from_neighbors() {
        let samples = [1.0, 3.0, 5.0, 7.0].map(Rgb::splat);
        let pilot = Pilot::new(&samples, 2, [2.0, 3.0].into_iter());
        // Weighted they are 2, 6, 15 and 21: half the squared differences are 8, 40.5 and 18.
        assert_eq!(pilot.sum, 44.0 / 2.0);
        assert!((pilot.variance - 66.5 * 4.0 / 3.0 / 4.0).abs() < 1e-12, "{}", pilot.variance);
    }

    #[test]
    fn rays_are_counted_by_sample_and_merged() {
        let mut film = film(16, 16);
        let probes = &mut film.tiles[0].probes;
        (probes.samples, probes.rays) = (4, 40 * probes.streams() as u64);
        assert_eq!(probes.rays_per_sample(), 10.0);
        let other = probes.clone();
        assert!(probes.merge(&other));
        assert_eq!((probes.samples, probes.rays), (8, 2 * other.rays));
    }
}
