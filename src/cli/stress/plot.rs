//! A picture of the wrong decisions: a line for each regime, a mark for each form, and how often it
//! is wrong to the right. The axis is logarithmic; what is never wrong stands apart at the left.

use plotters::backend::DrawingBackend;
use plotters::element::{Circle, PathElement, Polygon, Text};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor, ShapeStyle, TextStyle};
use spherule::drawing::{Area, Drawn, INK, Picture, letters};
use spherule::stress::{Form, Report};

/// Pixels across.
const WIDTH: u32 = 1500;
/// Pixels above the first line and below the last.
const MARGIN: [i32; 2] = [150, 110];
/// Pixels from line to line.
const LINE: i32 = 36;
/// Pixels to the left of the marks that are never wrong, and to the right of 100 %.
const SIDES: [i32; 2] = [250, 60];
/// Pixels from the marks that are never wrong to the logarithmic axis.
const GAP: i32 = 150;
/// Least exponent of ten, in percent, at which the axis begins, and the greatest.
const DECADES: [i32; 2] = [-4, 2];

const FAINT: RGBColor = RGBColor(222, 222, 222);

/// The forms with their colors, which the color-blind can tell apart: Okabe and Ito, "Color
/// Universal Design", 2008.
const FORMS: [(Form, &str, RGBColor); 3] = [
    (Form::Naive, "naive f32", RGBColor(213, 94, 0)),
    (Form::Good, "good f32", RGBColor(0, 114, 178)),
    (Form::Spherule, "Spherule", RGBColor(0, 158, 115)),
];

/// The picture of a report.
pub(super) struct Plot<'a>(pub(super) &'a Report);

impl Picture for Plot<'_> {
    fn size(&self) -> (u32, u32) {
        let lines = self.0.regimes.len() as i32;
        (WIDTH, (MARGIN[0] + MARGIN[1] + lines * LINE) as u32)
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        let Self(report) = self;
        heading(area, report)?;
        axis(area, report.regimes.len() as i32)?;
        for (line, regime) in (0..).zip(&report.regimes) {
            let y = MARGIN[0] + line * LINE + LINE / 2;
            area.draw(&Text::new(regime.name, (SIDES[0] - 40, y), style(20, HPos::Right)))?;
            let ends = [(SIDES[0], y), (WIDTH as i32 - SIDES[1], y)];
            area.draw(&PathElement::new(ends, FAINT.stroke_width(1)))?;
            for (form, _, color) in FORMS {
                mark(area, form, (x_of(100.0 * regime.wrong_share(form)), y), color)?;
            }
        }
        Ok(())
    }
}

fn heading<B: DrawingBackend>(area: &Area<B>, report: &Report) -> Drawn<B> {
    let title = "Rays whose hit, miss or nearest sphere is wrong";
    area.draw(&Text::new(title, (40, 40), style(32, HPos::Left)))?;
    let count = indicatif::HumanCount(report.rays);
    let about = format!("of {count} random rays, seed {}, in percent for each regime", report.seed);
    area.draw(&Text::new(about, (40, 80), style(20, HPos::Left)))?;
    let mut x = WIDTH as i32 - 500;
    for (form, name, color) in FORMS {
        mark(area, form, (x, 81), color)?;
        area.draw(&Text::new(name, (x + 24, 80), style(22, HPos::Left)))?;
        x += 165;
    }
    Ok(())
}

/// Lines and labels of the decades, and of never.
fn axis<B: DrawingBackend>(area: &Area<B>, lines: i32) -> Drawn<B> {
    let (top, bottom) = (MARGIN[0], MARGIN[0] + lines * LINE);
    let decades = (DECADES[0]..=DECADES[1]).map(|decade| {
        let share = 10_f64.powi(decade);
        (x_of(share), format!("{share} %"))
    });
    for (x, label) in [(x_of(0.0), "never".to_owned())].into_iter().chain(decades) {
        area.draw(&PathElement::new([(x, top), (x, bottom)], FAINT.stroke_width(2)))?;
        let style = style(20, HPos::Center);
        area.draw(&Text::new(label.clone(), (x, bottom + 24), style.clone()))?;
        area.draw(&Text::new(label, (x, top - 20), style))?;
    }
    let note = "Whole numbers decide what is right. Spherule is asked as it ships.";
    area.draw(&Text::new(note, (40, bottom + 76), style(18, HPos::Left)))
}

/// Where a share in percent stands.
fn x_of(percent: f64) -> i32 {
    let (left, right) = (SIDES[0] + GAP, WIDTH as i32 - SIDES[1] - 40);
    if percent <= 0.0 {
        return SIDES[0] + 30;
    }
    let [least, most] = DECADES.map(f64::from);
    let part = (percent.log10().clamp(least, most) - least) / (most - least);
    left + (part * f64::from(right - left)).round() as i32
}

/// A circle, a square, a diamond: of different sizes, so that none hides another.
fn mark<B: DrawingBackend>(
    area: &Area<B>,
    form: Form,
    at: (i32, i32),
    color: RGBColor,
) -> Drawn<B> {
    let filled: ShapeStyle = color.filled();
    let shape = |radius: i32, corners: [(i32, i32); 4]| {
        let corner = |(x, y): (i32, i32)| (at.0 + radius * x, at.1 + radius * y);
        Polygon::new(corners.map(corner), filled)
    };
    match form {
        Form::Spherule => area.draw(&shape(9, [(-1, 0), (0, -1), (1, 0), (0, 1)])),
        Form::Good => area.draw(&shape(10, [(-1, -1), (1, -1), (1, 1), (-1, 1)])),
        Form::Naive | Form::NaiveOffset => area.draw(&Circle::new(at, 16, filled)),
    }
}

fn style(size: u32, side: HPos) -> TextStyle<'static> {
    letters(size, INK, side)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule::drawing::{Format, file};
    use spherule::stress::{Options, REGIMES, run};

    #[test]
    fn shares_stand_in_order_and_never_apart() {
        let places = [0.0, 1e-9, 1e-4, 1e-2, 1.0, 100.0].map(x_of);
        assert!(places.is_sorted() && places[0] < places[1] && places[1] == places[2]);
        let decades = [places[4] - places[3], places[5] - places[4]];
        assert!(decades[0].abs_diff(decades[1]) <= 1, "{decades:?}");
    }

    #[test]
    fn both_pictures_show_every_regime() {
        let regimes = REGIMES.iter().take(3).collect();
        let report = run(&Options { rays: 300, seed: 0, regimes }, &|_| ());
        let svg = String::from_utf8(file(&Plot(&report), Format::Svg).unwrap()).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for words in ["near_unit", "far_1e3", "never", "0.001 %", "Spherule", "300 random rays"] {
            assert!(svg.contains(words), "{words}");
        }
        let png = file(&Plot(&report), Format::Png).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let dark = pixels.chunks(3).filter(|pixel| pixel.iter().all(|&value| value < 100)).count();
        assert!(dark > 1000, "letters are drawn: {dark}");
        for (_, _, color) in FORMS {
            assert!(pixels.chunks(3).any(|pixel| *pixel == [color.0, color.1, color.2]));
        }
    }
}
