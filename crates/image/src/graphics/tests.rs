use super::*;
use crate::image::tone::DisplayTransform;
use crate::image::tone::Tone;
use crate::image::{Format as ImageFormat, Image, Metadata, WriteOptions};
use std::num::NonZeroU16;

const INK: Rgb = Rgb::ZERO;

fn white(width: u32, height: u32) -> Image {
    Image::filled(width, height, [1.0; 3]).unwrap()
}

/// Sum of the darkness of all pixels.
fn darkness(image: &Image) -> f32 {
    image.pixels.iter().map(|pixel| 1.0 - pixel[1]).sum()
}

fn text(letters: &str, align: Align) -> Text {
    let position = DVec2::new(50.0, 20.0);
    Text { text: letters.to_owned(), position, align, size: 16.0, color: INK }
}

#[test]
fn shapes_cover_their_area_of_each_pixel() {
    let mut drawing = Drawing::default();
    drawing.rectangle(DVec2::new(1.25, 1.0), DVec2::new(3.5, 2.5), INK);
    let mut image = white(5, 4);
    drawing.draw_over(&mut image);
    let row = |y: u32| [0, 1, 2, 3].map(|x| 1.0 - image.pixel(x, y).unwrap()[0]);
    assert_eq!(row(1), [0.0, 0.75, 1.0, 0.5]);
    assert_eq!(row(2), [0.0, 0.375, 0.5, 0.25]);
    assert_eq!(row(3), [0.0; 4]);
    let mut drawing = Drawing::default();
    drawing.line([DVec2::new(2.0, 3.0), DVec2::new(32.0, 17.0)], 2.5, INK);
    drawing.line([DVec2::ONE, DVec2::ONE], 2.5, INK);
    let mut image = white(40, 20);
    drawing.draw_over(&mut image);
    let expected = 2.5 * 30_f32.hypot(14.0);
    assert!((darkness(&image) - expected).abs() < 0.01, "{}", darkness(&image));
}

#[test]
fn formats_follow_from_the_name() {
    let of = |name: &str| Format::of_suffix(std::path::Path::new(name));
    assert_eq!((of("a.png"), of("b/A.SVG")), (Some(Format::Png), Some(Format::Svg)));
    assert_eq!((of("a.pdf"), of("png")), (Some(Format::Pdf), None));
}

#[test]
fn corners_of_paths_are_round() {
    let [a, b, c] = [DVec2::new(4.0, 16.0), DVec2::new(16.0, 16.0), DVec2::new(16.0, 4.0)];
    let mut drawing = Drawing::default();
    drawing.path(&[a, b, c], 8.0, INK);
    let mut image = white(24, 24);
    drawing.draw_over(&mut image);
    // Two halves of the lines are in the other line, and a quarter of the disc is in neither.
    let expected = 2.0 * 12.0 * 8.0 - 16.0 + std::f32::consts::PI * 4.0;
    assert!((darkness(&image) - expected).abs() < 0.3, "{}", darkness(&image));
}

#[test]
fn translucent_shapes_blend() {
    let mut drawing = Drawing::default();
    drawing.translucent_rectangle(DVec2::ZERO, DVec2::splat(2.0), Rgb::X, 0.75);
    let mut image = white(2, 2);
    drawing.draw_over(&mut image);
    assert_eq!(image.pixels, [[1.0, 0.25, 0.25]; 4]);
}

#[test]
fn shapes_outside_are_cut_off() {
    let whole = DVec2::splat(1e6);
    let mut drawing = Drawing::default();
    drawing.rectangle(DVec2::splat(-3.0), DVec2::splat(1.5), INK);
    drawing.rectangle(DVec2::splat(9.0), DVec2::splat(12.0), INK);
    drawing.rectangle(-whole, whole, INK);
    drawing.text(Text { position: DVec2::splat(-500.0), ..text("abc", Align::Start) });
    let mut image = white(3, 3);
    drawing.draw_over(&mut image);
    assert_eq!(darkness(&image), 2.25);
}

#[test]
fn texts_are_aligned_and_as_wide_as_their_letters() {
    let [one, two, large] =
        [("m", 20.0), ("mm", 20.0), ("m", 40.0)].map(|(text, size)| text_width(text, size));
    assert!(one > 10.0 && (two - 2.0 * one).abs() < 1e-9 && (large - 2.0 * one).abs() < 1e-9);
    assert_eq!(text_width("", 20.0), 0.0);
    for (align, low, high) in
        [(Align::Start, 50, 74), (Align::Middle, 38, 62), (Align::End, 26, 50)]
    {
        let mut drawing = Drawing::default();
        drawing.text(text("HH", align));
        let mut image = white(100, 24);
        drawing.draw_over(&mut image);
        let dark = |x: &u32| (0..24).any(|y| image.pixel(*x, y).unwrap()[0] < 0.9);
        let columns: Vec<u32> = (0..100).filter(dark).collect();
        assert!(columns[0] >= low && columns[columns.len() - 1] <= high, "{columns:?}");
        // Capital letters stand on the baseline.
        let dark = |y: &u32| (0..100).any(|x| image.pixel(x, *y).unwrap()[0] < 0.5);
        let rows: Vec<u32> = (0..24).filter(dark).collect();
        assert_eq!((rows[0], rows[rows.len() - 1]), (8, 19));
    }
}

