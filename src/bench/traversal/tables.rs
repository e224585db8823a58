//! What was found about walks, as tables and plots.

use super::{BUILDERS, Class, Outcome, SINGLE, WALKS, Walk};
use crate::report::{Axis, Cell, Column, Plot, Point, Series, Spread, Style, Table};

fn rate(outcome: &Outcome, contestant: usize) -> Spread {
    outcome.times.seconds(contestant).under(1e-6 * outcome.rays as f64)
}

pub(super) fn walks(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Which spheres; the tree is that of the surface-area heuristic."),
        Column::new("rays", "Which class of rays."),
        Column::new("hit", "Share of the rays that hit something.").style(Style::Percent),
        Column::new("walk", "How rays find spheres."),
        Column::new("rate", "Rays per time on one thread.").unit("Mrays/s"),
        Column::new("ratio", "How many times as fast as single rays, round by round.")
            .unit("single"),
        Column::new("nodes", "Nodes visited.").unit("/ray").style(Style::Fixed(2)),
        Column::new("spheres", "Spheres tested, eight at a time.")
            .unit("/ray")
            .style(Style::Fixed(2)),
        Column::new("candidates", "Spheres that this test let pass.")
            .unit("/ray")
            .style(Style::Fixed(2)),
    ];
    let mut table = Table::new("traversal", "Walks", columns);
    for outcome in outcomes {
        let per_ray = |count: u64| count as f64 / outcome.rays.max(1) as f64;
        for (i, walk) in WALKS.iter().enumerate() {
            let rate = rate(outcome, i);
            if rate.median.is_nan() {
                continue;
            }
            let visits = outcome.visits[i];
            table.push([
                outcome.scene.name.into(),
                outcome.class.name().into(),
                outcome.hits.into(),
                walk.name.into(),
                rate.into(),
                outcome.times.ratio(i, SINGLE).into(),
                visits.map(|visits| per_ray(visits.nodes)).into(),
                visits.map(|visits| per_ray(visits.spheres())).into(),
                visits.map(|visits| per_ray(visits.candidates)).into(),
            ]);
        }
    }
    table
}

pub(super) fn builders(outcomes: &[Outcome]) -> Table {
    let mut columns =
        vec![Column::new("scene", "Which spheres."), Column::new("rays", "Which class of rays.")];
    let about = "Rays per time on one thread, by the walk auto, in the tree of this builder.";
    columns.extend(BUILDERS.map(|(_, name)| Column::new(name, about).unit("Mrays/s")));
    let mut table = Table::new("traversal-builders", "Trees of each builder", columns);
    for outcome in outcomes {
        let names = [outcome.scene.name, outcome.class.name()].map(Cell::from);
        let rates = (0..BUILDERS.len()).map(|i| rate(outcome, WALKS.len() + i).into());
        table.push(names.into_iter().chain(rates));
    }
    table
}

pub(super) fn plot(class: Class, outcomes: &[Outcome]) -> Plot {
    let outcomes: Vec<_> = outcomes.iter().filter(|outcome| outcome.class == class).collect();
    let series = |(i, walk): (usize, &Walk)| {
        let rates = outcomes.iter().map(|outcome| rate(outcome, i)).enumerate();
        Series::marks(walk.name, rates.map(|(line, rate)| Point::spread(line as f64, rate)))
    };
    let title = match class {
        Class::Camera => "Camera rays: what is hit first",
        Class::Shadow => "Shadow rays toward one light: whether anything is hit",
        Class::Occlusion => "Ambient occlusion, cosine-distributed: whether anything is hit",
        Class::Diffuse => "Diffuse bounces, cosine-distributed: what is hit first",
    };
    Plot {
        name: format!("traversal-{}", class.name()),
        title: title.to_owned(),
        about: "One thread; medians and ranges over the rounds; farther right is faster".to_owned(),
        note: String::new(),
        place: Axis::names(outcomes.iter().map(|outcome| outcome.scene.name)),
        value: Axis::log("traced", "million rays per second"),
        series: WALKS.iter().enumerate().map(series).collect(),
    }
}
