//! What is drawn over the picture once it is there.

use super::{StyleArgs, ViewArgs};
use spherule::World;
use spherule::film::Region;
use spherule::image::Image;
use spherule::layers::{self, Layer, layers};
use spherule::overlay::{Overlay, Pen};
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
}

impl Over<'_> {
    /// Draws over what was rendered of the region.
    pub(in crate::cli) fn draw(&self, world: &World, settings: &Settings, render: &mut Render) {
        let cell = self.cell.filter(|_| self.views.cell);
        if cell.is_none() && self.style.background().is_none() {
            return;
        }
        let spp = render.samples.most.clamp(1, layers::SAMPLES);
        let settings = Settings { spp, ..settings.clone() };
        let options = Options { region: Some(self.region), ..Options::default() };
        let layers = layers(world, &settings, &options, &[Layer::Depth]);
        let overlay = Overlay { world, region: self.region, layers: &layers };
        self.restyle(&overlay, &mut render.image);
        if let Some(cell) = cell {
            let width = (1.5 * f64::from(settings.height) / ROWS).max(1.0);
            let pen = Pen { color: self.ink(), width };
            overlay.draw_lines(&mut render.image, &cell.edges(), pen);
        }
    }

    fn restyle(&self, overlay: &Overlay, image: &mut Image) {
        let Some(background) = self.style.background() else { return };
        overlay.replace_sky(image, background.to_array());
        match self.style.preset() {
            Some(Preset::DepthCue) => overlay.fade(image, background.to_array(), FADED),
            Some(Preset::Outline) => overlay.draw_contours(image, self.ink()),
            _ => (),
        }
    }

    fn ink(&self) -> [f32; 3] {
        let dark = self.style.background().is_some_and(|color: Rgb| color.max_element() < DARK);
        if dark { LIGHT_INK } else { INK }
    }
}
