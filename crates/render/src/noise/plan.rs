//! Adaptive sampling: chooses the tiles that get more samples, as a function of the film.

use super::estimate::neighbors;
use super::{Noise, StopCondition};
use crate::elementary::{ln, pow};
use crate::film::{Film, Role, Tile};
use serde::{Deserialize, Serialize};
use std::f64::consts::LN_2;

/// Minimum and maximum exponent of the decrease of variance with samples.
const EXPONENTS: (f64, f64) = (0.5, 2.0);

/// Weight in pixels of the whole image's mean noise in a tile's estimate, beside its own 4096: no
/// tile is considered noise-free only because its probes found nothing.
const PRIOR_PIXELS: f64 = 128.0;

/// Minimum and maximum work of a round, as fractions of the work before it: the minimum limits the
/// number of decisions.
const WORK: (f64, f64) = (1.0 / 16.0, 0.5);

/// The rate at which variance falls with samples, learned from steps of tiles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    /// Sum of the tiles' variances before their steps.
    before: f64,
    /// The same, times the logarithm of the factor by which a step multiplied the samples.
    growth: f64,
    /// Sum of the variances after the steps.
    after: f64,
}

impl Default for Slope {
    /// The rate of independent samples, with little weight.
    fn default() -> Self {
        Self { before: 2e-12, growth: 2e-12 * LN_2, after: 1e-12 }
    }
}

impl Slope {
    /// Returns the sums of a round's steps before they are made, from the variance of each tile, and its numbers of
    /// samples before and after the step.
    pub fn before(steps: impl Iterator<Item = (f64, u32, u32)>) -> Self {
        let nothing = Self { before: 0.0, growth: 0.0, after: 0.0 };
        steps.fold(nothing, |sum, (variance, from, to)| Self {
            before: sum.before + variance,
            growth: sum.growth + variance * ln(f64::from(to) / f64::from(from)),
            ..sum
        })
    }

    /// Returns the same steps once they are made, with the sum of the variances after them.
    pub fn after(self, variance: f64) -> Self {
        Self { after: variance, ..self }
    }

    /// Learns from the steps of a round; older values decay.
    pub fn learn(&mut self, steps: Self) {
        self.before = self.before / 2.0 + steps.before;
        self.growth = self.growth / 2.0 + steps.growth;
        self.after = self.after / 2.0 + steps.after;
    }

    /// Returns the exponent: variance is inversely proportional to this power of the number of samples.
    pub fn exponent(&self) -> f64 {
        let exponent = ln(self.before / self.after) * self.before / self.growth;
        if exponent.is_finite() { exponent.clamp(EXPONENTS.0, EXPONENTS.1) } else { 1.0 }
    }
}

/// Returns the sum of the variances of a tile's pixels, by the steering probes and by what they are
/// expected not to have found.
pub fn steering_variance(tile: &Tile) -> f64 {
    let measured: f64 =
        tile.probes.readings(Role::Steer).map(|reading| reading.weight * reading.squared).sum();
    let chance = tile.probes.chance_variance(Role::Steer);
    measured + f64::from(tile.len()) * f64::max(chance.expected - chance.found, 0.0)
}

/// Returns the tiles of the next round in descending order of benefit; none if all have the maximum of
/// samples.
///
/// `noise` is the estimated error of the image.
pub fn next_round(
    film: &Film,
    stop: &StopCondition,
    slope: Slope,
    noise: Option<Noise>,
) -> Vec<u32> {
    let least = film.tiles.iter().filter(|tile| tile.probes.streams() > 0);
    let least = least.map(|tile| tile.samples).min().unwrap_or(0);
    let mut open: Vec<u32> = (0..film.tiles.len() as u32)
        .filter(|&tile| is_open(&film.tiles[tile as usize], stop))
        .collect();
    if least < stop.first_samples() {
        // Uniform; if time is short, the remaining tiles are scattered over the image.
        open.retain(|&tile| film.tiles[tile as usize].samples == least);
        open.sort_by_key(|&tile| crate::sampling::mix(u64::from(tile)));
        return open;
    }
    let wanted = stop.wanted(noise);
    let tiles = Benefit::of(film, stop, noise, slope.exponent());
    open.sort_by(|&a, &b| tiles[b as usize].rate().total_cmp(&tiles[a as usize].rate()));
    let total: f64 = tiles.iter().map(|tile| tile.variance).sum();
    let spent: f64 = film.tiles.iter().map(work).sum();
    let (mut left, mut added, mut count) = (total, 0.0, 0);
    for &tile in &open {
        let enough = left <= total * wanted && added >= WORK.0 * spent;
        if enough || added > WORK.1 * spent {
            break;
        }
        left -= tiles[tile as usize].gained;
        added += tiles[tile as usize].work;
        count += 1;
    }
    open.truncate(count);
    open
}

/// Returns whether a tile can have more samples, and needs them.
fn is_open(tile: &Tile, stop: &StopCondition) -> bool {
    tile.probes.streams() > 0 && tile.samples < stop.spp
}

/// Returns the rays that a tile has taken, by those of its probes: independent of the image's own.
pub fn work(tile: &Tile) -> f64 {
    f64::from(tile.samples) * per_sample(tile)
}

/// Returns the rays of a sample of each pixel; more than 0 even if all rays leave the scene.
fn per_sample(tile: &Tile) -> f64 {
    f64::from(tile.len()) * tile.probes.rays_per_sample()
}

/// Benefit and cost of a step of a tile.
#[derive(Clone, Copy, Debug)]
struct Benefit {
    /// Sum of the variances of its pixels.
    variance: f64,
    /// Expected decrease of the variance.
    gained: f64,
    /// Cost of the step.
    work: f64,
}

