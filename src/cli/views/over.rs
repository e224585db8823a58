//! What is drawn over the picture once it is there.

use super::ViewArgs;
use spherule::World;
use spherule::film::Region;
use spherule::layers::{Layer, layers};
use spherule::overlay::{Overlay, Pen};
use spherule::render::{Options, Render};
use spherule::scene::Settings;
use spherule::scene::particles::Cell;

/// Samples of the depths that hide lines: enough for a smooth edge.
const SAMPLES: u32 = 64;

/// Rows of a picture in which a line of 1.5 pixels looks right.
const ROWS: f64 = 600.0;

/// Dark gray, linear.
const INK: [f32; 3] = [0.02; 3];

impl ViewArgs {
    /// Draws over what was rendered of a region.
    pub(in crate::cli) fn draw(
        &self,
        (world, settings): (&World, &Settings),
        cell: Option<&Cell>,
        region: Region,
        render: &mut Render,
    ) {
        let Some(cell) = cell.filter(|_| self.cell) else { return };
        let spp = render.samples.most.clamp(1, SAMPLES);
        let settings = Settings { spp, ..settings.clone() };
        let options = Options { region: Some(region), ..Options::default() };
        let layers = layers(world, &settings, &options, &[Layer::Depth]);
        let overlay = Overlay { world, region, layers: &layers };
        let width = (1.5 * f64::from(settings.height) / ROWS).max(1.0);
        overlay.draw_lines(&mut render.image, &cell.edges(), Pen { color: INK, width });
    }
}
