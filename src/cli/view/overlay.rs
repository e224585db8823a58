//! Overlays of the viewer, as in `spherule render`, with reuse of the last image's layers.

use super::image::{OverlaidImage, RenderRequest};
use spherule_render::World;
use spherule_render::film::Region;
use spherule_render::image::Image;
use spherule_render::layers::ProgressiveLayers;
use spherule_render::overlay::{GroundRender, Overlay, RunBounds, settings_of_layers};
use spherule_render::render::{Options, RenderError};

/// Cached layers of a world and its camera.
#[derive(Default)]
pub(super) struct OverlayCache {
    runs: Option<RunBounds>,
    layers: Option<ProgressiveLayers>,
    ground: Option<GroundRender>,
}

impl OverlayCache {
    /// Discards the cache after a change of camera or image size.
    pub(super) fn invalidate(&mut self) {
        (self.layers, self.ground) = (None, None);
    }

    /// Draws overlays over an image; `None` if cancelled.
    pub(super) fn draw(
        &mut self,
        world: &mut World,
        request: &RenderRequest,
        mut image: Image,
        options: &Options,
    ) -> Result<Option<OverlaidImage>, RenderError> {
        let settings = settings_of_layers(&request.settings, request.settings.spp);
        let begin = || ProgressiveLayers::begin(world, &settings, options);
        let known = self.layers.take().map_or_else(begin, Ok)?;
        let layers = self.layers.insert(known);
        if !layers.refine(world, &settings, options) {
            return Ok(None);
        }
        if request.look.is_transparent() {
            if self.ground.is_none() {
                self.ground = GroundRender::begin(world, &request.settings, options)?;
            }
            if let Some(ground) = &mut self.ground
                && !ground.run(world, &request.settings, options)?
            {
                return Ok(None);
            }
        }
        let ground = self.ground.as_ref().filter(|_| request.look.is_transparent());
        let deep = request.look.depth_cue || request.look.outline;
        let find = || self.runs.get_or_insert_with(|| RunBounds::of(world)).depths(world);
        let depths = deep.then(find);
        let region = Region { x: 0, y: 0, width: image.width, height: image.height };
        let layers = layers.layers(options);
        if options.is_cancelled() {
            return Ok(None);
        }
        let overlay = Overlay { world, region, layers: &layers, depths };
        let matte = overlay.draw_look(&mut image, &request.look, ground.map(GroundRender::ground));
        Ok(Some(OverlaidImage { image, matte }))
    }
}
