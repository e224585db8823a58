//! What was measured in a scene.

use super::reference::{Reference, Squares};
use super::variants::Variant;
use crate::bench::rounds::Times;
use crate::report::{Point, Spread};

/// What was measured in a scene: by variant, then by level of samples.
pub(super) struct Outcome {
    pub(super) scene: String,
    pub(super) reference: Reference,
    pub(super) variants: &'static [Variant],
    /// Samples per pixel of variants that have as many of every pixel.
    pub(super) levels: Vec<u32>,
    pub(super) times: Times,
    /// By contestant and round.
    pub(super) pictures: Vec<Vec<Picture>>,
}

/// How good a picture is, and what it took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Picture {
    pub(super) squares: Squares,
    /// Samples per pixel: the mean.
    pub(super) samples: f64,
    /// Rays per pixel, those of probes too.
    pub(super) rays: f64,
}

impl Outcome {
    pub(super) fn contestant(&self, variant: usize, level: usize) -> usize {
        variant * self.levels.len() + level
    }

    pub(super) fn seconds(&self, variant: usize, level: usize) -> Spread {
        self.times.seconds(self.contestant(variant, level))
    }

    fn spread(&self, variant: usize, level: usize, of: impl Fn(&Picture) -> f64) -> Spread {
        let pictures = self.pictures[self.contestant(variant, level)].iter();
        Spread::of(&pictures.map(of).collect::<Vec<_>>())
    }

    pub(super) fn samples(&self, variant: usize, level: usize) -> Spread {
        self.spread(variant, level, |picture| picture.samples)
    }

    pub(super) fn rays(&self, variant: usize, level: usize) -> Spread {
        self.spread(variant, level, |picture| picture.rays)
    }

    /// Errors without the reference's own; `None` if that is more.
    pub(super) fn error(
        &self,
        variant: usize,
        level: usize,
        of: fn(&Squares) -> f64,
    ) -> Option<Spread> {
        let own = of(&self.reference.error);
        let left = self.spread(variant, level, |picture| of(&picture.squares) - own);
        (left.median > own).then_some(Spread { least: left.least.max(0.0), ..left })
    }

    pub(super) fn rmse(&self, variant: usize, level: usize) -> Option<Spread> {
        self.error(variant, level, |squares| squares.absolute).map(root)
    }

    /// Places and root mean squared errors of all levels that count.
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

    /// 1 / (mean squared error x time), by medians.
    pub(super) fn efficiency(&self, variant: usize, level: usize) -> Option<f64> {
        let square = self.error(variant, level, |squares| squares.absolute)?.median;
        Some(1.0 / (square * self.seconds(variant, level).median))
    }
}

fn root(squares: Spread) -> Spread {
    let Spread { median, least, greatest } = squares;
    Spread { median: median.sqrt(), least: least.sqrt(), greatest: greatest.sqrt() }
}
