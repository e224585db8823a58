//! Drawing of plots: from a [`Plot`] to shapes on a canvas (`dots`, `curves`), then to an image
//! (`raster`).

mod canvas;
mod curves;
mod dots;
mod legend;
mod raster;
mod scale;

use self::canvas::Canvas;
use super::{Plot, Scale};
use spherule_render::drawing::{self, DrawingError, Format};

/// Draws a plot as the content of a file.
///
/// # Errors
/// [`DrawingError`].
pub fn draw(plot: &Plot, format: Format) -> Result<Vec<u8>, DrawingError> {
    match format {
        Format::Png => png(plot),
        Format::Svg => svg(plot).map(String::into_bytes),
    }
}

/// Draws a plot as PNG, 1500 pixels wide.
///
/// # Errors
/// [`DrawingError`].
pub fn png(plot: &Plot) -> Result<Vec<u8>, DrawingError> {
    raster::png(&layout(plot))
}

/// Draws a plot as an SVG element, for a page or a file of its own.
///
/// # Errors
/// [`DrawingError`].
pub fn svg(plot: &Plot) -> Result<String, DrawingError> {
    let svg = drawing::file(&raster::Drawing::new(&layout(plot)), Format::Svg)?;
    Ok(String::from_utf8_lossy(&svg).into_owned())
}

fn layout(plot: &Plot) -> Canvas {
    match &plot.place.scale {
        Scale::Names(names) => dots::layout(plot, names),
        Scale::Linear | Scale::Whole | Scale::Log => curves::layout(plot),
    }
}
