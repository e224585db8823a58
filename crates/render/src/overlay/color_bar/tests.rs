use super::*;
use crate::color::{Map, Range, Spacing, srgb};
use crate::image::Image;

const DIRECTIONS: [Direction; 2] = [Direction::Up, Direction::Right];
const LETTER: f64 = 12.0;

fn scale(low: f64, high: f64) -> Scale {
    Scale::new(Map::Viridis, Range::new(low, high, Spacing::Linear).unwrap())
}

fn bar(scale: &Scale, length: f64, direction: Direction) -> Bar {
    Bar::new(scale, "speed", length, LETTER, direction)
}

/// A bar on white, with a margin of one letter.
fn drawn(bar: &Bar) -> Image {
    let Block { drawing, size } = bar.block(Rgb::ZERO);
    let size = (size + 2.0 * bar.letter).ceil();
    let mut image = Image::filled(size.x as u32, size.y as u32, [1.0; 3]).unwrap();
    let mut page = Drawing::default();
    page.append(drawing, DVec2::splat(bar.letter));
    page.draw_over(&mut image);
    image
}

/// The pixel at a position of the bar.
fn at(image: &Image, bar: &Bar, along: f64, across: f64) -> Rgb {
    let position = bar.position(along, across) + bar.letter;
    Rgb::from_array(image.pixel(position.x as u32, position.y as u32).unwrap())
}

#[test]
fn colors_lie_where_their_numbers_do() {
    for direction in DIRECTIONS {
        for reversed in [false, true] {
            let scale = Scale { reversed, ..scale(0.0, 1.0) };
            let bar = bar(&scale, 256.0, direction);
            let image = drawn(&bar);
            for along in [0.5, 50.5, 100.5, 255.5] {
                let color = scale.color(along / 256.0);
                for across in [1.5, bar.thickness() / 2.0, bar.thickness() - 1.5] {
                    let seen = at(&image, &bar, along, across);
                    assert!(seen.abs_diff_eq(color, 0.02), "{direction:?} {along} {seen} {color}");
                }
            }
        }
    }
}

#[test]
fn ticks_stand_at_their_numbers() {
    for direction in DIRECTIONS {
        let bar = bar(&scale(-1.0, 3.0), 200.0, direction);
        let image = drawn(&bar);
        assert_eq!(bar.ticks.len(), 5);
        for along in [0.0, 50.0, 100.0, 150.0, 200.0] {
            let dark = |offset: f64| {
                let seen = at(&image, &bar, along + offset, bar.thickness() + 2.0);
                1.0 - seen.y
            };
            let ink = dark(-1.0) + dark(0.0) + dark(1.0);
            assert!((ink - 1.0).abs() < 0.01, "{direction:?} {along}: {ink}");
            assert!(dark(4.0) == 0.0 && dark(-5.0) == 0.0, "{direction:?} {along}");
        }
    }
}

#[test]
fn everything_fits_with_any_label() {
    let scales = [
        scale(-1.3, 4.2),
        scale(0.0, 3.7e6),
        scale(99.99, 100.01),
        scale(5.0, 5.0),
        Scale::new(Map::Turbo, Range::new(1e-300, 1e300, Spacing::Logarithmic).unwrap()),
        Scale { below: Some(Rgb::X), above: Some(Rgb::Y), ..scale(-1e-9, 1e-9) },
    ];
    let long = "w".repeat(10_000);
    for scale in &scales {
        for direction in DIRECTIONS {
            for (length, label) in [(64.0, ""), (300.0, long.as_str()), (700.0, "E / eV")] {
                let bar = Bar::new(scale, label, length, LETTER, direction);
                let image = drawn(&bar);
                let (width, height) = (image.width, image.height);
                let rows = (0..width).flat_map(|x| [(x, 5), (x, height - 5)]);
                let columns = (0..height).flat_map(|y| [(5, y), (width - 5, y)]);
                let mut edge = rows.chain(columns);
                let is_white = |(x, y): (u32, u32)| image.pixel(x, y) == Some([1.0; 3]);
                assert!(edge.all(is_white), "{direction:?} {length} {label}");
                assert!(!bar.ticks.is_empty());
            }
        }
    }
}

#[test]
fn numbers_beside_one_another_do_not_touch() {
    let bar = bar(&scale(0.123_1, 0.123_9), 240.0, Direction::Right);
    let widths: f64 = bar.ticks.iter().map(|tick| text_width(&tick.label, LETTER) + LETTER).sum();
    assert!(bar.ticks.len() > 1 && widths <= 240.0, "{:?}", bar.ticks);
}

#[test]
fn arrows_show_colors_outside_of_the_range() {
    let [below, above] = [srgb(0xFF_00_FF), srgb(0x00_FF_FF)];
    let ends = Scale { below: Some(below), above: Some(above), ..scale(0.0, 1.0) };
    for direction in DIRECTIONS {
        for color in [below, above] {
            let [plain, ended] = [scale(0.0, 1.0), ends].map(|scale| {
                let image = drawn(&bar(&scale, 100.0, direction));
                let near = |pixel: &&[f32; 3]| Rgb::from_array(**pixel).abs_diff_eq(color, 1e-3);
                image.pixels.iter().filter(near).count()
            });
            assert!(plain == 0 && ended > 30, "{direction:?}: {plain} {ended}");
        }
    }
}

#[test]
fn files_are_pixels_or_vectors_with_the_label_in_them() {
    let file = |format| Bar::file(&scale(0.0, 1.0), "a<b & c", 100, None, format, None).unwrap();
    assert!(file(Format::Png).starts_with(b"\x89PNG"));
    let svg = String::from_utf8(file(Format::Svg)).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("a&lt;b &amp; c") && svg.contains("0.5"));
    assert!(file(Format::Pdf).starts_with(b"%PDF-"));
}
