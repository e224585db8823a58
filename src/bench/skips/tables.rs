//! What was found about savings, as a table and a plot.

use super::Outcome;
use crate::report::{Axis, Column, Plot, Point, Series, Spread, Style, Table};

pub(super) fn table(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("saving", "What is left out."),
        Column::new("scene", "Where, changed so that it may be left out."),
        Column::new("with", "Time to render, the work left out.").unit("ms"),
        Column::new("without", "Time to render, the work done for nothing.").unit("ms"),
        Column::new("times as fast", "Time without by time with, round by round.")
            .style(Style::Fixed(3)),
        Column::new("what it is", "In words."),
    ];
    let mut table = Table::new("skips", "Savings", columns);
    for Outcome { name, about, scene, times } in outcomes {
        table.push([
            (*name).into(),
            scene.as_str().into(),
            times.seconds(0).times(1e3).into(),
            times.seconds(1).times(1e3).into(),
            times.ratio(0, 1).into(),
            about.as_str().into(),
        ]);
    }
    table
}

pub(super) fn plot(outcomes: &[Outcome]) -> Plot {
    let percent = |outcome: &Outcome| {
        let Spread { median, least, greatest } = outcome.times.ratio(0, 1);
        let saved = |ratio: f64| 100.0 * (1.0 - 1.0 / ratio);
        Spread { median: saved(median), least: saved(least), greatest: saved(greatest) }
    };
    let points =
        outcomes.iter().enumerate().map(|(i, outcome)| Point::spread(i as f64, percent(outcome)));
    let name = |outcome: &Outcome| format!("{}: {}", outcome.name, outcome.scene);
    Plot {
        name: "skips".to_owned(),
        title: "What leaving out saves".to_owned(),
        about: "Share of the time without it; medians and ranges over the rounds".to_owned(),
        note:
            "The picture is the same to the byte; with and without converged tiles, its error is."
                .to_owned(),
        place: Axis::names(outcomes.iter().map(name)),
        value: Axis::linear("time saved", "%"),
        series: vec![Series::marks("time saved", points)],
    }
}
