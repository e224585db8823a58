//! Color bars and annotations of an image.

use super::setup::RenderSetup;
use crate::cli::failure::Failure;
use crate::cli::options::appearance::BarPlace;
use crate::cli::write_file::{check_destination, write_file};
use spherule_render::World;
use spherule_render::overlay::Canvas;
use spherule_render::overlay::annotations::{self, AnnotationDrawing};
use spherule_render::overlay::color_bar::Bar;
use spherule_render::scene::particles::Legend;
use spherule_render::scene::{Annotations, Lettering, Look, Settings};
use std::num::NonZeroU16;

/// Checks that the color bar can be written, without changing anything.
pub(in crate::cli) fn check_bar(setup: &RenderSetup) -> Result<(), Failure> {
    let Some(BarPlace::File(path, _)) = setup.color_bar else { return Ok(()) };
    check_destination(path)
}

/// Rejects a color bar if colors do not represent numbers.
pub(in crate::cli) fn check_legend(
    setup: &RenderSetup,
    legend: Option<&Legend>,
) -> Result<(), Failure> {
    if setup.color_bar.is_none() || legend.is_some() {
        return Ok(());
    }
    let message = "--color-bar needs --color-by, or a color of --style, with a numeric column and a color map; \
                   --legend lists the colors of names";
    Err(Failure::usage("render", message))
}

/// Writes the color bar, as high as the image, if it has a file; an error if colors do not represent numbers. If the image
/// has a resolution, the letters are as large as those of annotations.
pub(in crate::cli) fn write_bar(
    setup: &RenderSetup,
    legend: Option<&Legend>,
    settings: &Settings,
) -> Result<(), Failure> {
    check_legend(setup, legend)?;
    let (Some(BarPlace::File(path, format)), Some(legend)) = (setup.color_bar, legend) else {
        return Ok(());
    };
    let Legend { scale, label } = legend;
    let Settings { width, height, dpi, .. } = *settings;
    let lettering = Lettering { size: setup.request.annotations.text_size, ..Lettering::default() };
    let letter = dpi.map(|_| lettering.pixels(width.min(height), dpi));
    let bar = Bar::file(scale, label, height, letter, *format, dpi)?;
    write_file(path, &bar)
}

/// Warning of annotations that have no room.
pub(super) const OVERLAP: &str =
    "annotations overlap: make the image larger, or use fewer or a smaller --text-size";

/// Draws the annotations of a scene over an image, which may have a `resolution` in pixels per inch; returns whether all of them have room.
pub(in crate::cli) fn draw_annotations(
    scene: (&Annotations, &Look),
    world: &World,
    resolution: Option<NonZeroU16>,
    canvas: &mut Canvas,
    turns: bool,
) -> bool {
    let (annotations, look) = scene;
    if annotations.is_empty() {
        return true;
    }
    let AnnotationDrawing { drawing, fits } =
        annotations::draw(annotations, world, look, resolution, turns);
    canvas.draw(|image| drawing.draw_over(image));
    fits
}
