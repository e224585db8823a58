//! Tables and plots of traversals.

use super::{BUILDERS, Class, Outcome, SINGLE, VARIANTS, Variant};
use crate::report::{Axis, Cell, Column, Plot, Point, Series, Spread, Style, Table};

fn rate(outcome: &Outcome, contestant: usize) -> Spread {
    outcome.times.seconds(contestant).rate(1e-6 * outcome.rays as f64)
}

pub(super) fn rates(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Set of spheres, in a BVH by the surface-area heuristic."),
        Column::new("rays", "Class of rays."),
        Column::new("hit", "Fraction of rays that hit a sphere.").style(Style::Percent),
        Column::new("walk", "Traversal."),
        Column::new("rate", "Rays per second on one thread.").unit("Mrays/s"),
        Column::new("ratio", "Speedup over single rays, computed for each round.").unit("single"),
        Column::new("nodes", "Nodes visited.").unit("/ray").style(Style::Fixed(2)),
        Column::new("spheres", "Spheres tested, eight at a time.")
            .unit("/ray")
            .style(Style::Fixed(2)),
        Column::new("candidates", "Spheres that pass the conservative test.")
            .unit("/ray")
            .style(Style::Fixed(2)),
    ];
    let mut table = Table::new("traversal", "Traversals", columns);
    for outcome in outcomes {
        let per_ray = |count: u64| count as f64 / outcome.rays.max(1) as f64;
        for (i, variant) in VARIANTS.iter().enumerate() {
            let rate = rate(outcome, i);
            if rate.median.is_nan() {
                continue;
            }
            let visits = outcome.visits[i];
            table.push([
                outcome.scene.name.into(),
                outcome.class.name().into(),
                outcome.hits.into(),
                variant.name.into(),
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
        vec![Column::new("scene", "Set of spheres."), Column::new("rays", "Class of rays.")];
    let about = "Rays per second on one thread, by the traversal auto in this builder's BVH.";
    columns.extend(BUILDERS.map(|(_, name)| Column::new(name, about).unit("Mrays/s")));
    let mut table = Table::new("traversal-builders", "BVH of each builder", columns);
    for outcome in outcomes {
        let names = [outcome.scene.name, outcome.class.name()].map(Cell::from);
        let rates = (0..BUILDERS.len()).map(|i| rate(outcome, VARIANTS.len() + i).into());
        table.push(names.into_iter().chain(rates));
    }
    table
}

pub(super) fn plot(class: Class, outcomes: &[Outcome]) -> Plot {
    let outcomes: Vec<_> = outcomes.iter().filter(|outcome| outcome.class == class).collect();
    let series = |(i, variant): (usize, &Variant)| {
        let rates = outcomes.iter().map(|outcome| rate(outcome, i)).enumerate();
        Series::marks(variant.name, rates.map(|(line, rate)| Point::spread(line as f64, rate)))
    };
    let title = match class {
        Class::Camera => "Camera rays: closest hit",
        Class::Shadow => "Shadow rays toward one light: any hit",
        Class::Occlusion => "Ambient occlusion, cosine-distributed: any hit",
        Class::Diffuse => "Diffuse bounces, cosine-distributed: closest hit",
    };
    Plot {
        name: format!("traversal-{}", class.name()),
        title: title.to_owned(),
        about: "One thread; median and range over the rounds; farther right is faster".to_owned(),
        note: String::new(),
        place: Axis::names(outcomes.iter().map(|outcome| outcome.scene.name)),
        value: Axis::log("trace rate", "million rays per second"),
        series: VARIANTS.iter().enumerate().map(series).collect(),
    }
}
