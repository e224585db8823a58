//! Features of the picture's own camera rays, which the denoiser predicts radiance from.

use super::{Film, Tile};
use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of samples of a pixel for features and layers: an edge then has 256 levels.
pub const SAMPLES: u32 = 256;

/// Place of the last bit of a sum: sums of [`SAMPLES`] numbers up to 1 fit.
const UNIT: f32 = 1.0 / (1 << 22) as f32;

/// A number whose last place is [`UNIT`], and so are those of its sums with numbers from -1 to 1.
const ROUNDER: f32 = 3.0;

/// Sums of the features of a pixel's samples: integers, so that they don't depend on the order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FeatureSums {
    albedo: [i32; 3],
    normal: [i32; 3],
    coverage: i32,
}

/// Means of the features of a pixel: see `Features` of the layers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MeanFeatures {
    /// Linear RGB.
    pub albedo: [f32; 3],
    /// Mean unit normal on the side that is seen.
    pub normal: [f32; 3],
    /// Fraction of the rays that hit anything.
    pub coverage: f32,
}

/// The features of a tile's pixels, and the samples that they are of.
#[derive(Clone, Debug, Default)]
pub struct TileFeatures {
    recorded: SampleSet,
    /// In the order of [`Tile::pixels`]; empty if all are 0.
    sums: Vec<FeatureSums>,
}

/// A set of samples, by their indices below [`SAMPLES`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SampleSet([u64; WORDS]);

const WORDS: usize = SAMPLES.div_ceil(u64::BITS) as usize;

impl FeatureSums {
    /// Adds samples that hit surfaces of the same albedo, with the components of their normals.
    #[inline(always)]
    pub(crate) fn add_covered(&mut self, albedo: [f32; 3], normal: [&[f32]; 3]) {
        let count = normal[0].len() as i32;
        for channel in 0..3 {
            self.albedo[channel] += count * in_units(albedo[channel]);
            self.normal[channel] += normal[channel].iter().map(|&x| in_units(x)).sum::<i32>();
        }
        self.coverage += count * in_units(1.0);
    }

    /// Adds the same, of which each sample counts by a coverage from 0 to 1.
    pub fn add(&mut self, albedo: [f32; 3], normal: [&[f32]; 3], coverages: &[f32]) {
        for (row, &coverage) in coverages.iter().enumerate() {
            for channel in 0..3 {
                self.albedo[channel] += in_units(coverage * albedo[channel]);
                self.normal[channel] += in_units(coverage * normal[channel][row]);
            }
            self.coverage += in_units(coverage);
        }
    }

    /// Adds other sums.
    fn merge(&mut self, other: &Self) {
        for (sum, value) in self.columns_mut().zip(other.columns()) {
            *sum += value;
        }
    }

    /// Returns the means of `count` samples.
    fn mean(&self, count: u32) -> MeanFeatures {
        let weight = f64::from(UNIT) / f64::from(count.max(1));
        let mean = |sum: i32| (f64::from(sum) * weight) as f32;
        MeanFeatures {
            albedo: self.albedo.map(mean),
            normal: self.normal.map(mean),
            coverage: mean(self.coverage),
        }
    }

    fn columns(self) -> impl Iterator<Item = i32> {
        self.albedo.into_iter().chain(self.normal).chain([self.coverage])
    }

    fn columns_mut(&mut self) -> impl Iterator<Item = &mut i32> {
        self.albedo.iter_mut().chain(&mut self.normal).chain([&mut self.coverage])
    }
}

/// Returns a number from -1 to 1, rounded to a multiple of [`UNIT`], in such units.
#[inline(always)]
fn in_units(value: f32) -> i32 {
    (value.clamp(-1.0, 1.0) + ROUNDER).to_bits() as i32 - ROUNDER.to_bits() as i32
}

impl SampleSet {
    /// Returns the set of the first `count` samples, at most [`SAMPLES`].
    pub fn first(count: u32) -> Self {
        let mut set = Self::default();
        set.insert(0..count);
        set
    }

    /// Adds a range of samples, of which those from [`SAMPLES`] on are left out.
    pub(crate) fn insert(&mut self, samples: Range<u32>) {
        for sample in samples.start..samples.end.min(SAMPLES) {
            self.0[(sample / u64::BITS) as usize] |= 1 << (sample % u64::BITS);
        }
    }

    /// Returns the number of samples.
    pub(crate) fn count(self) -> u32 {
        self.0.iter().map(|word| word.count_ones()).sum()
    }

    /// Returns the samples of either set.
    pub fn union(self, other: Self) -> Self {
        Self(std::array::from_fn(|word| self.0[word] | other.0[word]))
    }

    /// Returns the samples that are not in the other set.
    pub fn without(self, other: Self) -> Self {
        Self(std::array::from_fn(|word| self.0[word] & !other.0[word]))
    }

    /// Returns whether a sample is in both sets.
    pub fn overlaps(self, other: Self) -> bool {
        self.without(other) != self
    }

