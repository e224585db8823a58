//! Drawing of a look over rendered images.

use super::sky::{clear_unsampled, fill_unsampled};
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
    /// Draws the overlays of a look over a rendered region, and the background where it has no sample. Once the flag is set, no rays are traced for them, since
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
        fill_unsampled(world, region, render);
        if look.is_plain() {
            return Ok(Self { image: &mut render.image, matte: None });
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
                return Ok(Self { image: &mut render.image, matte: None });
            }
            layers = traced(1, &whole)?;
        }
        let overlay = Overlay { world, region, layers: &layers, depths: None };
        let mut matte = overlay.draw_look(&mut render.image, look, ground);
        if let Some(matte) = &mut matte {
            clear_unsampled(region, render, matte);
        }
        Ok(Self { image: &mut render.image, matte })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::ResumableRender;
    use crate::scene::{Background, Rgb, Scene};

    const WHOLE: Region = Region { x: 0, y: 0, width: 40, height: 24 };

    fn drawn(background: Background) -> (Render, Option<Matte>, Rgb) {
        let text = "[[sphere]]\ncenter = [0, 0, 0]\nradius = 1\n[camera]\nprojection = \"orthographic\"\n\
                    [environment]\ncolor = [0.25, 0.5, 0.75]\n";
        let mut scene = Scene::parse(text, "sphere.toml", std::path::Path::new("")).unwrap();
        scene.look.background = background;
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (40, 24, 1);
        let mut world = World::build(&scene).unwrap();
        let (settings, look) = (&scene.settings, &scene.look);
        let begun = ResumableRender::begin(&world, settings, &Options::default()).unwrap();
        let mut render = begun.render();
        assert_eq!((render.unsampled.len(), render.sampled_share()), (6, 0.0));
        // The lower right tile alone, of which two thirds of the columns are in the picture.
        render.unsampled.retain(|tile| tile.x == 32 && tile.y == 16);
        assert_eq!(render.sampled_share(), 1.0 - 64.0 / 960.0);
        render.image.pixels.fill([9.0; 3]);
        let never = AtomicBool::new(false);
        let canvas = Canvas::with_look(look, &mut world, settings, WHOLE, &mut render, &never);
        let matte = canvas.unwrap().matte;
        (render, matte, Rgb::new(0.25, 0.5, 0.75))
    }

    #[test]
    fn pixels_without_samples_have_the_background() {
        let (render, matte, sky) = drawn(Background::Sky);
        assert_eq!(render.image.pixel(39, 23), Some(sky.to_array()));
        assert!(render.image.pixel(31, 23) == Some([9.0; 3]) && matte.is_none());
        let (render, ..) = drawn(Background::Color(Rgb::new(1.0, 0.5, 0.0)));
        assert_eq!(render.image.pixel(32, 16), Some([1.0, 0.5, 0.0]));
        let (render, matte, _) = drawn(Background::Transparent);
        assert_eq!(render.image.pixel(32, 16), Some([0.0; 3]));
        assert_eq!(matte.unwrap().coverage[16 * 40 + 32], 0.0);
    }
}
