//! Drawing of plots: from a [`Plot`] to shapes on a canvas (`dots`, `curves`), then to a
//! file.

mod canvas;
mod curves;
mod dots;
mod legend;
mod scale;

use self::canvas::Canvas;
use super::{Plot, Scale};
use spherule_render::graphics::{Format, PageError};

/// Draws a plot as the content of a file, 1500 pixels wide.
///
/// # Errors
/// [`PageError`].
pub fn draw(plot: &Plot, format: Format) -> Result<Vec<u8>, PageError> {
    let canvas = layout(plot);
    canvas.drawing.file(format, (canvas::WIDTH as u32, canvas.height as u32), None)
}

fn layout(plot: &Plot) -> Canvas {
    match &plot.place.scale {
        Scale::Names(names) => dots::layout(plot, names),
        Scale::Linear | Scale::Whole | Scale::Log => curves::layout(plot),
    }
}
