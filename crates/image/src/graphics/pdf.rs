//! Pages as PDF files.

use super::font::{self, PlacedGlyph, glyphs};
use super::{Page, PageError, Polygon, Shape, Text};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::num::NonZeroU16;
use subsetter::GlyphRemapper;

/// Points per inch.
const POINTS: f64 = 72.0;

/// Pixels per inch of a page that has no resolution.
const RESOLUTION: u16 = 300;

/// Units of the em square in PDF.
const EM: f64 = 1000.0;

const FONT: Name = Name(b"F1");
const PICTURE: Name = Name(b"Im1");

/// Name of the embedded part of the font: six letters mark a subset.
const FONT_NAME: Name = Name(b"SPHERL+DejaVuSans");

/// Identifies the character collection of the embedded font.
const SYSTEM: SystemInfo =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// Numbers of the file's objects.
struct Ids(i32);

impl Ids {
    fn next(&mut self) -> Ref {
        self.0 += 1;
        Ref::new(self.0)
    }
}

/// Returns the content of a PDF file.
pub(super) fn file(page: &Page) -> Result<Vec<u8>, PageError> {
    let mut ids = Ids(0);
    let [catalog, pages, leaf, content] = std::array::from_fn(|_| ids.next());
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([leaf]).count(1);
    let lines = page.drawing.shapes.iter().filter_map(|shape| match shape {
        Shape::Text(text) => Some(glyphs(&text.text)),
        Shape::Polygon(_) => None,
    });
    let font = EmbeddedFont::of(lines.flatten());
    let type0 = font.write(&mut pdf, &mut ids)?;
    let picture = page.picture.map(|png| write_picture(&mut pdf, &mut ids, png)).transpose()?;
    let states = opacities(page);
    let resolution = page.resolution.map_or(RESOLUTION, NonZeroU16::get);
    let scale = POINTS / f64::from(resolution);
    let [width, height] =
        [page.size.0, page.size.1].map(|pixels| (f64::from(pixels) * scale) as f32);
    let mut entry = pdf.page(leaf);
    entry.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(content);
    let mut resources = entry.resources();
    if let Some(picture) = picture {
        resources.x_objects().pair(PICTURE, picture);
    }
    resources.fonts().pair(FONT, type0);
    let mut graphics_states = resources.ext_g_states();
    for (name, opacity) in states.values() {
        graphics_states
            .insert(Name(name.as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState>()
            .non_stroking_alpha(*opacity);
    }
    graphics_states.finish();
    resources.finish();
    entry.finish();
    let stream = deflated(&drawn(page, &font, &states, scale as f32, (width, height)))?;
    pdf.stream(content, &stream).filter(Filter::FlateDecode);
    let mut info = pdf.document_info(ids.next());
    for (key, value) in page.metadata.iter() {
        match key {
            "Title" => _ = info.title(TextStr(value)),
            "Software" => _ = info.producer(TextStr(value)),
            _ => _ = info.pair(Name(key.as_bytes()), TextStr(value)),
        }
    }
    info.finish();
    Ok(pdf.finish())
}

/// Returns the opacities of shapes, by their bits, with names for them.
fn opacities(page: &Page) -> BTreeMap<u32, (String, f32)> {
    let opacity = |shape: &Shape| match shape {
        Shape::Polygon(polygon) => polygon.opacity,
        Shape::Text(_) => 1.0,
    };
    let all: BTreeSet<u32> = page.drawing.shapes.iter().map(|s| opacity(s).to_bits()).collect();
    let name = |(index, bits): (usize, u32)| (bits, (format!("G{index}"), f32::from_bits(bits)));
    all.into_iter().enumerate().map(name).collect()
}

/// Returns the operators that draw the page: `scale` is the points per pixel, and its size is in points.
fn drawn(
    page: &Page,
    font: &EmbeddedFont,
    states: &BTreeMap<u32, (String, f32)>,
    scale: f32,
    (width, height): (f32, f32),
) -> Vec<u8> {
    let mut content = Content::new();
    if page.picture.is_some() {
        content.save_state();
        content.transform([width, 0.0, 0.0, height, 0.0, 0.0]);
        content.x_object(PICTURE);
        content.restore_state();
    }
    // Pixels from the top left corner.
    content.transform([scale, 0.0, 0.0, -scale, 0.0, height]);
    let mut opacity = 1.0_f32.to_bits();
    for shape in &page.drawing.shapes {
        let (color, own) = match shape {
            Shape::Polygon(polygon) => (polygon.color, polygon.opacity),
            Shape::Text(text) => (text.color, 1.0),
        };
        if own.to_bits() != opacity
            && let Some((name, _)) = states.get(&own.to_bits())
        {
            opacity = own.to_bits();
            content.set_parameters(Name(name.as_bytes()));
        }
        let [red, green, blue] = page.codes(color).map(|code| f32::from(code) / 255.0);
        content.set_fill_rgb(red, green, blue);
        match shape {
            Shape::Polygon(polygon) => add_polygon(&mut content, polygon),
            Shape::Text(text) => add_text(&mut content, font, text),
        }
    }
    content.finish().to_vec()
}

fn add_polygon(content: &mut Content, polygon: &Polygon) {
    let mut corners = polygon.corners.iter().map(|corner| corner.as_vec2());
    let Some(first) = corners.next() else { return };
    content.move_to(first.x, first.y);
    for corner in corners {
        content.line_to(corner.x, corner.y);
    }
    content.close_path();
    content.fill_nonzero();
}

fn add_text(content: &mut Content, font: &EmbeddedFont, text: &Text) {
    let (start, size) = (text.start().as_vec2(), text.size as f32);
    content.begin_text();
    content.set_font(FONT, 1.0);
    // Letters are upright although rows go down.
    content.set_text_matrix([size, 0.0, 0.0, -size, start.x, start.y]);
    let mut positioned = content.show_positioned();
    let mut items = positioned.items();
    let mut end = 0.0;
    for glyph in glyphs(&text.text) {
        if glyph.start != end {
            items.adjust(((end - glyph.start) * EM) as f32);
        }
        items.show(Str(&font.cid(&glyph).to_be_bytes()));
        end = glyph.start + glyph.advance;
    }
    items.finish();
    positioned.finish();
    content.end_text();
}

/// The part of the font that a page needs.
struct EmbeddedFont {
    remapper: GlyphRemapper,
    /// Letters and advances in ems by the glyph's number in the file.
    glyphs: BTreeMap<u16, (char, f64)>,
}

impl EmbeddedFont {
    fn of(glyphs: impl Iterator<Item = PlacedGlyph>) -> Self {
        let mut remapper = GlyphRemapper::new();
        let number =
            |glyph: PlacedGlyph| (remapper.remap(glyph.id.0), (glyph.letter, glyph.advance));
        let glyphs = glyphs.map(number).collect();
        Self { remapper, glyphs }
    }

    /// Returns the number of a glyph in the file.
    fn cid(&self, glyph: &PlacedGlyph) -> u16 {
        self.remapper.get(glyph.id.0).unwrap_or(0)
    }

    /// Writes the font, and returns its object.
    fn write(&self, pdf: &mut Pdf, ids: &mut Ids) -> Result<Ref, PageError> {
        let [type0, cid_font, descriptor, unicode, data] = std::array::from_fn(|_| ids.next());
        pdf.type0_font(type0)
            .base_font(FONT_NAME)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid_font)
            .to_unicode(unicode);
        let mut font = pdf.cid_font(cid_font);
        font.subtype(CidFontType::Type2)
            .base_font(FONT_NAME)
            .system_info(SYSTEM)
            .font_descriptor(descriptor)
            .default_width(0.0)
            .cid_to_gid_map_predefined(Name(b"Identity"));
        let mut widths = font.widths();
        for (number, (_, advance)) in &self.glyphs {
            widths.consecutive(*number, [(advance * EM) as f32]);
        }
        widths.finish();
        font.finish();
        // The font's own bounds and heights, in thousandths of the em square.
        pdf.font_descriptor(descriptor)
            .name(FONT_NAME)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(-1021.0, -463.0, 1793.0, 1232.0))
            .italic_angle(0.0)
            .ascent(928.0)
            .descent(-236.0)
            .cap_height((font::CAP_HEIGHT * EM) as f32)
            .stem_v(80.0)
            .font_file2(data);
        let mut map = UnicodeCmap::new(Name(b"Spherule"), SYSTEM);
        for (number, (letter, _)) in &self.glyphs {
            map.pair(*number, *letter);
        }
        pdf.cmap(unicode, &map.finish());
        let subset = subsetter::subset(font::data(), 0, &self.remapper)
            .map_err(|error| PageError::Content(format!("the font: {error}")))?;
        let length = subset.len() as i32;
        let mut stream = deflated(&subset)?;
        stream.shrink_to_fit();
        pdf.stream(data, &stream).filter(Filter::FlateDecode).pair(Name(b"Length1"), length);
        Ok(type0)
    }
}