#[test]
fn heights_of_letters_are_those_of_the_font() {
    let height = |letter: &str| {
        let mut drawing = Drawing::default();
        let position = DVec2::new(10.0, 950.0);
        drawing.text(Text { position, size: 1000.0, ..text(letter, Align::Start) });
        let mut image = white(900, 1000);
        drawing.draw_over(&mut image);
        let dark = |y: &u32| (0..900).any(|x| image.pixel(x, *y).unwrap()[0] < 0.5);
        f64::from(950 - (0..1000).find(dark).unwrap_or(950)) / 1000.0
    };
    assert!((height("H") - CAP_HEIGHT).abs() < 2e-3, "{}", height("H"));
    assert!((height("x") - X_HEIGHT).abs() < 2e-3, "{}", height("x"));
}

fn page(format: Format, opaque: bool) -> Vec<u8> {
    page_at(format, opaque, None)
}

fn page_at(format: Format, opaque: bool, resolution: Option<NonZeroU16>) -> Vec<u8> {
    let mut drawing = Drawing::default();
    drawing.translucent_rectangle(DVec2::ZERO, DVec2::splat(9.0), Rgb::Y, 0.5);
    drawing.text(text("50\u{a0}\u{c5} <&>", Align::End));
    let image = white(60, 40);
    let alpha = crate::image::Channel {
        name: "A".to_owned(),
        values: crate::image::Values::Floats(vec![0.5; 2400]),
    };
    let channels = if opaque { vec![] } else { vec![alpha] };
    let picture = image.encode(ImageFormat::Png, &channels, &WriteOptions::default()).unwrap();
    let mut metadata = Metadata::new();
    metadata.push("Title", "a & b");
    metadata.push("color_by", "q");
    let display = DisplayTransform::nearest(0.0, Tone::Linear);
    let drawing = &drawing;
    let metadata = &metadata;
    Page { size: (60, 40), picture: Some(&picture), drawing, display, resolution, metadata }
        .file(format)
        .unwrap()
}

#[test]
fn svg_files_have_picture_shapes_text_and_metadata() {
    let svg = String::from_utf8(page(Format::Svg, true)).unwrap();
    for part in [
        "width=\"60\" height=\"40\"",
        "<title>a &amp; b</title>",
        "color_by: q",
        "data:image/png;base64,iVBORw0KGgo",
        "fill-opacity=\"0.5\"",
        "fill=\"#00ff00\"",
        "50\u{a0}\u{c5} &lt;&amp;&gt;</text>",
    ] {
        assert!(svg.contains(part), "{part}");
    }
    assert!(svg.ends_with("</svg>\n"));
}

#[test]
fn pdf_files_have_a_font_and_the_alpha_of_their_picture() {
    for opaque in [true, false] {
        let pdf = page(Format::Pdf, opaque);
        let has = |word: &str| pdf.windows(word.len()).any(|part| part == word.as_bytes());
        assert!(pdf.starts_with(b"%PDF-") && has("FontFile2") && has("ToUnicode"));
        assert!(has("/MediaBox [0 0 14.4 9.6]"), "300 pixels per inch");
        assert_eq!(has("/SMask"), !opaque);
        assert!(has("/color_by (q)") && has("/ca 0.5"));
        // The whole font has more than 700 kB.
        assert!(pdf.len() < 20_000, "{}", pdf.len());
    }
}

#[test]
fn pages_have_the_size_on_paper() {
    let resolution = NonZeroU16::new(100);
    let pdf = page_at(Format::Pdf, true, resolution);
    let media_box = b"/MediaBox [0 0 43.2 28.8]";
    assert!(pdf.windows(media_box.len()).any(|part| part == media_box));
    let svg = String::from_utf8(page_at(Format::Svg, true, resolution)).unwrap();
    assert!(svg.contains("width=\"15.24mm\" height=\"10.16mm\" viewBox=\"0 0 60 40\""), "{svg}");
}

#[test]
fn files_are_the_same_each_time() {
    for format in [Format::Svg, Format::Pdf] {
        assert_eq!(page(format, false), page(format, false));
    }
}
