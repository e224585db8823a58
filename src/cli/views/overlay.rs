//! Drawing of overlays over rendered images.

use spherule_render::World;
use spherule_render::film::Region;
use spherule_render::image::Image;
use spherule_render::layers::{self, Layer, layers};
use spherule_render::overlay::{self, Matte, Overlay, ground};
use spherule_render::render::{Options, Render, RenderError};
use spherule_render::scene::{Look, Settings};

/// An image with its matte, for overlays.
pub(in crate::cli) struct Canvas<'a> {
    pub(in crate::cli) image: &'a mut Image,
    /// The part of each pixel that is not background, with premultiplied colors; `None` for an opaque image.
    pub(in crate::cli) matte: Option<Matte>,
}

impl Canvas<'_> {
    /// Draws over the image.
    pub(in crate::cli) fn draw(&mut self, draw: impl Fn(&mut Image)) {
        overlay::draw_over(self.image, self.matte.as_mut(), draw);
    }
}

/// Draws the overlays of a look over a rendered region.
pub(in crate::cli) fn draw_over<'i>(
    look: &Look,
    world: &mut World,
    settings: &Settings,
    region: Region,
    render: &'i mut Render,
) -> Result<Canvas<'i>, RenderError> {
    let (most, mean) = (render.samples.most, mean_samples(region, render));
    let image = &mut render.image;
    if look.is_plain() {
        return Ok(Canvas { image, matte: None });
    }
    let options = Options { region: Some(region), ..Options::default() };
    let floor = Settings { spp: mean, ..settings.clone() };
    let ground = if look.is_transparent() { ground(world, &floor, &options)? } else { None };
    let layers = layers(world, &settings_of_layers(settings, most), &options, &[Layer::Depth])?;
    let overlay = Overlay { world, region, layers: &layers, depths: None };
    let matte = overlay.draw_look(image, look, ground);
    Ok(Canvas { image, matte })
}

/// Returns the settings for the layers of an image with this many samples.
pub(in crate::cli) fn settings_of_layers(settings: &Settings, samples: u32) -> Settings {
    Settings { spp: samples.clamp(1, layers::SAMPLES), ..settings.clone() }
}

/// Returns the mean number of samples per pixel.
fn mean_samples(region: Region, render: &Render) -> u32 {
    let pixels = u64::from(region.width) * u64::from(region.height);
    render.samples.total.div_ceil(pixels.max(1)).clamp(1, u64::from(Settings::HARD_SAMPLES)) as u32
}
