//! Savings by adaptive sampling: an adaptive render that stops at an error, compared with a render of
//! the same error that takes equally many samples of every pixel.

use super::Outcome;
use crate::bench::rounds::Times;
use crate::bench::scenes::NamedScene;
use crate::bench::{BenchError, Options};
use spherule_render::film::{Region, TILE};
use spherule_render::image::Image;
use spherule_render::render::{self, Render, RenderError, render};
use spherule_render::scene::{SamplerKind, Settings};
use spherule_render::world::World;

pub(super) const NAME: &str = "converged tiles";

/// First seed of the images that errors are estimated from; nothing else uses it.
const SEED: u64 = 0x6f74_6865_7273;

pub(super) fn measure(scene: NamedScene, options: &Options) -> Result<Outcome, BenchError> {
    let scene = scene.resized(options.pick([32, 240, 640]));
    let world = scene.world()?;
    // Stratified samples depend on the total number of samples.
    let plain = Settings { sampler: SamplerKind::Sobol, ..scene.scene.settings.clone() };
    let until_error = options.pick([0.3, 0.15, 0.03]);
    let spp = options.pick([64, Settings::HARD_SAMPLES, Settings::HARD_SAMPLES]);
    let adaptive = Settings { until_error: Some(until_error), spp, ..plain.clone() };
    let first = draw(&world, &adaptive, true)?;
    check(&world, &plain, &first)
        .map_err(|difference| BenchError::Differ(format!("{}: {difference}", scene.name)))?;
    let spp = samples_to_error(&world, &plain, squared_error(&world, &adaptive)?)?;
    let uniform = Settings { spp, ..plain };
    let times = Times::measure(options.rounds, 2, |contestant| {
        let render = draw(&world, if contestant == 0 { &adaptive } else { &uniform }, false)?;
        if contestant == 1 || render.image == first.image {
            return Ok(render.elapsed.as_secs_f64());
        }
        let name = &scene.name;
        Err(BenchError::Differ(format!("{name}: the image differs with and without statistics")))
    })?;
    let percent = 100.0 * until_error;
    let about = format!(
        "adaptive sampling to an error of {percent} %, compared with {spp} samples of every pixel, \
         which have the same error"
    );
    Ok(Outcome { name: NAME, about, scene: scene.stem(), times })
}

fn draw(world: &World, settings: &Settings, statistics: bool) -> Result<Render, RenderError> {
    render(world, settings, &render::Options { statistics, ..render::Options::default() })
}

/// Checks that each tile equals that of a plain render with as many samples, byte for byte.
fn check(world: &World, plain: &Settings, found: &Render) -> Result<(), String> {
    let samples = found.statistics.iter().flat_map(|statistics| &statistics.samples);
    let samples: Vec<u32> = samples.copied().collect();
    let Settings { width, height, .. } = *plain;
    let steps = |end: u32| (0..end).step_by(TILE as usize).map(move |at| (at, TILE.min(end - at)));
    for (y, height) in steps(height) {
        for (x, width_of) in steps(width) {
            let region = Region { x, y, width: width_of, height };
            let spp = samples.get((y * width + x) as usize).copied().unwrap_or(0);
            let options = render::Options { region: Some(region), ..render::Options::default() };
            let tile = render(world, &Settings { spp, ..plain.clone() }, &options)
                .map_err(|error| error.to_string())?
                .image;
            if tile.pixels != crop(&found.image, region) {
                return Err(format!(
                    "the tile at {x}, {y} differs from a plain render of {spp} samples"
                ));
            }
        }
    }
    Ok(())
}

fn crop(image: &Image, Region { x, y, width, height }: Region) -> Vec<[f32; 3]> {
    let rows = (y..y + height).map(|y| (y * image.width + x) as usize);
    rows.flat_map(|first| &image.pixels[first..first + width as usize]).copied().collect()
}

/// Returns the samples per pixel that give a squared error. Between powers of two, the error is
/// interpolated in log-log space.
fn samples_to_error(world: &World, plain: &Settings, wanted: f64) -> Result<u32, RenderError> {
    let error = |spp: u32| squared_error(world, &Settings { spp, ..plain.clone() });
    let (mut spp, mut before, mut after) = (1, f64::INFINITY, error(1)?);
    while after > wanted && spp < Settings::HARD_SAMPLES {
        spp *= 2;
        (before, after) = (after, error(spp)?);
    }
    let back = (wanted / after).log2() / (before / after).log2();
    Ok((f64::from(spp) * (-back).exp2()).round().max(1.0) as u32)
}

/// Estimates the mean squared error of an image: half the mean squared difference of two seeds.
fn squared_error(world: &World, settings: &Settings) -> Result<f64, RenderError> {
    let pixels = |seed| {
        let render = draw(world, &Settings { seed, ..settings.clone() }, false)?;
        Ok::<_, RenderError>(render.image.pixels.into_flattened())
    };
    let (one, other) = (pixels(SEED)?, pixels(SEED + 1)?);
    let squares = one.iter().zip(&other).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
    Ok(squares.sum::<f64>() / (2.0 * one.len() as f64))
}
