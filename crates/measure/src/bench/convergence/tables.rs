//! Tables and plots of errors.

use super::fit;
use super::outcome::Outcome;
use super::variants::Variant;
use crate::report::{Axis, Column, Plot, Point, Series, Style, Table};

pub(super) fn levels(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Scene that is rendered."),
        Column::new("variant", "Difference from the scene's settings."),
        Column::new("samples", "Mean samples per pixel."),
        Column::new("rays", "Mean rays per pixel, including probes."),
        Column::new("time", "Time of rendering.").unit("ms"),
        Column::new("RMSE", "Root mean squared error, minus the reference's own."),
        Column::new(
            "relative MSE",
            "Mean of squared errors relative to the squares of the reference.",
        ),
        Column::new("efficiency", "1 / (mean squared error x time).").unit("1/s"),
    ];
    let mut table = Table::new("error", "Errors", columns);
    for outcome in outcomes {
        for (variant, Variant { name, .. }) in outcome.variants.iter().enumerate() {
            for level in 0..outcome.levels.len() {
                table.push([
                    outcome.scene.as_str().into(),
                    (*name).into(),
                    outcome.samples(variant, level).into(),
                    outcome.rays(variant, level).into(),
                    outcome.seconds(variant, level).times(1e3).into(),
                    outcome.rmse(variant, level).into(),
                    outcome.error(variant, level, |squares| squares.relative).into(),
                    outcome.efficiency(variant, level).into(),
                ]);
            }
        }
    }
    table.notes = vec![
        "The reference's own error is subtracted. Where it is larger than the rest, nothing is shown."
            .to_owned(),
    ];
    table
}

pub(super) fn summary(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Scene that is rendered."),
        Column::new("variant", "Difference from the scene's settings."),
        Column::new(
            "samples",
            "Slope of log RMSE over log samples, by least squares: -0.5 for independent samples; \
             lower is better.",
        )
        .group("slope over")
        .style(Style::Fixed(2)),
        Column::new("seconds", "Slope of log RMSE over log time.").style(Style::Fixed(2)),
        Column::new("error", "Smallest RMSE that both variants reach.").group("to equal error"),
        Column::new("time to it", "Time to this error, interpolated in log-log space.").unit("ms"),
        Column::new("times as fast", "Speedup over the first variant to equal error.")
            .style(Style::Fixed(2)),
    ];
    let mut table = Table::new("error-slopes", "Slopes, and times to equal error", columns);
    for outcome in outcomes {
        let first = pairs(&outcome.over_time(0));
        for (variant, Variant { name, .. }) in outcome.variants.iter().enumerate() {
            let own = pairs(&outcome.over_time(variant));
            let equal = fit::equal(&first, &own);
            table.push([
                outcome.scene.as_str().into(),
                (*name).into(),
                fit::slope(&pairs(&outcome.over_samples(variant))).into(),
                fit::slope(&own).into(),
                equal.map(|equal| equal.value).into(),
                equal.map(|equal| equal.places[1] * 1e3).into(),
                equal.map(|equal| equal.places[0] / equal.places[1]).into(),
            ]);
        }
    }
    table
}

pub(super) fn references(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Scene that is rendered."),
        Column::new("pixels", "Pixels of the image."),
        Column::new("samples", "Samples per pixel, of both halves."),
        Column::new("RMSE", "The reference's own error, estimated from its halves."),
        Column::new("relative MSE", "The reference's own relative error."),
    ];
    let mut table = Table::new("error-references", "References", columns);
    for Outcome { scene, reference, .. } in outcomes {
        table.push([
            scene.as_str().into(),
            (reference.mean.pixels.len() as u64).into(),
            (2 * u64::from(reference.samples)).into(),
            reference.error.absolute.sqrt().into(),
            reference.error.relative.into(),
        ]);
    }
    table
}

fn pairs(points: &[Point]) -> Vec<(f64, f64)> {
    points.iter().map(|point| (point.place, point.value.median)).collect()
}

/// Error over time, samples and rays.
pub(super) fn plots(outcome: &Outcome) -> [Plot; 3] {
    let time = Axis::log("time to render", "s");
    let [samples, rays] = ["samples per pixel", "rays per pixel"].map(|label| Axis::log(label, ""));
    [
        plot(outcome, "time", time, |variant| outcome.over_time(variant)),
        plot(outcome, "samples", samples, |variant| outcome.over_samples(variant)),
        plot(outcome, "rays", rays, |variant| outcome.over_rays(variant)),
    ]
}

fn plot(outcome: &Outcome, name: &str, place: Axis, curve: impl Fn(usize) -> Vec<Point>) -> Plot {
    let series = |(i, variant): (usize, &Variant)| Series::joined(variant.name, curve(i));
    let mut series: Vec<_> = outcome.variants.iter().enumerate().map(series).collect();
    let ends = series.first().map(|series| series.points.as_slice());
    if let Some([first, .., last]) = ends {
        let (at, value) = (first.place, first.value.median);
        let ideal = [at, last.place].map(|place| Point::new(place, value * (at / place).sqrt()));
        series.push(Series::model("slope -1/2", ideal, 7));
    }
    let error = Style::Usual.write(outcome.reference.error.absolute.sqrt());
    Plot {
        name: format!("error-{name}-{}", outcome.scene),
        title: format!("Error against {name}: {}", outcome.scene),
        about: "Median and range over seeds; lower left is better".to_owned(),
        note: format!("The reference's own RMSE, {error}, is subtracted."),
        place,
        value: Axis::log("root mean squared error", "radiance"),
        series,
    }
}
