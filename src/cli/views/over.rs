//! What is drawn over the picture once it is there.

use super::{StyleArgs, ViewArgs};
use spherule::World;
use spherule::film::Region;
use spherule::image::{Format, Image};
use spherule::layers::{self, Layer, layers};
use spherule::overlay::{Overlay, Pen, draw_alpha, ground};
use spherule::render::{Options, Render};
use spherule::scene::particles::Cell;
use spherule::scene::{Preset, Rgb, Settings};

/// Rows of a picture in which a line of 1.5 pixels looks right.
const ROWS: f64 = 600.0;

/// Dark gray, linear.
const INK: [f32; 3] = [0.02; 3];

/// Light gray, linear: on what is darker than `DARK`.
const LIGHT_INK: [f32; 3] = [0.6; 3];
const DARK: f32 = 0.2;

/// How much the farthest particle fades.
const FADED: f32 = 0.85;

/// All that is drawn over a picture.
pub(in crate::cli) struct Over<'a> {
    pub(in crate::cli) views: &'a ViewArgs,
    pub(in crate::cli) style: &'a StyleArgs,
    pub(in crate::cli) cell: Option<&'a Cell>,
    pub(in crate::cli) region: Region,
    pub(in crate::cli) format: Format,
}

/// A picture that is drawn over.
pub(in crate::cli) struct Canvas<'a> {
    pub(in crate::cli) image: &'a mut Image,
    /// How much of each pixel is not background; `None` if all is. Then the colors are
    /// premultiplied.
    pub(in crate::cli) alpha: Option<Vec<f32>>,
}

impl Canvas<'_> {
    /// Draws over it.
    pub(in crate::cli) fn draw(&mut self, draw: impl Fn(&mut Image)) {
        draw(self.image);
        if let Some(alpha) = &mut self.alpha {
            draw_alpha(alpha, (self.image.width, self.image.height), draw);
        }
    }
}

impl Over<'_> {
    /// Draws over what was rendered of the region.
    pub(in crate::cli) fn draw<'i>(
        &self,
        world: &mut World,
        settings: &Settings,
        render: &'i mut Render,
    ) -> Canvas<'i> {
        let cell = self.cell.filter(|_| self.views.cell);
        let (spp, mean) = (render.samples.most, self.mean_samples(render));
        let mut canvas = Canvas { image: &mut render.image, alpha: None };
        let transparent = self.style.is_transparent();
        if cell.is_none() && self.style.background().is_none() && !transparent {
            return canvas;
        }
        let options = Options { region: Some(self.region), ..Options::default() };
        let floor = Settings { spp: mean, ..settings.clone() };
        let ground = transparent.then(|| ground(world, &floor, &options)).flatten();
        let settings = Settings { spp: spp.clamp(1, layers::SAMPLES), ..settings.clone() };
        let layers = layers(world, &settings, &options, &[Layer::Depth]);
        let overlay = Overlay { world, region: self.region, layers: &layers };
        if let Some(background) = self.style.background() {
            overlay.replace_sky(canvas.image, background.to_array());
        }
        self.fade(&overlay, canvas.image);
        if transparent {
            let matte = overlay.lift(canvas.image, ground);
            let linear = self.format == Format::Exr;
            canvas.alpha = Some(if linear { matte.linear() } else { matte.encoded() });
        }
        if self.style.preset() == Some(Preset::Outline) {
            canvas.draw(|image| overlay.draw_contours(image, self.ink()));
        }
        if let Some(cell) = cell {
            let width = (1.5 * f64::from(settings.height) / ROWS).max(1.0);
            let pen = Pen { color: self.ink(), width };
            canvas.draw(|image| overlay.draw_lines(image, &cell.edges(), pen));
        }
        canvas
    }

    /// Samples of a pixel, on average.
    fn mean_samples(&self, render: &Render) -> u32 {
        let pixels = u64::from(self.region.width) * u64::from(self.region.height);
        render.samples.total.div_ceil(pixels.max(1)).clamp(1, u64::from(Settings::HARD_SAMPLES))
            as u32
    }

    fn fade(&self, overlay: &Overlay, image: &mut Image) {
        if self.style.preset() == Some(Preset::DepthCue) {
            let into = self.style.background().unwrap_or(Rgb::ONE);
            overlay.fade(image, into.to_array(), FADED);
        }
    }

    /// A color in which lines and letters can be told from the background.
    pub(in crate::cli) fn ink(&self) -> [f32; 3] {
        let dark = self.style.background().is_some_and(|color: Rgb| color.max_element() < DARK);
        if dark { LIGHT_INK } else { INK }
    }
}
