//! Drawing of a look over rendered images.

use super::{Matte, Overlay, draw_over, ground};
use crate::film::Region;
use crate::image::Image;
use crate::layers::{self, Layer, layers};
use crate::render::{Options, Render, RenderError};
use crate::scene::{Look, Settings};
use crate::world::World;
use std::sync::atomic::AtomicBool;

/// An image with its matte, for overlays.
pub struct Canvas<'a> {
    /// The image that is drawn on.
    pub image: &'a mut Image,
    /// The part of each pixel that is not background, with premultiplied colors; `None` for an opaque image.
    pub matte: Option<Matte>,
}

impl<'a> Canvas<'a> {
    /// Draws the overlays of a look over a rendered region. Once the flag is set, no rays are traced for them, since
    /// who interrupts does not want to wait: nothing is drawn, or the background is removed by one sample per pixel,
    /// without the shadows on the ground.
    ///
    /// # Errors
    /// Those of [`render()`](crate::render::render()).
    pub fn with_look(
        look: &Look,
        world: &mut World,
        settings: &Settings,
        region: Region,
        render: &'a mut Render,
        cancel: &AtomicBool,
    ) -> Result<Self, RenderError> {
        let (most, mean) = (render.samples.most, mean_samples(region, render));
        let image = &mut render.image;
        if look.is_plain() {
            return Ok(Self { image, matte: None });
        }
        let whole = Options { region: Some(region), ..Options::default() };
        let options = Options { cancel: Some(cancel), ..whole };
        let floor = Settings { spp: mean, ..settings.clone() };
        let ground = if look.is_transparent() { ground(world, &floor, &options)? } else { None };
        let traced = |samples, options| {
            layers(world, &settings_of_layers(settings, samples), options, &[Layer::Depth])
        };
        let mut layers = traced(most, &options)?;
        if layers.pixels.is_empty() {
            if !look.is_transparent() {
                return Ok(Self { image, matte: None });
            }
            layers = traced(1, &whole)?;
        }
        let overlay = Overlay { world, region, layers: &layers, depths: None };
        let matte = overlay.draw_look(image, look, ground);
        Ok(Self { image, matte })
    }

    /// Draws over the image.
    pub fn draw(&mut self, draw: impl Fn(&mut Image)) {
        draw_over(self.image, self.matte.as_mut(), draw);
    }
}

/// Returns the settings for the layers of an image with this many samples.
pub fn settings_of_layers(settings: &Settings, samples: u32) -> Settings {
    Settings { spp: samples.clamp(1, layers::SAMPLES), ..settings.clone() }
}

/// Returns the mean number of samples per pixel.
fn mean_samples(region: Region, render: &Render) -> u32 {
    let pixels = u64::from(region.width) * u64::from(region.height);
    render.samples.total.div_ceil(pixels.max(1)).clamp(1, u64::from(Settings::HARD_SAMPLES)) as u32
}