/// Writes the image of a PNG file with 8 bits per channel, and returns its object.
fn write_picture(pdf: &mut Pdf, ids: &mut Ids, png: &[u8]) -> Result<Ref, PageError> {
    let damaged = |error: png::DecodingError| PageError::Content(format!("the picture: {error}"));
    let mut decoder = png::Decoder::new(std::io::Cursor::new(png));
    decoder.set_transformations(png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(damaged)?;
    let size = reader.output_buffer_size();
    let size = size.ok_or_else(|| PageError::Content("the picture is too large".to_owned()))?;
    let mut codes = vec![0; size];
    let info = reader.next_frame(&mut codes).map_err(damaged)?;
    let (colors, mask): (Vec<u8>, Option<Vec<u8>>) = match info.color_type {
        png::ColorType::Rgb => (codes, None),
        png::ColorType::Rgba => {
            let pixels = codes.as_chunks::<4>().0;
            let colors = pixels.iter().flat_map(|&[red, green, blue, _]| [red, green, blue]);
            (colors.collect(), Some(pixels.iter().map(|pixel| pixel[3]).collect()))
        }
        other => return Err(PageError::Content(format!("the picture is of type {other:?}"))),
    };
    let [picture, alpha] = std::array::from_fn(|_| ids.next());
    let (width, height) = (info.width as i32, info.height as i32);
    let stream = deflated(&colors)?;
    let mut object = pdf.image_xobject(picture, &stream);
    object.width(width).height(height).bits_per_component(8).filter(Filter::FlateDecode);
    object.color_space().device_rgb();
    if mask.is_some() {
        object.s_mask(alpha);
    }
    object.finish();
    if let Some(mask) = mask {
        let stream = deflated(&mask)?;
        let mut object = pdf.image_xobject(alpha, &stream);
        object.width(width).height(height).bits_per_component(8).filter(Filter::FlateDecode);
        object.color_space().device_gray();
    }
    Ok(picture)
}

fn deflated(bytes: &[u8]) -> Result<Vec<u8>, PageError> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    let written = encoder.write_all(bytes).and_then(|()| encoder.finish());
    written.map_err(|error| PageError::Content(error.to_string()))
}
