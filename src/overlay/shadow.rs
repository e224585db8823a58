//! The shadow on the ground, by itself: how much of its light spheres take.

use crate::image::Image;
use crate::render::{self, End, Options, RenderError, ResumableRender};
use crate::scene::Settings;
use crate::world::{CameraVisible, World};

/// The ground without the spheres that are before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// What is seen of it, in the light that spheres leave; the sky where it is not seen.
    pub lit: Image,
    /// The share of each pixel's light that spheres keep from it, row by row: 0 where nothing
    /// changes, 1 in the dark.
    pub shadow: Vec<f32>,
}

/// Two pictures that tell how spheres change the ground's light, as far as they are.
///
/// Both are of the ground alone: with the spheres there but hidden from the camera, and without
/// them. They take the same random numbers, so that light which nothing is in the way of cancels.
/// The light of spheres that glow counts as what they keep, with its sign: more light is no shadow.
#[derive(Debug)]
pub struct GroundRender {
    lit: ResumableRender,
    bare: ResumableRender,
    without: World,
}

impl GroundRender {
    /// Pictures without samples yet; `None` if there is no ground. Of the options, only the region
    /// counts.
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

    /// Takes the samples that they lack; false if `options` say that this is cancelled. The world is
    /// that of the beginning, and the same afterwards.
    ///
    /// # Errors
    /// Those of [`render()`](crate::render::render()).
    pub fn go_on(
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

    /// What they tell.
    pub fn ground(&self) -> Ground {
        let (lit, bare) = (self.lit.film().resolve(), self.bare.film().resolve());
        let shadow = kept(&lit, &bare);
        Ground { lit, shadow }
    }
}

/// Without what is for the picture itself.
fn plain<'a>(settings: &Settings, options: &Options<'a>) -> (Settings, Options<'a>) {
    let Options { tracer, region, cancel, .. } = *options;
    let options = Options { tracer, region, cancel, ..Options::default() };
    (Settings { until_error: None, time: None, ..settings.clone() }, options)
}

/// Finds out how spheres change the ground's light; `None` if there is no ground.
///
/// `settings` say how many samples there are; only the tracer and the region of `options` count.
/// The world is the same afterwards.
///
/// # Errors
/// Those of [`render()`](crate::render::render()).
pub fn ground(
    world: &mut World,
    settings: &Settings,
    options: &Options,
) -> Result<Option<Ground>, RenderError> {
    let options = Options { cancel: None, ..*options };
    let Some(mut render) = GroundRender::begin(world, settings, &options)? else {
        return Ok(None);
    };
    render.go_on(world, settings, &options)?;
    Ok(Some(render.ground()))
}

/// What is missing in one picture beside another, as a share.
fn kept(lit: &Image, bare: &Image) -> Vec<f32> {
    let light = |pixel: &[f32; 3]| pixel.iter().sum::<f32>();
    let share = |(lit, bare): (&[f32; 3], &[f32; 3])| {
        let (lit, bare) = (light(lit), light(bare));
        if bare > 0.0 { (1.0 - lit / bare).clamp(0.0, 1.0) } else { 0.0 }
    };
    lit.pixels.iter().zip(&bare.pixels).map(share).collect()
}
