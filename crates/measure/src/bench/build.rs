//! BVH construction: time, memory and quality of each builder.

use super::rounds::{Times, clock};
use super::{BenchError, Options, Progress};
use crate::report::{Axis, Cell, Column, Plot, Point, Report, Series, Style, Table};
use crate::workload::SphereScene;
use spherule_render::bvh::Bvh;
use spherule_render::bvh::builders::{Builder, build};
use spherule_render::spheres::Spheres;

const EXPLANATION: &str = "Each builder builds a BVH from the same arrays of spheres, in turns. \
    Times are medians over the rounds, with minimum and maximum; copying the arrays is not \
    counted. Every BVH is validated: each sphere is in one leaf, and each box contains its subtree.";

/// The builders, with their names.
pub const BUILDERS: [(Builder, &str); 3] = [
    (Builder::Median, "median"),
    (Builder::SurfaceArea, "surface area"),
    (Builder::Morton, "Morton curve"),
];

/// Minimum duration of a turn in seconds; short builds are repeated.
const TURN: f64 = 0.02;

/// The BVHs of a scene, and their build times.
struct Outcome {
    scene: SphereScene,
    times: Times,
    /// One for each builder.
    trees: Vec<(Bvh, Spheres)>,
}

/// Measures the builders.
///
/// # Errors
/// A scene is unknown or does not fit in memory, or a BVH is invalid.
pub fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    use SphereScene as S;
    let scenes = [S::PAPER400, S::PAPER2500, S::LAYER250K, S::VOLUME1M, S::VOLUME10M];
    let usual = &scenes[..options.pick([1, 4, 5])];
    let scenes = options.choose(&S::ALL, usual, |scene| scene.name)?;
    let mut outcomes = Vec::new();
    for scene in scenes {
        progress(&format!("build: {}", scene.name));
        outcomes.push(measure_scene(scene, options)?);
    }
    Ok(Report {
        name: "build".to_owned(),
        title: "BVH construction".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        tables: vec![table(&outcomes)],
        plots: vec![plot(&outcomes)],
    })
}

fn measure_scene(scene: SphereScene, options: &Options) -> Result<Outcome, BenchError> {
    let spheres = scene.spheres()?;
    let mut trees = vec![None; BUILDERS.len()];
    let times = Times::measure(options.rounds, BUILDERS.len(), |i| {
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
        let invalid = |fault| BenchError::Differ(format!("{}, {name}: {fault}", scene.name));
        bvh.validate(spheres).map_err(invalid)?;
    }
    Ok(Outcome { scene, times, trees })
}

fn table(outcomes: &[Outcome]) -> Table {
    let columns = vec![
        Column::new("scene", "Set of spheres."),
        Column::new("spheres", "Number of spheres."),
        Column::new("builder", "Construction algorithm."),
        Column::new("time", "From arrays of spheres to the finished BVH.").unit("ms"),
        Column::new("rate", "Spheres per second.").unit("Mspheres/s"),
        Column::new("memory", "Bytes per sphere, of the BVH and the sorted spheres.")
            .unit("B/sphere"),
        Column::new(
            "nodes",
            "Expected number of nodes that a random ray visits if it hits nothing, by the \
             surface-area heuristic.",
        )
        .group("expected")
        .style(Style::Fixed(2)),
        Column::new(
            "tests",
            "Expected number of spheres tested by such a ray; leaves count as full.",
        )
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
                seconds.rate(1e-6 * scene.count as f64).into(),
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
            |outcome: &Outcome| outcome.times.seconds(i).rate(1e-6 * outcome.scene.count as f64);
        let rates = outcomes.iter().map(rate).enumerate();
        Series::marks(*name, rates.map(|(line, rate)| Point::spread(line as f64, rate)))
    };
    Plot {
        name: "build".to_owned(),
        title: "BVH construction speed".to_owned(),
        about: "Median and range over the rounds; farther right is faster".to_owned(),
        note: String::new(),
        place: Axis::names(outcomes.iter().map(|outcome| outcome.scene.name)),
        value: Axis::log("build rate", "million spheres per second"),
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
