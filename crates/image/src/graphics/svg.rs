//! Pages as SVG files.

use super::font::FAMILY;
use super::{Align, Page, Polygon, Shape, Text};
use std::fmt::Write;
use std::num::NonZeroU16;

/// The digits of Base64, RFC 4648.
const BASE64: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Millimeters per inch.
const MILLIMETERS: f64 = 25.4;

/// Returns the content of an SVG file.
pub(super) fn file(page: &Page) -> String {
    let (width, height) = page.size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
         width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\">\n",
        length(width, page.resolution),
        length(height, page.resolution),
    );
    if let Some(title) = page.metadata.value("Title") {
        let _ = writeln!(text, "<title>{}</title>", escaped(title));
    }
    if !page.metadata.is_empty() {
        let line = |(key, value): (&str, &str)| format!("{}: {}\n", escaped(key), escaped(value));
        let lines: String = page.metadata.iter().map(line).collect();
        let _ = writeln!(text, "<desc>{}</desc>", lines.trim_end());
    }
    match page.picture {
        Some(png) => {
            let data = base64(png);
            // Older programs know only the attribute of XLink.
            let _ = writeln!(
                text,
                "<image width=\"{width}\" height=\"{height}\" \
                 xlink:href=\"data:image/png;base64,{data}\"/>"
            );
        }
        None => {
            let _ =
                writeln!(text, "<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>");
        }
    }
    for shape in &page.drawing.shapes {
        match shape {
            Shape::Polygon(polygon) => add_polygon(&mut text, page, polygon),
            Shape::Text(line) => add_text(&mut text, page, line),
        }
    }
    text + "</svg>\n"
}

fn add_polygon(text: &mut String, page: &Page, polygon: &Polygon) {
    let corner = |corner: &glam::DVec2| format!("{},{}", number(corner.x), number(corner.y));
    let corners: Vec<String> = polygon.corners.iter().map(corner).collect();
    let opacity = match polygon.opacity {
        1.0 => String::new(),
        opacity => format!(" fill-opacity=\"{opacity}\""),
    };
    let fill = hex(page.codes(polygon.color));
    let _ = writeln!(text, "<polygon points=\"{}\" fill=\"{fill}\"{opacity}/>", corners.join(" "));
}

fn add_text(text: &mut String, page: &Page, line: &Text) {
    let anchor = match line.align {
        Align::Start => "start",
        Align::Middle => "middle",
        Align::End => "end",
    };
    let (x, y, size) = (number(line.position.x), number(line.position.y), number(line.size));
    let (fill, content) = (hex(page.codes(line.color)), escaped(&line.text));
    let _ = writeln!(
        text,
        "<text x=\"{x}\" y=\"{y}\" font-family=\"{FAMILY}\" font-size=\"{size}\" \
         text-anchor=\"{anchor}\" fill=\"{fill}\" xml:space=\"preserve\">{content}</text>"
    );
}

/// Formats a number of pixels as a length: in millimeters, to a thousandth, if there is a resolution.
fn length(pixels: u32, resolution: Option<NonZeroU16>) -> String {
    let Some(resolution) = resolution else { return pixels.to_string() };
    let length = MILLIMETERS * f64::from(pixels) / f64::from(resolution.get());
    let text = format!("{length:.3}");
    format!("{}mm", text.trim_end_matches('0').trim_end_matches('.'))
}

/// Formats a coordinate with a precision of a hundredth of a pixel.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Returns text for XML, without the characters that XML cannot hold.
pub(super) fn escaped(text: &str) -> String {
    let escape = |letter: char| match letter {
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '&' => "&amp;".to_owned(),
        '"' => "&quot;".to_owned(),
        _ if letter.is_control() && letter != '\n' => " ".to_owned(),
        _ => letter.to_string(),
    };
    text.chars().map(escape).collect()
}

/// Returns bytes in Base64, with padding.
pub fn base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |index: usize| u32::from(chunk.get(index).copied().unwrap_or(0));
        let word = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let value = word >> (18 - 6 * digit) & 63;
            let is_data = digit <= chunk.len();
            text.push(if is_data { BASE64[value as usize] as char } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_encoded_as_in_the_standard() {
        for (text, expected) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(text.as_bytes()), expected);
        }
        assert_eq!(base64(&[0xFB, 0xFF]), "+/8=");
    }

    #[test]
    fn numbers_have_no_superfluous_digits() {
        for (value, expected) in [(1.0, "1"), (-0.25, "-0.25"), (10.004, "10"), (100.0, "100")] {
            assert_eq!(number(value), expected);
        }
    }

    #[test]
    fn texts_are_escaped() {
        assert_eq!(escaped("a<b & \"c\"\u{1}"), "a&lt;b &amp; &quot;c&quot; ");
    }
}
