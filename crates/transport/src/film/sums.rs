//! Sums of radiance, and optionally of its squares for the variance.
//!
//! They are exact, so that samples may come in any order and from any number of machines. That costs
//! next to nothing: single precision has 24 bits and double precision 53, so a few samples add up
//! without rounding unless their sum is more than 2^29 times the least of them.

use super::exact::{ExactSums, two_sum};
use crate::color::Rgb;
use crate::lanes::{F32x16, F64x8, Lanes, MAX_LANES, widen};

/// Maximum ratio of a sum to its least sample for which the sum is certainly not rounded: the bits of
/// double precision beyond those of single precision.
const EXACT_RATIO: f64 = (1_u32 << 29) as f64;

/// Maximum number of equal squares, of 48 bits each, whose sum fits into double precision.
const EXACT_SQUARES: u32 = 32;

/// An array of sums of equal numbers of samples.
#[derive(Clone, Debug, Default)]
pub struct Sums {
    totals: ExactSums,
    /// Empty if squares are not needed.
    squares: ExactSums,
}

impl Sums {
    /// Creates `count` sums; with sums of squares if `squared`.
    pub fn new(count: usize, squared: bool) -> Self {
        let squares = ExactSums::new(if squared { count } else { 0 });
        Self { totals: ExactSums::new(count), squares }
    }

    /// Adds `count` samples to every sum: `radiance` holds those of the first sum, then those of the
    /// next. Returns the number of samples that were negative or not finite, which count as black.
    pub fn add(&mut self, radiance: &[Rgb], count: u32) -> u64 {
        let samples = radiance.chunks_exact(count as usize).enumerate();
        samples.map(|(index, samples)| self.add_to(index, samples)).sum()
    }

    /// Adds samples to one sum; otherwise as [`Sums::add`].
    pub fn add_to(&mut self, index: usize, samples: &[Rgb]) -> u64 {
        let mut bad = 0;
        match plain_sum(samples) {
            Some(sum) => self.totals.add(index, sum),
            None => bad = self.add_each(index, samples),
        }
        if !self.squares.is_empty() {
            let squares = || samples.iter().filter(|s| is_valid(s)).map(|s| square(*s));
            match double_sum(squares()) {
                Some(sums) => self.add_squares(index, sums),
                None => squares().for_each(|square| self.squares.add(index, square)),
            }
        }
        bad
    }

    /// Adds the exact sum of samples to one sum; that of their squares is the sum of both.
    pub fn add_exact(&mut self, index: usize, total: [f64; 3], squares: [[f64; 3]; 2]) {
        self.totals.add(index, total);
        if !self.squares.is_empty() {
            self.add_squares(index, squares);
        }
    }

    fn add_squares(&mut self, index: usize, sums: [[f64; 3]; 2]) {
        for sum in sums {
            self.squares.add(index, sum);
        }
    }

    /// Adds samples to a sum one by one, and returns the number of invalid ones.
    #[cold]
    fn add_each(&mut self, index: usize, samples: &[Rgb]) -> u64 {
        let mut bad = 0;
        for sample in samples {
            debug_assert!(is_valid(sample), "{sample}");
            if is_valid(sample) {
                self.totals.add(index, double(*sample));
            } else {
                bad += 1;
            }
        }
        bad
    }

    /// Adds `count` samples of the same radiance, finite and not negative, to every sum.
    pub fn add_even(&mut self, radiance: Rgb, count: u32) {
        for first in (0..count).step_by(EXACT_SQUARES as usize) {
            let count = f64::from(EXACT_SQUARES.min(count - first));
            let each = |sums: &mut ExactSums, value: [f64; 3]| {
                (0..sums.len()).for_each(|index| sums.add(index, value.map(|x| x * count)));
            };
            each(&mut self.totals, double(radiance));
            each(&mut self.squares, square(radiance));
        }
    }

    /// Adds the sums of other samples. Returns false if the numbers of sums differ.
    pub fn merge(&mut self, other: &Self) -> bool {
        self.totals.merge(&other.totals) && self.squares.merge(&other.squares)
    }

    /// Returns totals and squares.
    pub(super) fn exact_sums(&self) -> [&ExactSums; 2] {
        [&self.totals, &self.squares]
    }

    /// Returns totals and squares, for filling.
    pub(super) fn exact_sums_mut(&mut self) -> [&mut ExactSums; 2] {
        [&mut self.totals, &mut self.squares]
    }

    /// Returns the mean of each sum's samples, whose number is `samples`; 0 if there are none.
    pub fn means(&self, samples: u32) -> impl ExactSizeIterator<Item = [f64; 3]> + '_ {
        let samples = f64::from(samples.max(1));
        self.totals.rounded().map(move |sum| sum.map(|channel| channel / samples))
    }

    /// Returns the variance of a sample for each sum of `samples` samples: the unbiased estimate from
    /// sums of squares. Empty without these, 0 for fewer than two samples.
    pub fn variances(&self, samples: u32) -> impl Iterator<Item = [f64; 3]> + '_ {
        let (count, degrees) = (f64::from(samples.max(1)), f64::from(samples.max(2) - 1));
        self.totals.rounded().zip(self.squares.rounded()).map(move |(total, squares)| {
            let spread = |channel: usize| squares[channel] - total[channel].powi(2) / count;
            std::array::from_fn(|channel| spread(channel).max(0.0) / degrees)
        })
    }
}

fn is_valid(sample: &Rgb) -> bool {
    sample.is_finite() && sample.min_element() >= 0.0
}

fn double(color: Rgb) -> [f64; 3] {
    color.to_array().map(f64::from)
}

/// Exact: twice 24 bits.
fn square(color: Rgb) -> [f64; 3] {
    double(color).map(|channel| channel * channel)
}

