//! Drawing plots: from a [`Plot`] to shapes on a sheet (`dots`, `curves`), from these to a picture
//! (`paper`).

mod curves;
mod dots;
mod legend;
mod paper;
mod ruler;
mod sheet;

use self::sheet::Sheet;
use super::{Plot, Scale};
use crate::drawing::{self, DrawingError, Format};

/// The content of a file.
///
/// # Errors
/// [`DrawingError`].
pub fn draw(plot: &Plot, format: Format) -> Result<Vec<u8>, DrawingError> {
    match format {
        Format::Png => png(plot),
        Format::Svg => svg(plot).map(String::into_bytes),
    }
}

/// The plot as a picture of pixels, 1500 across.
///
/// # Errors
/// [`DrawingError`].
pub fn png(plot: &Plot) -> Result<Vec<u8>, DrawingError> {
    paper::png(&lay_out(plot))
}

/// The plot as an SVG element, which may stand in a page or be a file of its own.
///
/// # Errors
/// [`DrawingError`].
pub fn svg(plot: &Plot) -> Result<String, DrawingError> {
    let svg = drawing::file(&paper::Paper::new(&lay_out(plot)), Format::Svg)?;
    Ok(String::from_utf8_lossy(&svg).into_owned())
}

fn lay_out(plot: &Plot) -> Sheet {
    match &plot.place.scale {
        Scale::Names(names) => dots::lay_out(plot, names),
        Scale::Linear | Scale::Whole | Scale::Log => curves::lay_out(plot),
    }
}
