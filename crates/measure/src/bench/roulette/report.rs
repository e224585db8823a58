//! Tables and plots of time and error by roulette.

use super::experiment::Outcome;
use super::{STRATEGIES, SceneResult};
use crate::report::{Axis, Cell, Column, Plot, Point, Series, Style, Table};

/// Returns the tables at one ray per pixel and at equal time.
pub(super) fn tables(found: &[SceneResult]) -> Vec<Table> {
    let one = "Table 1 of the paper, with errors: one ray per pixel";
    let one = table("roulette-one", one, found, |found| &found.levels[0]);
    let equal = "At equal time";
    let mut equal = table("roulette-equal", equal, found, |found| &found.equal);
    equal.notes.push(
        "The number of samples is chosen, as a whole number, such that each render takes the time of \
         the paper's tracer without roulette."
            .to_owned(),
    );
    vec![one, equal]
}

fn table(
    name: &str,
    title: &str,
    found: &[SceneResult],
    outcomes: impl Fn(&SceneResult) -> &Vec<Outcome>,
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
        Column::new("scene", "Scene of the paper."),
        Column::new("roulette", "Program and roulette."),
        Column::new("spp", "Samples per pixel."),
        Column::new("time", "Time of a render.").unit("ms"),
        Column::new("gain", "Speedup per sample over the same program without roulette.")
            .style(Style::Fixed(2)),
        Column::new(
            "error",
            "Root mean squared error over all pixels and channels, of radiance clamped to 1.",
        ),
        Column::new(
            "efficiency",
            "Speedup to equal error over the same program without roulette, if squared error is \
             inversely proportional to time: below 1, roulette does not pay.",
        )
        .style(Style::Fixed(2)),
        Column::new(
            "against the paper",
            "Speedup to equal error over the paper's tracer without roulette.",
        )
        .style(Style::Fixed(2)),
        Column::new("bias", "Mean of all runs minus the reference's, relative to the latter.")
            .style(Style::Percent),
        Column::new("standard error", "Standard error of the bias.").style(Style::Percent),
    ]
}

/// Plots error over time, with a curve for each strategy.
pub(super) fn plot(found: &SceneResult) -> Plot {
    let levels = || found.levels.iter().chain([&found.equal]);
    let curve = |index: usize| {
        let points = levels().map(|level| &level[index]);
        let points = points.map(|outcome| Point::spread(outcome.seconds.median, outcome.error));
        Series::joined(STRATEGIES[index].name, points)
    };
    let times = || levels().flatten().map(|outcome| outcome.seconds.median);
    let ends = [times().fold(f64::INFINITY, f64::min), times().fold(0.0, f64::max)];
    let limit = ends.map(|time| Point::new(time, found.error));
    let limit = Series { color: None, ..Series::model("error of the reference", limit, 0) };
    Plot {
        name: format!("roulette-{}", found.scene.name),
        title: format!("Russian roulette: {}", found.scene.name),
        about: "Error over time with increasing samples; lower left is better".to_owned(),
        note: "Bars: minimum and maximum error of the runs.".to_owned(),
        place: Axis::log("time", "s"),
        value: Axis::log("root mean squared error", ""),
        series: (0..STRATEGIES.len()).map(curve).chain([limit]).collect(),
    }
}