/// Returns the sum of samples, unless it might be rounded or a sample is invalid.
fn plain_sum(samples: &[Rgb]) -> Option<[f64; 3]> {
    let (rows, rest) = samples.as_chunks();
    let mut total = if rows.is_empty() { Total::default() } else { Total::of_rows(rows) };
    for sample in rest {
        total.add(*sample);
    }
    total.exact()
}

/// A sum of samples, with bounds that show whether it is exact.
struct Total {
    sum: [f64; 3],
    /// The minimum, if it is less than 0.
    low: f32,
    /// The least positive number.
    least: f32,
}

impl Default for Total {
    fn default() -> Self {
        Self { sum: [0.0; 3], low: 0.0, least: f32::INFINITY }
    }
}

impl Total {
    /// Adds sixteen samples at a time, which are three rows of lanes.
    fn of_rows(rows: &[[Rgb; MAX_LANES]]) -> Self {
        let (zero, none) = (F32x16::splat(0.0), F32x16::splat(f32::INFINITY));
        let mut sum = [F64x8::splat(0.0); 3];
        let (mut low, mut least) = (zero, none);
        for row in rows {
            let [a, b, c]: [F32x16; 3] = bytemuck::cast(*row);
            for x in [a, b, c] {
                low = Lanes::min(x, low);
                least = Lanes::min(least, Lanes::select(Lanes::lt(zero, x), x, none));
            }
            // After eight numbers, and after sixteen, the lanes belong to another channel; after 24 to
            // the same.
            let ([a, b], [c, d], [e, f]) = (widen(a), widen(b), widen(c));
            sum = [sum[0] + (a + d), sum[1] + (b + e), sum[2] + (c + f)];
        }
        let each: [[f64; 3]; 8] = bytemuck::cast(sum);
        let add = |a: [f64; 3], b: [f64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
        Self {
            sum: each.into_iter().fold([0.0; 3], add),
            low: -(-low).greatest(),
            least: -(-least).greatest(),
        }
    }

    fn add(&mut self, sample: Rgb) {
        for (sum, value) in self.sum.iter_mut().zip(sample.to_array()) {
            *sum += f64::from(value);
            self.low = self.low.min(value);
            self.least = self.least.min(if value > 0.0 { value } else { f32::INFINITY });
        }
    }

    /// Returns the sum, if it is exact in any order of addition and all samples are valid.
    fn exact(&self) -> Option<[f64; 3]> {
        // All samples, and so all partial sums, are integer multiples of the last place of the least.
        let bound = EXACT_RATIO * f64::from(self.least);
        let exact = self.sum.iter().all(|&sum| sum.is_finite() && sum <= bound);
        (exact && self.low >= 0.0).then_some(self.sum)
    }
}

/// Returns the sum of numbers in two levels, unless the second might be rounded.
fn double_sum(terms: impl Iterator<Item = [f64; 3]>) -> Option<[[f64; 3]; 2]> {
    let (mut high, mut low, mut lost) = ([0.0; 3], [0.0; 3], false);
    for terms in terms {
        for (channel, term) in terms.into_iter().enumerate() {
            let (error, rest);
            (high[channel], error) = two_sum(high[channel], term);
            (low[channel], rest) = two_sum(low[channel], error);
            lost |= rest != 0.0;
        }
    }
    (!lost).then_some([high, low])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_of_samples_add_up_to_the_same_bits() {
        // Over forty decades, so that every path of the addition is tested.
        let sample = |i: u32| {
            let size = |k: u32| 10f32.powi((i * k % 41) as i32 - 20);
            Rgb::new(size(7), 0.1 * size(1), 1.0 / (1 + i) as f32)
        };
        let samples: Vec<Rgb> = (0..240).map(sample).collect();
        let mut whole = Sums::new(1, true);
        whole.add(&samples, 240);
        let mut merged = Sums::new(1, true);
        for group in samples.chunks(17).rev() {
            let mut part = Sums::new(1, true);
            group.chunks(5).for_each(|few| assert_eq!(part.add(few, few.len() as u32), 0));
            assert!(merged.merge(&part));
        }
        assert!(whole.means(240).eq(merged.means(240)));
        assert!(whole.variances(240).eq(merged.variances(240)));
    }

    #[test]
    fn samples_that_differ_much_are_added_without_rounding() {
        let [large, small] = [1e20_f32, 1e-20];
        for samples in [[large, small, small], [small, large, small], [small, small, large]] {
            let mut sums = Sums::new(1, false);
            sums.add(&samples.map(Rgb::splat), 3);
            sums.add(&[Rgb::ZERO; 3], 3);
            let parts: f64 = sums.totals.levels().iter().skip(1).map(|level| level[0][0]).sum();
            assert_eq!(parts, 2.0 * f64::from(small));
        }
    }

    #[test]
    fn even_samples_in_any_steps_are_the_same() {
        let color = Rgb::new(0.1, 123.456, 7e-30);
        let [mut a, mut b] = [Sums::new(2, true), Sums::new(2, true)];
        a.add_even(color, 1000);
        (0..1000).for_each(|_| b.add_even(color, 1));
        assert!(a.means(1000).eq(b.means(1000)) && a.variances(1000).eq(b.variances(1000)));
    }

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
        sums.add_even(Rgb::new(0.1, 0.2, 0.3), 5);
        sums.add_even(Rgb::new(0.1, 0.2, 0.3), 11);
        let [mean] = sums.means(16).collect::<Vec<_>>()[..] else { panic!("one sum") };
        assert_eq!(mean.map(|channel| channel as f32), [0.1, 0.2, 0.3]);
        assert!(sums.variances(16).all(|variance| variance.iter().all(|v| *v < 1e-16)));
        assert_eq!(Sums::new(3, false).variances(4).count(), 0);
    }
}