    /// Returns the set as ranges of consecutive samples, each of at most `most`, in order.
    pub fn ranges(self, most: u32) -> impl Iterator<Item = Range<u32>> {
        let mut next = 0;
        std::iter::from_fn(move || {
            let start = (next..SAMPLES).find(|&sample| self.contains(sample))?;
            let limit = SAMPLES.min(start + most);
            let end = (start..limit).find(|&sample| !self.contains(sample)).unwrap_or(limit);
            next = end;
            Some(start..end)
        })
    }

    fn contains(self, sample: u32) -> bool {
        self.0[(sample / u64::BITS) as usize] >> (sample % u64::BITS) & 1 != 0
    }
}

impl TileFeatures {
    /// Returns the samples whose features are known.
    pub fn recorded(&self) -> SampleSet {
        self.recorded
    }

    /// Adds samples; `sums` has those of each pixel, in the order of [`Tile::pixels`], or is empty if no ray hits
    /// anything.
    pub fn add(&mut self, samples: Range<u32>, sums: &[FeatureSums]) {
        self.recorded.insert(samples);
        if self.sums.is_empty() {
            self.sums.extend_from_slice(sums);
        } else {
            self.sums.iter_mut().zip(sums).for_each(|(sum, more)| sum.merge(more));
        }
    }

    /// Forgets all samples.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Returns the means of the pixels, in their order, over the samples of both, which have none in common. It does not
    /// end.
    pub fn means_with(&self, other: &Self) -> impl Iterator<Item = MeanFeatures> {
        let count = self.recorded.union(other.recorded).count();
        (0..).map(move |pixel| {
            let mut sums = self.sums.get(pixel).copied().unwrap_or_default();
            other.sums.get(pixel).iter().for_each(|more| sums.merge(more));
            sums.mean(count)
        })
    }
}

impl Film {
    /// Makes all tiles keep the features of the samples that are added from now on.
    pub fn keep_features(&mut self) {
        self.tiles.par_iter_mut().for_each(|tile| {
            tile.features.get_or_insert_default();
        });
    }
}

impl Tile {
    /// Returns whether the features of these samples can be recorded.
    pub fn records(samples: &Range<u32>) -> bool {
        samples.end <= SAMPLES
    }

    /// Returns whether the tile keeps features.
    pub fn keeps_features(&self) -> bool {
        self.features.is_some()
    }

    /// Adds the features of samples, as [`TileFeatures::add`], if they are kept and can be recorded.
    pub fn add_features(&mut self, samples: Range<u32>, sums: &[FeatureSums]) {
        if let Some(features) = self.features.as_mut().filter(|_| Self::records(&samples)) {
            features.add(samples, sums);
        }
    }

    /// Returns the features that are recorded.
    pub fn features(&self) -> &TileFeatures {
        static NONE: TileFeatures =
            TileFeatures { recorded: SampleSet([0; WORDS]), sums: Vec::new() };
        self.features.as_ref().unwrap_or(&NONE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_those_of_rounded_numbers() {
        for value in [-1.0, -0.7, -1e-9, 0.0, 1e-7, 0.1, 0.5, 0.999_999_9, 1.0_f32] {
            let exact = f64::from(value) / f64::from(UNIT);
            assert!((f64::from(in_units(value)) - exact).abs() <= 0.5, "{value}");
        }
        let mut sums = FeatureSums::default();
        let normal = [-1.0, 0.0, 0.25];
        let columns = normal.map(|x| [x; SAMPLES as usize]);
        sums.add_covered([1.0; 3], columns.each_ref().map(<[f32; SAMPLES as usize]>::as_slice));
        let whole = MeanFeatures { albedo: [1.0; 3], normal, coverage: 1.0 };
        assert_eq!(sums.mean(SAMPLES), whole);
        let half = columns.each_ref().map(|column| &column[..1]);
        let mut sums = FeatureSums::default();
        sums.add([0.5, 0.25, 0.0], half, &[0.5]);
        let normal = [-0.5, 0.0, 0.125];
        let expected = MeanFeatures { albedo: [0.25, 0.125, 0.0], normal, coverage: 0.5 };
        assert_eq!(sums.mean(1), expected);
    }

    #[test]
    fn sets_of_samples_are_divided_into_ranges() {
        let mut set = SampleSet::first(20);
        set.insert(63..70);
        set.insert(250..400);
        assert_eq!(set.count(), 20 + 7 + 6);
        let ranges: Vec<_> = set.ranges(16).collect();
        assert_eq!(ranges, [0..16, 16..20, 63..70, 250..256]);
        let rest = set.without(SampleSet::first(66));
        assert_eq!(rest.ranges(16).collect::<Vec<_>>(), [66..70, 250..256]);
        assert!(set.overlaps(SampleSet::first(1)) && !rest.overlaps(SampleSet::first(66)));
        assert_eq!(rest.union(SampleSet::first(66)).count(), 66 + 4 + 6);
    }
}
