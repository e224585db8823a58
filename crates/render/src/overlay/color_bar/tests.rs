use super::*;
use crate::color::{Map, Range, Spacing, srgb};
use crate::drawing::PAPER;

const DIRECTIONS: [Direction; 2] = [Direction::Up, Direction::Right];

fn scale(low: f64, high: f64) -> Scale {
    Scale::new(Map::Viridis, Range::new(low, high, Spacing::Linear).unwrap())
}

fn bar(scale: &Scale, length: u32, direction: Direction) -> Bar {
    Bar::new(scale, "speed", length, direction).unwrap()
}

/// The codes of a bar on white.
struct Drawing<'a>(&'a Bar, Vec<u8>);

impl<'a> Drawing<'a> {
    fn of(bar: &'a Bar) -> Self {
        Self(bar, drawing::codes(bar, PAPER).unwrap())
    }

    fn at(&self, (x, y): (i32, i32)) -> RGBColor {
        let index = 3 * (y as usize * self.0.size.0 as usize + x as usize);
        RGBColor(self.1[index], self.1[index + 1], self.1[index + 2])
    }

    fn count(&self, is: impl Fn(RGBColor) -> bool) -> usize {
        self.1.chunks_exact(3).filter(|code| is(RGBColor(code[0], code[1], code[2]))).count()
    }
}

#[test]
fn colors_lie_where_their_numbers_do() {
    for direction in DIRECTIONS {
        for reversed in [false, true] {
            let scale = Scale { reversed, ..scale(0.0, 1.0) };
            let bar = bar(&scale, 201, direction);
            let drawing = Drawing::of(&bar);
            for along in [0, 50, 100, 200] {
                let color = code(scale.color(f64::from(along) / 200.0));
                for across in [0, bar.thickness() / 2, bar.thickness() - 1] {
                    let seen = drawing.at(bar.position(along, across));
                    assert_eq!(seen, color, "{direction:?} {along} {across}");
                }
            }
        }
    }
}

#[test]
fn ticks_stand_at_their_numbers() {
    for direction in DIRECTIONS {
        let bar = bar(&scale(-1.0, 3.0), 201, direction);
        let drawing = Drawing::of(&bar);
        let ticked = |along: i32| {
            let color = drawing.at(bar.position(along, bar.thickness() + 2));
            color.0 < 200
        };
        let positions: Vec<i32> = (0..=200).filter(|&along| ticked(along)).collect();
        assert_eq!(bar.ticks.len(), 5);
        assert_eq!(positions, [0, 50, 100, 150, 200], "{direction:?}");
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
            for (length, label) in [(0, "a"), (64, ""), (300, long.as_str()), (700, "E / eV")] {
                let bar = Bar::new(scale, label, length, direction).unwrap();
                let drawing = Drawing::of(&bar);
                let (width, height) = (bar.size.0 as i32, bar.size.1 as i32);
                let mut edge = (0..width).flat_map(|x| [(x, 0), (x, height - 1)]);
                assert!(edge.all(|at| drawing.at(at) == PAPER), "{direction:?} {length}");
                let mut edge = (0..height).flat_map(|y| [(0, y), (width - 1, y)]);
                assert!(edge.all(|at| drawing.at(at) == PAPER), "{direction:?} {length}");
                assert!(!bar.ticks.is_empty());
            }
        }
    }
}

#[test]
fn numbers_beside_one_another_do_not_touch() {
    let bar = bar(&scale(0.123_1, 0.123_9), 240, Direction::Right);
    let widths: i32 = bar
        .ticks
        .iter()
        .map(|tick| drawing::width(&tick.label, bar.letter as u32).unwrap() as i32 + bar.letter)
        .sum();
    assert!(bar.ticks.len() > 1 && widths <= 240, "{:?}", bar.ticks);
}

#[test]
fn arrows_show_colors_outside_of_the_range() {
    let [below, above] = [srgb(0xFF_00_FF), srgb(0x00_FF_FF)];
    let ends = Scale { below: Some(below), above: Some(above), ..scale(0.0, 1.0) };
    for direction in DIRECTIONS {
        for color in [below, above].map(code) {
            let [plain, ended] = [scale(0.0, 1.0), ends].map(|scale| {
                let bar = bar(&scale, 100, direction);
                Drawing::of(&bar).count(|code| code == color)
            });
            assert!(plain == 0 && ended > 30, "{direction:?}: {plain} {ended}");
        }
    }
}

#[test]
fn files_are_pixels_or_vectors_with_the_label_in_them() {
    let bar = Bar::new(&scale(0.0, 1.0), "a<b & c", 100, Direction::Up).unwrap();
    let png = bar.file(Format::Png).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    let svg = String::from_utf8(bar.file(Format::Svg).unwrap()).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("a&lt;b &amp; c") && svg.contains("0.5"));
}

#[test]
fn the_background_of_the_bar_is_transparent() {
    let (scale, under) = (scale(0.0, 1.0), [0.25, 0.5, 4.0]);
    let bar = bar(&scale, 101, Direction::Up);
    let mut image = Image::filled(200, 200, under).unwrap();
    bar.draw_over(&mut image, (10, 20), Rgb::ONE).unwrap();
    let near = |pixel: [f32; 3], color: Rgb| {
        let [r, g, b] = pixel;
        RGBColor(0, 0, 0) != code(color) && code(Rgb::new(r, g, b)) == code(color)
    };
    let pixel = |image: &Image, (x, y): (i32, i32)| image.pixel(x as u32, y as u32).unwrap();
    for along in [0, 50, 100] {
        let (x, y) = bar.position(along, 3);
        assert!(near(pixel(&image, (x + 10, y + 20)), scale.at(f64::from(along) / 100.0)));
    }
    assert_eq!(pixel(&image, (10, 20)), under);
    assert!(image.pixels.iter().filter(|pixel| **pixel == [1.0; 3]).count() > 20, "letters");
    let seen = image.pixels.iter().filter(|pixel| **pixel == under).count();
    assert!(seen > 200 * 200 - 101 * 90, "{seen}");
}

#[test]
fn parts_outside_are_cut_off() {
    let bar = bar(&scale(0.0, 1.0), 100, Direction::Up);
    let under = Image::filled(50, 40, [0.5; 3]).unwrap();
    let mut image = under.clone();
    bar.draw_over(&mut image, (20, 10), Rgb::ZERO).unwrap();
    assert_ne!(image, under);
    assert_eq!((image.width, image.height, image.pixels.len()), (50, 40, 2000));
    let mut image = under.clone();
    bar.draw_over(&mut image, (u32::MAX, 0), Rgb::ZERO).unwrap();
    assert_eq!(image, under);
}
