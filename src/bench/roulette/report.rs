//! Tables and plots of what roulette costs and buys.

use super::race::Outcome;
use super::{Found, STRATEGIES};
use crate::report::{Axis, Cell, Column, Plot, Point, Series, Style, Table};

/// At one ray per pixel, and at equal time.
pub(super) fn tables(found: &[Found]) -> Vec<Table> {
    let one = "Table 1 of the paper, with errors: one ray per pixel";
    let one = table("roulette-one", one, found, |found| &found.ladder[0]);
    let equal = "At equal time";
    let mut equal = table("roulette-equal", equal, found, |found| &found.equal);
    equal.notes.push(
        "The number of samples is what takes the time of the paper's tracer without roulette, to \
         the nearest whole number."
            .to_owned(),
    );
    vec![one, equal]
}

fn table(
    name: &str,
    title: &str,
    found: &[Found],
    outcomes: impl Fn(&Found) -> &Vec<Outcome>,
) -> Table {
    let mut table = Table::new(name, title, columns());
    for found in found {
        let outcomes = outcomes(found);
        for outcome in outcomes {
            let plain = &outcomes[outcome.strategy.plain()];
            table.push([
                found.scene.name.into(),
                outcome.strategy.name.into(),
                u64::from(outcome.spp).into(),
                outcome.seconds.times(1e3).into(),
                (plain.seconds_per_sample() / outcome.seconds_per_sample()).into(),
                outcome.error.into(),
                outcome.rmse.into(),
                outcome.efficiency(plain).into(),
                outcome.efficiency(&outcomes[0]).into(),
                outcome.bias.into(),
                Cell::Number(outcome.bias_error),
            ]);
        }
        let (scene, error) = (found.scene.name, Style::Usual.write(found.error));
        table.notes.push(format!("Error of the reference of {scene}: {error}."));
    }
    table
}

fn columns() -> Vec<Column> {
    vec![
        Column::new("scene", "Which of the paper's scenes."),
        Column::new("roulette", "The program, and how paths end by chance."),
        Column::new("spp", "Samples in each pixel."),
        Column::new("time", "Of a render.").unit("ms"),
        Column::new("gain", "Times as fast, by the sample, as the same program without roulette.")
            .style(Style::Fixed(2)),
        Column::new("error", "Root mean square over all pixels and channels, of radiance up to 1."),
        Column::new(
            "efficiency",
            "Times as fast as the same program without roulette to an equal error, if squared error \
             falls as the inverse of time: below 1, roulette does not pay.",
        )
        .style(Style::Fixed(2)),
        Column::new("against the paper", "The same against the paper's tracer without roulette.")
            .style(Style::Fixed(2)),
        Column::new("bias", "Mean of all runs less the reference's, over the latter.")
            .style(Style::Percent),
        Column::new("standard error", "What the bias may be by chance.").style(Style::Percent),
    ]
}

/// Error against time, a curve for each strategy.
pub(super) fn plot(found: &Found) -> Plot {
    let steps = || found.ladder.iter().chain([&found.equal]);
    let curve = |index: usize| {
        let points = steps().map(|step| &step[index]);
        let points = points.map(|outcome| Point::spread(outcome.seconds.median, outcome.error));
        Series::joined(STRATEGIES[index].name, points)
    };
    let times = || steps().flatten().map(|outcome| outcome.seconds.median);
    let ends = [times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max)];
    let limit = ends.map(|time| Point::new(time, found.error));
    let limit = Series { color: None, ..Series::model("error of the reference", limit, 0) };
    Plot {
        name: format!("roulette-{}", found.scene.name),
        title: format!("Russian roulette: {}", found.scene.name),
        about: "Error against time with more and more samples; lower left is better".to_owned(),
        note: "Bars: least and greatest error of the runs.".to_owned(),
        place: Axis::log("time", "s"),
        value: Axis::log("error, root mean square", ""),
        series: (0..STRATEGIES.len()).map(curve).chain([limit]).collect(),
    }
}
