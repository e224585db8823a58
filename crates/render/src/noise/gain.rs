//! The gain of sequences of samples over independent samples.

use super::estimate::neighbors;
use crate::film::{Film, Role};

/// Ratios of the variance of pixels' means to that of as many independent samples, in a tile: less than 1 for
/// well-distributed samples.
///
/// Probes of the tile and its neighbors measure it. At the edge of a light, samples have much more variance than beside
/// it, and the sequence has much more gain. So probes of more variance than a pixel count no more for it than those of
/// as much: they would hide that others have less gain.
pub struct Gain {
    /// In ascending order of [`Step::variance`], from 0.
    steps: Vec<Step>,
}

/// Sums over the probes with at most a variance, and over the others.
#[derive(Clone, Copy, Default)]
struct Step {
    /// Variance of the mean of independent samples.
    variance: f64,
    /// Sums over the probes with at most this variance: of their squared errors, and of their variances.
    squared: f64,
    independent: f64,
    /// Sums over the others: of the ratios of the same, and of their number.
    ratios: f64,
    count: f64,
}

impl Gain {
    /// Measures the gain in a tile of a film.
    pub fn of(film: &Film, tile: usize) -> Self {
        let around = neighbors(tile, film.columns(), film.tiles.len());
        let probes = around.map(|(tile, _)| &film.tiles[tile].probes);
        let readings = probes.flat_map(|probes| {
            [Role::Steer, Role::Judge].into_iter().flat_map(|role| probes.readings(role))
        });
        let mut readings: Vec<_> = readings.filter(|reading| reading.independent > 0.0).collect();
        readings.sort_by(|a, b| a.independent.total_cmp(&b.independent));
        let mut steps = vec![Step::default(); readings.len() + 1];
        for (at, reading) in readings.iter().enumerate() {
            let before = steps[at];
            let step = &mut steps[at + 1];
            step.variance = reading.independent;
            step.squared = before.squared + reading.weight * reading.squared;
            step.independent = before.independent + reading.weight * reading.independent;
        }
        for (at, reading) in readings.iter().enumerate().rev() {
            let after = steps[at + 1];
            let step = &mut steps[at];
            step.ratios = after.ratios + reading.weight * reading.squared / reading.independent;
            step.count = after.count + reading.weight;
        }
        Self { steps }
    }

    /// Returns the gain of a pixel whose mean would have this variance by independent samples; 1 if nothing is known.
    pub fn at(&self, variance: f64) -> f64 {
        let next = self.steps.partition_point(|step| step.variance <= variance);
        let step = self.steps[next.max(1) - 1];
        let independent = step.independent + variance * step.count;
        if independent > 0.0 { (step.squared + variance * step.ratios) / independent } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Density, Region};
    use crate::scene::Rgb;

    /// A film of one tile, of whose streams `samples` returns the two samples.
    fn film(samples: impl Fn(usize) -> [f32; 2]) -> Film {
        let mut film = Film::new(Region { x: 0, y: 0, width: 16, height: 16 }, false).unwrap();
        film.place_probes(Density { block: 64, replicas: 1 }, 1, |_| true);
        let probes = &mut film.tiles[0].probes;
        let samples = (0..probes.streams()).flat_map(samples);
        let samples: Vec<Rgb> = samples.map(Rgb::splat).collect();
        probes.add(&samples, 2);
        film
    }

    #[test]
    fn the_gain_is_the_variance_over_that_of_independent_samples() {
        let empty = Film::new(Region { x: 0, y: 0, width: 16, height: 16 }, false).unwrap();
        assert_eq!(Gain::of(&empty, 0).at(0.5), 1.0);
        // The means of the streams are 1 or 2: half the squared difference is 1/2, and half of each
        // stream's variance of 2 is 1.
        let film = film(|stream| [stream % 2, stream % 2 + 2].map(|x| x as f32));
        let gain = Gain::of(&film, 0);
        assert_eq!([0.01, 1.0, 100.0].map(|variance| gain.at(variance)), [0.5; 3]);
    }

    #[test]
    fn edges_of_lights_do_not_hide_noise_beside_them() {
        // Of each second probe the samples are 0 and 1000, whose mean is exact; of others 0 and 1, or 1 and 2.
        let film = film(|stream| {
            let first = (stream % 2) as f32;
            if stream / 2 % 2 == 0 { [0.0, 1000.0] } else { [first, first + 1.0] }
        });
        let gain = Gain::of(&film, 0);
        // Half the squared difference of the means is 1/2; the variance of two samples, halved, is 1/4.
        assert!((gain.at(0.25) - 1.0).abs() < 1e-9, "{}", gain.at(0.25));
        assert!(gain.at(1e9) < 1e-5);
        let variances = [0.0, 1e-3, 0.25, 1.0, 100.0, 1e6];
        assert!(variances.map(|variance| gain.at(variance)).is_sorted_by(|a, b| *a >= b - 1e-9));
    }
}
