//! The shadow on the ground, separated from the image.

use crate::image::Image;
use crate::render::{self, End, Options, RenderError, ResumableRender};
use crate::scene::Settings;
use crate::world::{CameraVisible, World};

/// The ground without the spheres in front of it.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundLayers {
    /// The visible ground in the light that spheres let through; the environment where it is not
    /// visible.
    pub lit: Image,
    /// Fraction of each pixel's light that spheres block, row by row: 0 without effect, 1 in complete
    /// darkness.
    pub shadow: Vec<f32>,
}

/// Two unfinished renders that show how spheres change the ground's light.
///
/// Both show only the ground: one with the spheres hidden from the camera, the other without spheres.
/// They use the same random numbers, so that unblocked light cancels. Light of emissive spheres counts
/// as negative shadow, which is clamped.
#[derive(Debug)]
pub struct GroundRender {
    lit: ResumableRender,
    bare: ResumableRender,
    without: World,
}

impl GroundRender {
    /// Creates renders without samples; `None` if there is no ground. Of the options, only the region
    /// is used.
    ///
    /// # Errors
    /// Those of [`render()`](crate::render::render()).
    pub fn begin(
        world: &World,
        settings: &Settings,
        options: &Options,
    ) -> Result<Option<Self>, RenderError> {
        render::check(world, settings, options)?;
        if world.ground.is_none() {
            return Ok(None);
        }
        let (settings, options) = plain(settings, options);
        let without = world.without_spheres();
        let lit = ResumableRender::begin(world, &settings, &options)?;
        let bare = ResumableRender::begin(&without, &settings, &options)?;
        Ok(Some(Self { lit, bare, without }))
    }

    /// Takes the samples that they lack; returns false if `options` cancel it. The world must be that
    /// of the beginning, and is unchanged afterwards.
    ///
    /// # Errors
    /// Those of [`render()`](crate::render::render()).
    pub fn run(
        &mut self,
        world: &mut World,
        settings: &Settings,
        options: &Options,
    ) -> Result<bool, RenderError> {
        let (settings, options) = plain(settings, options);
        for (picture, world) in [(&mut self.lit, &*world), (&mut self.bare, &self.without)] {
            if picture.extend(&settings).is_err() {
                *picture = ResumableRender::begin(world, &settings, &options)?;
            }
        }
        let camera_visible = world.camera_visible.replace(CameraVisible::default());
        let lit = self.lit.run(world, &options);
        world.camera_visible = camera_visible;
        Ok(lit != End::Cancelled && self.bare.run(&self.without, &options) != End::Cancelled)
    }

    /// Returns the result so far.
    pub fn ground(&self) -> GroundLayers {
        let (lit, bare) = (self.lit.film().resolve(), self.bare.film().resolve());
        let shadow = blocked(&lit, &bare);
        GroundLayers { lit, shadow }
    }
}

/// Removes settings and options that concern only the image itself.
fn plain<'a>(settings: &Settings, options: &Options<'a>) -> (Settings, Options<'a>) {
    let Options { tracer, region, cancel, .. } = *options;
    let options = Options { tracer, region, cancel, ..Options::default() };
    (Settings { until_error: None, time: None, ..settings.clone() }, options)
}

/// Renders how spheres change the ground's light; `None` if there is no ground, or if the flag of the options cancels
/// it.
///
/// `settings` give the number of samples; only the tracer, the region and the flag of `options` are used. The
/// world is unchanged afterwards.
///
/// # Errors
/// Those of [`render()`](crate::render::render()).
pub fn ground(
    world: &mut World,
    settings: &Settings,
    options: &Options,
) -> Result<Option<GroundLayers>, RenderError> {
    let Some(mut render) = GroundRender::begin(world, settings, options)? else {
        return Ok(None);
    };
    let done = render.run(world, settings, options)?;
    Ok(done.then(|| render.ground()))
}

/// Returns the fraction of one image's light that is missing in the other.
fn blocked(lit: &Image, bare: &Image) -> Vec<f32> {
    let light = |pixel: &[f32; 3]| pixel.iter().sum::<f32>();
    let fraction = |(lit, bare): (&[f32; 3], &[f32; 3])| {
        let (lit, bare) = (light(lit), light(bare));
        if bare > 0.0 { (1.0 - lit / bare).clamp(0.0, 1.0) } else { 0.0 }
    };
    lit.pixels.iter().zip(&bare.pixels).map(fraction).collect()
}
