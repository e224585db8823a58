//! Results for a scene.

use super::reference::{Reference, SquaredError};
use super::variants::Variant;
use crate::bench::rounds::Times;
use crate::report::{Point, Spread};

/// Results for a scene, indexed by variant, then by level of samples.
pub(super) struct Outcome {
    pub(super) scene: String,
    pub(super) reference: Reference,
    pub(super) variants: &'static [Variant],
    /// Samples per pixel of variants that are not adaptive.
    pub(super) levels: Vec<u32>,
    pub(super) times: Times,
    /// Indexed by contestant and round.
    pub(super) qualities: Vec<Vec<Quality>>,
}

/// Error and cost of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quality {
    pub(super) squares: SquaredError,
    /// Mean samples per pixel.
    pub(super) samples: f64,
    /// Mean rays per pixel, including probes.
    pub(super) rays: f64,
}

impl Outcome {
    pub(super) fn contestant(&self, variant: usize, level: usize) -> usize {
        variant * self.levels.len() + level
    }

    pub(super) fn seconds(&self, variant: usize, level: usize) -> Spread {
        self.times.seconds(self.contestant(variant, level))
    }

    fn spread(&self, variant: usize, level: usize, of: impl Fn(&Quality) -> f64) -> Spread {
        let qualities = self.qualities[self.contestant(variant, level)].iter();
        Spread::from_values(&qualities.map(of).collect::<Vec<_>>())
    }

    pub(super) fn samples(&self, variant: usize, level: usize) -> Spread {
        self.spread(variant, level, |quality| quality.samples)
    }

    pub(super) fn rays(&self, variant: usize, level: usize) -> Spread {
        self.spread(variant, level, |quality| quality.rays)
    }

    /// Returns errors minus the reference's own; `None` if the latter is larger.
    pub(super) fn error(
        &self,
        variant: usize,
        level: usize,
        of: fn(&SquaredError) -> f64,
    ) -> Option<Spread> {
        let own = of(&self.reference.error);
        let rest = self.spread(variant, level, |quality| of(&quality.squares) - own);
        (rest.median > own).then_some(Spread { least: rest.least.max(0.0), ..rest })
    }

    pub(super) fn rmse(&self, variant: usize, level: usize) -> Option<Spread> {
        self.error(variant, level, |squares| squares.absolute).map(root)
    }

    /// Returns x and the root mean squared error of all levels with a known error.
    fn curve(&self, variant: usize, place: impl Fn(usize) -> f64) -> Vec<Point> {
        let point = |level| Some(Point::spread(place(level), self.rmse(variant, level)?));
        (0..self.levels.len()).filter_map(point).collect()
    }

    pub(super) fn over_time(&self, variant: usize) -> Vec<Point> {
        self.curve(variant, |level| self.seconds(variant, level).median)
    }

    pub(super) fn over_samples(&self, variant: usize) -> Vec<Point> {
        self.curve(variant, |level| self.samples(variant, level).median)
    }

    pub(super) fn over_rays(&self, variant: usize) -> Vec<Point> {
        self.curve(variant, |level| self.rays(variant, level).median)
    }

    /// Returns 1 / (mean squared error x time), of the medians.
    pub(super) fn efficiency(&self, variant: usize, level: usize) -> Option<f64> {
        let square = self.error(variant, level, |squares| squares.absolute)?.median;
        Some(1.0 / (square * self.seconds(variant, level).median))
    }
}

fn root(squares: Spread) -> Spread {
    let Spread { median, least, greatest } = squares;
    Spread { median: median.sqrt(), least: least.sqrt(), greatest: greatest.sqrt() }
}
