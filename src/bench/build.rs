//! Building trees: how long each builder takes, what the tree takes, and how good it is.

use super::rounds::{Times, clock};
use super::{BenchError, Options, Tell};
use crate::bvh::Bvh;
use crate::bvh::builders::{Builder, build};
use crate::report::{Axis, Cell, Column, Plot, Point, Report, Series, Style, Table};
use crate::spheres::Spheres;
use crate::workload::SphereScene;

const EXPLANATION: &str = "Each builder makes the tree from the same columns of spheres, by turns. \
    Times are medians over the rounds, with the least and the greatest; copying the columns is not \
    counted. Every tree is checked: each sphere is in one leaf, and each box holds what is below it.";

/// A builder with its name.
pub const BUILDERS: [(Builder, &str); 3] = [
    (Builder::Median, "median"),
    (Builder::SurfaceArea, "surface area"),
    (Builder::Morton, "Morton curve"),
];

/// Seconds that a turn takes at least.
const TURN: f64 = 0.02;

/// What was built, and how long it took.
struct Outcome {
    scene: SphereScene,
    times: Times,
    /// By builder.
    trees: Vec<(Bvh, Spheres)>,
}

/// Measures the builders.
///
/// # Errors
/// A scene is unknown or does not fit in memory, or a tree is wrong.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    use SphereScene as S;
    let most = [S::PAPER400, S::PAPER2500, S::LAYER250K, S::VOLUME1M, S::VOLUME10M];
    let usual = &most[..options.pick([1, 4, 5])];
    let scenes = options.choose(&S::ALL, usual, |scene| scene.name)?;
    let mut outcomes = Vec::new();
    for scene in scenes {
        tell(&format!("build: {}", scene.name));
        outcomes.push(of_scene(scene, options)?);
    }
    Ok(Report {
        name: "build".to_owned(),
        title: "Building the tree".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        tables: vec![table(&outcomes)],
        plots: vec![plot(&outcomes)],
    })
}

fn of_scene(scene: SphereScene, options: &Options) -> Result<Outcome, BenchError> {
    let spheres = scene.spheres()?;
    let mut trees = vec![None; BUILDERS.len()];
    let times = Times::by_turns(options.rounds, BUILDERS.len(), |i| {
        let (mut seconds, mut runs) = (0.0, 0);
        while runs == 0 || (seconds < TURN && options.rounds > 0) {
            let mut columns = spheres.clone();
            let (time, bvh) = clock(0.0, || build(&mut columns, BUILDERS[i].0));
            seconds += time;
            runs += 1;
            trees[i] = Some((bvh, columns));
        }
        Ok::<_, BenchError>(seconds / f64::from(runs))
    })?;
    let trees: Vec<_> = trees.into_iter().flatten().collect();
    for ((bvh, spheres), (_, name)) in trees.iter().zip(BUILDERS) {
        let wrong = |fault| BenchError::Differ(format!("{}, {name}: {fault}", scene.name));
        bvh.validate(spheres).map_err(wrong)?;
    }
    Ok(Outcome { scene, times, trees })
}

fn table(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Which spheres."),
        Column::new("spheres", "How many spheres there are."),
        Column::new("builder", "How the tree is cut."),
        Column::new("time", "From columns of spheres to the finished tree.").unit("ms"),
        Column::new("rate", "Spheres per time.").unit("Mspheres/s"),
        Column::new("memory", "Of the tree and the spheres that it has put in order, per sphere.")
            .unit("B/sphere"),
        Column::new(
            "nodes",
            "Nodes that a ray visits that passes through everything and hits nothing, by the \
             surface-area heuristic.",
        )
        .group("expected")
        .style(Style::Fixed(2)),
        Column::new("tests", "Spheres that such a ray is tested against, whole leaves of them.")
            .style(Style::Fixed(2)),
    ];
    let mut table = Table::new("build", "Builders", columns);
    for Outcome { scene, times, trees } in outcomes {
        for (i, ((bvh, spheres), (_, name))) in trees.iter().zip(BUILDERS).enumerate() {
            let seconds = times.seconds(i);
            let (bytes, cost) = (bvh.bytes() + spheres.bytes(), bvh.cost());
            table.push([
                scene.name.into(),
                scene.count.into(),
                name.into(),
                Cell::Spread(seconds.times(1e3)),
                seconds.under(1e-6 * scene.count as f64).into(),
                (bytes as f64 / scene.count as f64).into(),
                cost.nodes.into(),
                cost.spheres.into(),
            ]);
        }
    }
    table
}

fn plot(outcomes: &[Outcome]) -> Plot {
    let series = |(i, (_, name)): (usize, &(Builder, &'static str))| {
        let rate =
            |outcome: &Outcome| outcome.times.seconds(i).under(1e-6 * outcome.scene.count as f64);
        let rates = outcomes.iter().map(rate).enumerate();
        Series::marks(*name, rates.map(|(line, rate)| Point::spread(line as f64, rate)))
    };
    Plot {
        name: "build".to_owned(),
        title: "How fast trees are built".to_owned(),
        about: "Medians and ranges over the rounds; farther right is faster".to_owned(),
        note: String::new(),
        place: Axis::names(outcomes.iter().map(|outcome| outcome.scene.name)),
        value: Axis::log("built", "million spheres per second"),
        series: BUILDERS.iter().enumerate().map(series).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;

    #[test]
    fn every_builder_has_a_row_for_each_scene() {
        let report = measure(&quick(&["paper400", "paper2500"]), &|_| ()).unwrap();
        let rows = &report.tables[0].rows;
        assert_eq!(rows.len(), 2 * BUILDERS.len());
        for row in rows {
            let Cell::Spread(time) = row[3] else { panic!("{row:?}") };
            assert!(time.least > 0.0 && time.least <= time.median && time.median <= time.greatest);
            assert!(matches!(row[5], Cell::Number(bytes) if (20.0..60.0).contains(&bytes)));
        }
        assert!(measure(&quick(&["nowhere"]), &|_| ()).is_err());
    }
}
