//! Layers of the image file (AOVs).

use super::prepare::Prepared;
use super::setup::RenderSetup;
use spherule_render::film::Region;
use spherule_render::image::{Channel, Format, Values};
use spherule_render::layers::{Layers, layers};
use spherule_render::overlay::Matte;
use spherule_render::render::{Options, Render, RenderError};
use spherule_render::scene::Settings;

/// Renders the requested channels.
pub(super) fn channels(
    setup: &RenderSetup,
    prepared: &Prepared,
    render: &Render,
) -> Result<Vec<Channel>, RenderError> {
    let wanted = setup.encoding.wanted_layers();
    if wanted.is_empty() {
        return Ok(Vec::new());
    }
    // No more samples than the image has, so that an interrupted render ends soon.
    let settings = Settings { spp: render.samples.most.max(1), ..prepared.scene.settings.clone() };
    let options =
        Options { tracer: setup.tracer, region: Some(prepared.region), ..Options::default() };
    let mut layers = if wanted.iter().all(|layer| layer.is_statistic()) {
        let Region { width, height, .. } = prepared.region;
        Layers { width, height, pixels: Vec::new(), statistics: None }
    } else {
        layers(&prepared.world, &settings, &options, &wanted)?
    };
    layers.statistics.clone_from(&render.statistics);
    Ok(layers.channels(&wanted))
}

/// Alpha as a channel, for formats that blend linear or encoded values.
pub(in crate::cli) fn alpha(matte: &Matte, format: Format) -> Channel {
    let values = if format == Format::Exr { matte.linear() } else { matte.encoded() };
    Channel { name: "A".to_owned(), values: Values::Floats(values) }
}
