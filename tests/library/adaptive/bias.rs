//! Bias of adaptive sampling: the mean of each pixel over many renders, compared with plain renders.

use super::{caustic, with_target};
use crate::common::*;
use spherule_render::image::Image;
use spherule_render::render::{End, Options, Render, render};
use spherule_render::scene::{Scene, Settings};
use spherule_render::world::World;
use std::sync::OnceLock;

/// Probability of a failure without bias, one in a million for either number, and the corresponding normal
/// quantile.
const QUANTILE: f64 = 4.75;

/// Light that few paths find, in two tiles: of 32 pixels and of four.
fn scene() -> Scene {
    let mut scene = caustic();
    (scene.settings.width, scene.settings.height) = (18, 2);
    scene
}

/// Mean and squared standard error of each pixel.
struct Means(Vec<[f64; 2]>);

impl Means {
    fn of(pictures: impl Iterator<Item = Image>) -> Self {
        let (mut sums, mut count) = (Vec::new(), 0.0);
        for picture in pictures {
            sums.resize(picture.pixels.len(), [0.0; 2]);
            for (sum, pixel) in sums.iter_mut().zip(&picture.pixels) {
                let value = f64::from(pixel[0]);
                *sum = [sum[0] + value, sum[1] + value * value];
            }
            count += 1.0;
        }
        let of_sum = |[sum, squares]: [f64; 2]| {
            let mean: f64 = sum / count;
            [mean, (squares / count - mean * mean) / (count - 1.0)]
        };
        Self(sums.into_iter().map(of_sum).collect())
    }

    /// Returns two numbers that are normally distributed if both have the same expected values: the sum of
    /// squared differences of pixels relative to their errors (by the cube root, after Wilson and Hilferty,
    /// "The Distribution of Chi-Square", PNAS 1931), and the sum of the differences.
    fn against(&self, other: &Self) -> [f64; 2] {
        let pairs = self.0.iter().zip(&other.0);
        let off = pairs.map(|(a, b)| (a[0] - b[0]) / (a[1] + b[1]).sqrt());
        let (count, spread) = (self.0.len() as f64, 2.0 / (9.0 * self.0.len() as f64));
        let squares: f64 = off.clone().map(|off| off * off).sum();
        let cube = ((squares / count).cbrt() - (1.0 - spread)) / spread.sqrt();
        [cube, off.sum::<f64>() / count.sqrt()]
    }
}

fn shots(scene: &Scene, settings: Settings, statistics: bool) -> impl Fn(u64) -> Render + use<> {
    let world = World::build(scene).expect("the scene is sound");
    move |seed| {
        let settings = Settings { seed, ..settings.clone() };
        render(&world, &settings, &Options { statistics, ..Options::default() })
            .expect("settings in range")
    }
}

fn plain(scene: &Scene, spp: u32, statistics: bool) -> impl Fn(u64) -> Render + use<> {
    shots(scene, Settings { spp, ..scene.settings.clone() }, statistics)
}

/// Returns means and errors of plain renders of the scene.
fn truth() -> &'static Means {
    static TRUTH: OnceLock<Means> = OnceLock::new();
    TRUTH.get_or_init(|| {
        let shot = plain(&scene(), 1024, false);
        Means::of((0..100).map(|seed| shot(1_000_000 + seed).image))
    })
}

#[test]
fn no_pixel_is_biased_by_stopping() {
    let scene = scene();
    let adaptive = with_target(scene.clone(), 0.4);
    let shot = shots(&adaptive, adaptive.settings.clone(), false);
    let (mut fewest, mut most) = (u32::MAX, 0);
    let pictures = (0..400).map(|seed| {
        let render = shot(seed);
        assert_eq!(render.end, End::Error);
        (fewest, most) = (fewest.min(render.samples.least), most.max(render.samples.most));
        render.image
    });
    let found = Means::of(pictures).against(truth());
    assert!(found[0] < QUANTILE && found[1].abs() < QUANTILE, "{found:?}");
    assert!(most >= 8 * fewest, "{fewest} to {most} samples decide nothing");
}

/// The same numbers detect bias if samples decide on their own number: here an image stops after its first 32
/// samples if their own estimate of the error is small.
#[test]
fn bias_would_be_detected() {
    let scene = scene();
    let (few, many) = (plain(&scene, 32, true), plain(&scene, 256, false));
    let mut early = 0;
    let pictures = (0..400).map(|seed| {
        let first = few(seed);
        let variance = first.statistics.as_ref().map_or(0.0, |all| mean(&all.variance));
        if variance.sqrt() > 0.5 * mean(&first.image) {
            return many(seed).image;
        }
        early += 1;
        first.image
    });
    let found = Means::of(pictures).against(truth());
    assert!(found[0] > 1.5 * QUANTILE && found[1] < -QUANTILE, "{found:?}");
    assert!((40..360).contains(&early), "{early}");
}
