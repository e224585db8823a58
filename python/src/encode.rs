//! Files of pictures, in memory.

use crate::errors::error;
use crate::pools::pool;
use numpy::{PyArray1, PyArray3, PyArrayMethods, PyReadonlyArray3};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use spherule::graphics::{self, Drawing, Page};
use spherule::image::tone::DisplayTransform;
use spherule::image::{
    Channel, Depth, Format, Image, ImageError, Metadata, QUALITY, Values, WriteOptions,
};
use spherule::overlay;
use spherule::scene::Tone;
use std::num::NonZeroU16;
use std::path::PathBuf;

/// The part of each pixel that is not background, for the alpha of a picture.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct Matte(overlay::Matte);

impl Matte {
    pub(crate) fn of(matte: overlay::Matte) -> Self {
        Self(matte)
    }

    /// Alpha as a channel, for formats that blend linear or encoded values; without what is `drawn` over the picture, if
    /// that is drawn otherwise.
    fn channel(&self, format: Format, drawn: Option<&Drawn>) -> Channel {
        let mut matte = self.0.clone();
        for &(row, coverage) in drawn.map_or(&[][..], |drawn| &drawn.coverage) {
            matte.coverage[row as usize] = coverage;
        }
        let values = if format == Format::Exr { matte.linear() } else { matte.encoded() };
        Channel { name: "A".to_owned(), values: Values::Floats(values) }
    }
}

/// Annotations of a picture, and the pixels under them: files of vectors have them as vectors.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct Drawn {
    drawing: Drawing,
    /// Width and height of the picture.
    size: (u32, u32),
    /// Rows of pixels that the annotations change, and their colors without them.
    pixels: Vec<(u32, [f32; 3])>,
    /// The same of the coverage of the matte.
    coverage: Vec<(u32, f32)>,
}

impl Drawn {
    /// Draws over a canvas, and remembers what was there.
    pub(crate) fn over(canvas: &mut overlay::Canvas, drawing: Drawing) -> Self {
        let pixels = canvas.image.pixels.clone();
        let coverage = canvas.matte.as_ref().map(|matte| matte.coverage.clone());
        canvas.draw(|image| drawing.draw_over(image));
        let covered = canvas.matte.as_ref().map_or(&[][..], |matte| &matte.coverage);
        Self {
            drawing,
            size: (canvas.image.width, canvas.image.height),
            pixels: changed(&pixels, &canvas.image.pixels),
            coverage: changed(&coverage.unwrap_or_default(), covered),
        }
    }
}

/// The rows that differ, and their values before.
fn changed<T: Copy + PartialEq>(before: &[T], after: &[T]) -> Vec<(u32, T)> {
    let rows = (0..).zip(before.iter().zip(after));
    rows.filter(|(_, (before, after))| before != after).map(|(row, (own, _))| (row, *own)).collect()
}

/// Format and options of an encoded picture.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct EncodeTable {
    /// The file, or a name that ends in the format's suffix.
    path: PathBuf,
    exposure: f64,
    filmic: bool,
    bits: u32,
    quality: Option<u8>,
    /// Pixels per inch; 1 or more.
    dpi: Option<u16>,
    metadata: Vec<(String, String)>,
}

pub(crate) fn image(pixels: &PyReadonlyArray3<'_, f32>) -> Result<Image, ImageError> {
    let pixels = pixels.as_array();
    let (height, width, _) = pixels.dim();
    let row = |row: numpy::ndarray::ArrayView1<f32>| [row[0], row[1], row[2]];
    let values = pixels.rows().into_iter().map(row).collect();
    Image::new(width as u32, height as u32, values)
}

pub(crate) fn tone(filmic: bool) -> Tone {
    if filmic { Tone::Filmic } else { Tone::Linear }
}

/// The bytes of a file of a picture, whose pixels have three or four values.
#[pyfunction]
pub(crate) fn encode<'py>(
    py: Python<'py>,
    pixels: PyReadonlyArray3<'py, f32>,
    matte: Option<&Matte>,
    drawn: Option<&Drawn>,
    table: EncodeTable,
) -> PyResult<Bound<'py, PyBytes>> {
    let fault = |why: ImageError| error(py, &why);
    let page = graphics::Format::of_suffix(&table.path);
    let page = page.filter(|page| *page != graphics::Format::Png);
    let format = page.map_or_else(|| Format::of_suffix(&table.path), |_| Ok(Format::Png));
    let format = format.map_err(|why| fault(why.or_suffixes(&["pdf", "svg"])))?;
    let mut image = image(&pixels).map_err(fault)?;
    let size = (image.width, image.height);
    // Of a picture that was cut, annotations stay pixels.
    let drawn = drawn.filter(|drawn| page.is_some() && drawn.size == size);
    for &(row, color) in drawn.map_or(&[][..], |drawn| &drawn.pixels) {
        image.pixels[row as usize] = color;
    }
    let mut metadata = Metadata::new();
    for (name, text) in &table.metadata {
        metadata.push(name, text.replace('\0', " "));
    }
    let options = WriteOptions {
        depth: if table.bits == 16 { Depth::Sixteen } else { Depth::Eight },
        quality: table.quality.unwrap_or(QUALITY),
        exposure: table.exposure,
        tone: tone(table.filmic),
        resolution: table.dpi.and_then(NonZeroU16::new),
        metadata,
        ..WriteOptions::default()
    };
    let channels: Vec<Channel> =
        matte.map(|matte| matte.channel(format, drawn)).into_iter().collect();
    // Not on the threads of the process as a whole, which a fork does not have.
    let pool = pool(py, None)?;
    let bytes = py.detach(|| pool.install(|| image.encode(format, &channels, &options)));
    let mut bytes = bytes.map_err(fault)?;
    if let Some(format) = page {
        let none = Drawing::default();
        let page = Page {
            size,
            picture: Some(&bytes),
            drawing: drawn.map_or(&none, |drawn| &drawn.drawing),
            display: DisplayTransform::nearest(options.exposure, options.tone),
            resolution: options.resolution,
            metadata: &options.metadata,
        };
        bytes = page.file(format).map_err(|why| error(py, &why))?;
    }
    Ok(PyBytes::new(py, &bytes))
}

/// The codes of a picture for a display, 0 to 255, of three values per pixel.
#[pyfunction]
pub(crate) fn display_codes<'py>(
    py: Python<'py>,
    pixels: PyReadonlyArray3<'py, f32>,
    exposure: f64,
    filmic: bool,
) -> PyResult<Bound<'py, PyArray3<u8>>> {
    let transform = DisplayTransform::new(exposure, tone(filmic))
        .ok_or_else(|| error(py, &ImageError::Exposure(exposure)))?;
    let pixels = pixels.as_array();
    let (height, width, _) = pixels.dim();
    let codes = py.detach(|| {
        let row = |row: numpy::ndarray::ArrayView1<f32>| {
            [0, 1, 2].map(|channel| transform.code(row[channel], 255) as u8)
        };
        pixels.rows().into_iter().map(row).collect::<Vec<[u8; 3]>>().into_flattened()
    });
    PyArray1::from_vec(py, codes).reshape([height, width, 3])
}
