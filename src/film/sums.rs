//! Sums of radiance in double precision, and of its squares where someone asks how it spreads.

use crate::scene::Rgb;

/// Sums of the samples of several places, each of as many.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    totals: Vec<[f64; 3]>,
    /// Empty if nobody asks for them.
    squares: Vec<[f64; 3]>,
}

impl Sums {
    /// Of `count` places; with sums of squares if `squared`.
    pub fn new(count: usize, squared: bool) -> Self {
        let squares = vec![[0.0; 3]; if squared { count } else { 0 }];
        Self { totals: vec![[0.0; 3]; count], squares }
    }

    /// Adds `count` samples to every place: `radiance` holds those of the first place, then those of
    /// the next. Returns how many were negative or not finite: these count as black.
    pub fn add(&mut self, radiance: &[Rgb], count: u32) -> u64 {
        let count = count as usize;
        let mut bad = 0;
        for (sum, samples) in self.totals.iter_mut().zip(radiance.chunks_exact(count)) {
            for sample in samples {
                let sound = is_sound(sample);
                debug_assert!(sound, "{sample}");
                if sound {
                    for (sum, channel) in sum.iter_mut().zip(sample.to_array()) {
                        *sum += f64::from(channel);
                    }
                } else {
                    bad += 1;
                }
            }
        }
        for (sum, samples) in self.squares.iter_mut().zip(radiance.chunks_exact(count)) {
            for sample in samples.iter().filter(|sample| is_sound(sample)) {
                for (sum, channel) in sum.iter_mut().zip(sample.to_array()) {
                    *sum += f64::from(channel) * f64::from(channel);
                }
            }
        }
        bad
    }

    /// Makes all that every place has `samples` of the same radiance, finite and not negative: what
    /// they are does not depend on how many came at a time.
    pub fn set_even(&mut self, radiance: Rgb, samples: u32) {
        let radiance = radiance.to_array().map(f64::from);
        // Sums of so few equal numbers of single precision do not round.
        self.totals.fill(radiance.map(|channel| channel * f64::from(samples)));
        self.squares.fill(radiance.map(|channel| channel * channel * f64::from(samples)));
    }

    /// Totals and squares.
    pub(super) fn columns(&self) -> [&[f64]; 2] {
        [self.totals.as_flattened(), self.squares.as_flattened()]
    }

    /// The same, to be filled.
    pub(super) fn columns_mut(&mut self) -> [&mut [f64]; 2] {
        [self.totals.as_flattened_mut(), self.squares.as_flattened_mut()]
    }

    /// Mean of each place's samples, of which there are `samples` each; 0 if there are none.
    pub fn means(&self, samples: u32) -> impl ExactSizeIterator<Item = [f64; 3]> + '_ {
        let samples = f64::from(samples.max(1));
        self.totals.iter().map(move |sum| sum.map(|channel| channel / samples))
    }

    /// Variance of a sample at each place, of which there are `samples` each: the unbiased estimate
    /// from sums of squares. Nothing without these, 0 of fewer than two samples.
    pub fn variances(&self, samples: u32) -> impl Iterator<Item = [f64; 3]> + '_ {
        let (count, degrees) = (f64::from(samples.max(1)), f64::from(samples.max(2) - 1));
        self.totals.iter().zip(&self.squares).map(move |(total, squares)| {
            let spread = |channel: usize| squares[channel] - total[channel].powi(2) / count;
            std::array::from_fn(|channel| spread(channel).max(0.0) / degrees)
        })
    }
}

fn is_sound(sample: &Rgb) -> bool {
    sample.is_finite() && sample.min_element() >= 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_variances_are_those_of_the_samples() {
        let mut sums = Sums::new(2, true);
        let samples = [1.0, 2.0, 3.0, 6.0, 7.0, 7.0, 7.0, 7.0];
        assert_eq!(sums.add(&samples.map(Rgb::splat), 4), 0);
        assert_eq!(sums.means(4).collect::<Vec<_>>(), [[3.0; 3], [7.0; 3]]);
        // Squares of the differences: 4 + 1 + 0 + 9, over 3.
        let variances: Vec<_> = sums.variances(4).collect();
        assert!((variances[0][1] - 14.0 / 3.0).abs() < 1e-12 && variances[1] == [0.0; 3]);
    }

    #[test]
    fn even_samples_do_not_spread() {
        let mut sums = Sums::new(1, true);
        sums.set_even(Rgb::new(0.1, 0.2, 0.3), 5);
        sums.set_even(Rgb::new(0.1, 0.2, 0.3), 16);
        let [mean] = sums.means(16).collect::<Vec<_>>()[..] else { panic!("one place") };
        assert_eq!(mean.map(|channel| channel as f32), [0.1, 0.2, 0.3]);
        assert!(sums.variances(16).all(|variance| variance.iter().all(|v| *v < 1e-16)));
        assert_eq!(Sums::new(3, false).variances(4).count(), 0);
    }
}
