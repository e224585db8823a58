//! Plot of wrong results: a row for each regime, a mark for each intersection test, and the error rate on a
//! logarithmic axis, with a separate place for zero at the left.

use indicatif::HumanCount;
use spherule_measure::report::{Axis, Plot, Point, Series};
use spherule_measure::stress::{Form, RegimeReport, Report};

/// Range of the axis, in percent.
const RANGE: [f64; 2] = [1e-4, 100.0];

/// Intersection tests that are shown.
const FORMS: [(Form, &str); 3] =
    [(Form::Naive, "naive f32"), (Form::Good, "good f32"), (Form::Spherule, "Spherule")];

/// Creates the plot.
pub(super) fn plot(report: &Report) -> Plot {
    let count = HumanCount(report.rays);
    let range = Some(RANGE);
    Plot {
        name: "stress".to_owned(),
        title: "Rays whose hit, miss or nearest sphere is wrong".to_owned(),
        about: format!("of {count} random rays, seed {}, in percent for each regime", report.seed),
        note: "The reference is exact integer arithmetic. Spherule is tested as it ships."
            .to_owned(),
        place: Axis::names(report.regimes.iter().map(|regime| regime.name)),
        value: Axis { range, zero: Some("never".to_owned()), ..Axis::log("", "%") },
        series: FORMS.map(|(form, name)| series(name, form, &report.regimes)).to_vec(),
    }
}

fn series(name: &str, form: Form, regimes: &[RegimeReport]) -> Series {
    let fractions = regimes.iter().map(|regime| 100.0 * regime.wrong_fraction(form));
    Series::marks(name, fractions.enumerate().map(|(i, fraction)| Point::new(i as f64, fraction)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_measure::report::draw::draw;
    use spherule_measure::stress::{Options, REGIMES, run};
    use spherule_render::graphics::Format;

    #[test]
    fn both_pictures_show_every_regime() {
        let regimes = REGIMES.iter().take(3).collect();
        let plot = plot(&run(&Options { rays: 300, seed: 0, regimes }, &|_| ()));
        let svg = String::from_utf8(draw(&plot, Format::Svg).unwrap()).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for words in ["near_unit", "far_1e3", "never", "0.001 %", "Spherule", "300 random rays"] {
            assert!(svg.contains(words), "{words}");
        }
        let png = draw(&plot, Format::Png).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let dark = pixels.chunks(3).filter(|pixel| pixel.iter().all(|&value| value < 100)).count();
        assert!(dark > 1000, "letters are drawn: {dark}");
        for color in [[213, 94, 0], [0, 114, 178], [0, 158, 115]] {
            assert!(pixels.chunks(3).any(|pixel| *pixel == color), "{color:?}");
        }
    }
}