impl Benefit {
    /// Computes the benefit of each tile, also by probes of its neighbors, whose noise is scaled to the
    /// tile's own number of samples.
    fn of(
        film: &Film,
        stop: &StopCondition,
        of_picture: Option<Noise>,
        exponent: f64,
    ) -> Vec<Self> {
        let count = film.tiles.len();
        // Noise and pixels of each tile, as for one sample.
        let power = |samples: u32| pow(f64::from(samples.max(1)), exponent);
        let measured = |tile: &Tile| tile.probes.streams() > 0;
        let rows: Vec<(f64, f64)> = film
            .tiles
            .iter()
            .map(|tile| {
                if measured(tile) {
                    (steering_variance(tile), f64::from(tile.len()))
                } else {
                    (0.0, 0.0)
                }
            })
            .zip(&film.tiles)
            .map(|((variance, pixels), tile)| (variance * power(tile.samples), pixels))
            .collect();
        let sum = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let (noise, pixels) = rows.iter().copied().fold((0.0, 0.0), sum);
        let mean = noise / f64::max(pixels, 1.0);
        let benefit = |(index, tile): (usize, &Tile)| {
            let pooled = neighbors(index, film.columns(), count)
                .map(|(at, weight)| (weight * rows[at].0, weight * rows[at].1))
                .fold((PRIOR_PIXELS * mean, PRIOR_PIXELS), sum);
            let variance = pooled.0 / pooled.1 * rows[index].1 / power(tile.samples);
            let next = stop.next_samples(tile.samples, count, of_picture);
            let gained = variance * (1.0 - power(tile.samples) / power(next));
            let steps = f64::from(next.saturating_sub(tile.samples));
            Self { variance, gained, work: steps * per_sample(tile) }
        };
        film.tiles.iter().enumerate().map(benefit).collect()
    }

    fn rate(&self) -> f64 {
        self.gained / self.work.max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Density, Region};
    use crate::scene::Rgb;

    fn doubling(before: f64, after: f64) -> Slope {
        Slope::before(std::iter::once((before, 16, 32))).after(after)
    }

    #[test]
    fn slopes_follow_new_values() {
        let mut slope = Slope::default();
        assert_eq!(slope.exponent(), 1.0);
        slope.learn(doubling(8.0, 3.0));
        assert!((slope.exponent() - (8.0_f64 / 3.0).log2()).abs() < 1e-9);
        slope.learn(doubling(1e9, 1.0));
        assert_eq!(slope.exponent(), 2.0);
        slope.learn(doubling(0.0, 0.0));
        assert!(slope.exponent().is_finite());
        // Half as many samples again, at the rate of independent samples.
        let mut slope = Slope::default();
        slope.learn(Slope::before([(3.0, 16, 24), (6.0, 32, 48)].into_iter()).after(6.0));
        assert!((slope.exponent() - 1.0).abs() < 1e-9, "{}", slope.exponent());
    }

    /// Four tiles in a row; probes of tile `noisy` find noise, and tile 3 needs none.
    fn film(noisy: usize) -> Film {
        let mut film = Film::new(Region { x: 0, y: 0, width: 64, height: 16 }, false).unwrap();
        film.place_probes(Density { block: 64, replicas: 1 }, 1, |tile| tile.region.x < 48);
        for (index, tile) in film.tiles.iter_mut().enumerate() {
            let streams = tile.probes.streams();
            let samples = (0..16 * streams).map(|i| {
                let odd = index == noisy && i / 16 % 2 == 1;
                Rgb::splat(if odd { 2.0 } else { 1.0 })
            });
            tile.samples = 16;
            tile.probes.add(&samples.collect::<Vec<_>>(), 16);
            tile.probes.rays = 16 * streams as u64;
        }
        film
    }

    #[test]
    fn noisy_tiles_come_first_and_others_last() {
        let stop = StopCondition { until_error: None, time: None, spp: 64 };
        let film = film(1);
        let wanted = |error: f64| Some(Noise { error, bound: error, expected: 0.0 });
        let target = StopCondition { until_error: Some(0.9_f64.sqrt()), ..stop };
        let some = next_round(&film, &target, Slope::default(), wanted(1.0));
        assert_eq!(some, [1]);
        let all = next_round(&film, &stop, Slope::default(), None);
        assert!(all.len() >= 2 && all[0] == 1 && !all.contains(&3), "{all:?}");
        let done = StopCondition { spp: 16, ..stop };
        assert!(next_round(&film, &done, Slope::default(), None).is_empty());
    }

    #[test]
    fn older_values_count_half() {
        let mut slope = Slope::default();
        slope.learn(doubling(8.0, 3.0));
        slope.learn(doubling(1.0, 1.0));
        assert!((slope.exponent() - (5.0_f64 / 2.5).log2()).abs() < 1e-9);
    }

    #[test]
    fn probes_that_judge_do_not_steer() {
        let mut film = Film::new(Region { x: 0, y: 0, width: 16, height: 16 }, false).unwrap();
        film.place_probes(Density { block: 64, replicas: 1 }, 1, |_| true);
        // Probes of the two roles alternate, with two streams each: only those of judges differ.
        let probes = &mut film.tiles[0].probes;
        let radiance = |stream: usize| Rgb::splat(if stream % 4 == 3 { 2.0 } else { 1.0 });
        let samples: Vec<Rgb> = (0..probes.streams()).map(radiance).collect();
        probes.add(&samples, 1);
        assert_eq!(steering_variance(&film.tiles[0]), 0.0);
        assert!(crate::noise::squared_error(&film).all.value > 0.0);
    }
}
