//! Pages: SVG and PDF files of an image with its annotations as vectors.

use super::prepare::Prepared;
use super::setup::RenderSetup;
use crate::cli::failure::Failure;
use spherule_render::graphics::Page;
use spherule_render::image::WriteOptions;
use spherule_render::image::tone::DisplayTransform;
use spherule_render::overlay::annotations;
use spherule_render::scene::Scene;

/// Returns the content of the output file: the image, which is encoded already, or a page with it.
pub(super) fn file(
    setup: &RenderSetup,
    prepared: &Prepared,
    image: Vec<u8>,
    options: &WriteOptions,
) -> Result<Vec<u8>, Failure> {
    let Some(format) = setup.page else { return Ok(image) };
    let Scene { annotations, look, settings, .. } = &prepared.scene;
    let turns = setup.turn.is_some();
    let world = &prepared.world;
    let drawing = annotations::draw(annotations, world, look, settings.dpi, turns).drawing;
    let page = Page {
        size: (prepared.region.width, prepared.region.height),
        picture: Some(&image),
        drawing: &drawing,
        display: DisplayTransform::nearest(options.exposure, options.tone),
        resolution: options.resolution,
        metadata: &options.metadata,
    };
    Ok(page.file(format)?)
}
