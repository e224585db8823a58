//! What is drawn over the pictures of a viewer: as `spherule render` does it, but with what is known
//! of the last picture, if that was of the same.

use super::picture::Order;
use crate::cli::views::settings_of_layers;
use spherule::World;
use spherule::film::Region;
use spherule::image::Image;
use spherule::layers::Growing;
use spherule::overlay::{GroundRender, Matte, Overlay, Runs};
use spherule::render::{Options, RenderError};

/// A picture with what is drawn over it.
#[derive(Clone, Debug)]
pub(super) struct Drawn {
    pub(super) image: Image,
    /// How much of each pixel is not background; `None` if all is. Then the colors are
    /// premultiplied.
    pub(super) matte: Option<Matte>,
}

/// What is known of a world and of what its camera sees, as far as something was drawn.
#[derive(Default)]
pub(super) struct Over {
    runs: Option<Runs>,
    layers: Option<Growing>,
    ground: Option<GroundRender>,
}

impl Over {
    /// The camera has another place or another picture.
    pub(super) fn move_on(&mut self) {
        (self.layers, self.ground) = (None, None);
    }

    /// Draws over a picture that was ordered; nothing if it is cancelled.
    pub(super) fn draw(
        &mut self,
        world: &mut World,
        order: &Order,
        mut image: Image,
        options: &Options,
    ) -> Result<Option<Drawn>, RenderError> {
        let settings = settings_of_layers(&order.settings, order.settings.spp);
        let begin = || Growing::begin(world, &settings, options);
        let known = self.layers.take().map_or_else(begin, Ok)?;
        let layers = self.layers.insert(known);
        if !layers.grow(world, &settings, options) {
            return Ok(None);
        }
        if order.look.is_transparent() {
            if self.ground.is_none() {
                self.ground = GroundRender::begin(world, &order.settings, options)?;
            }
            if let Some(ground) = &mut self.ground
                && !ground.go_on(world, &order.settings, options)?
            {
                return Ok(None);
            }
        }
        let ground = self.ground.as_ref().filter(|_| order.look.is_transparent());
        let deep = order.look.depth_cue || order.look.outline;
        let find = || self.runs.get_or_insert_with(|| Runs::of(world)).depths(world);
        let depths = deep.then(find);
        let region = Region { x: 0, y: 0, width: image.width, height: image.height };
        let layers = layers.layers();
        let overlay = Overlay { world, region, layers: &layers, depths };
        let matte = overlay.draw_look(&mut image, &order.look, ground.map(GroundRender::ground));
        Ok(Some(Drawn { image, matte }))
    }
}
