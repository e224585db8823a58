//! The table and the plot of elisions.

use super::Outcome;
use crate::report::{Axis, Column, Plot, Point, Series, Spread, Style, Table};

pub(super) fn table(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("saving", "Work that is skipped."),
        Column::new("scene", "Scene, changed so that the work may be skipped."),
        Column::new("with", "Time of a render that skips the work.").unit("ms"),
        Column::new("without", "Time of a render that does the work.").unit("ms"),
        Column::new("times as fast", "Speedup by skipping the work, computed for each round.")
            .style(Style::Fixed(3)),
        Column::new("what it is", "Description."),
    ];
    let mut table = Table::new("skips", "Skipped work", columns);
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
        title: "Time saved by skipping work".to_owned(),
        about: "Fraction of the time without skipping; median and range over the rounds".to_owned(),
        note: "Images are equal byte for byte; for converged tiles, errors are equal.".to_owned(),
        place: Axis::names(outcomes.iter().map(name)),
        value: Axis::linear("time saved", "%"),
        series: vec![Series::marks("time saved", points)],
    }
}
