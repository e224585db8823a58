//! The paper's Table 3 and Figure 3: the tree, by number of spheres.

use super::super::comparison::{Agreement, Program, SceneSetup, TURN, time_entries};
use super::super::scenes::PaperScene;
use super::{Plan, ratio, time};
use crate::bench::BenchError;
use crate::bench::rounds::{Times, clock};
use crate::bench::threads::pool;
use crate::report::{Axis, Column, Plot, Point, Series, Spread, Table};
use indicatif::HumanCount;
use spherule_paper::{PaperTracer, Threading};
use spherule_render::bvh::builders::{Builder, build};
use spherule_render::scene::Scene;
use spherule_render::world::World;

/// Spheres along each side of the grids.
const COUNTS: [u64; 6] = [10, 20, 50, 100, 200, 500];

/// Maximum number of sphere tests of a render without tree, by effort: about a second, or minutes.
const MAX_TESTS: [u64; 3] = [50_000_000, 1_000_000_000, 200_000_000_000];

const THREADING: Threading = Threading::Critical;
const BRUTE: Program = Program::Brute(THREADING);
const PAPER: Program = Program::Paper(THREADING);

/// Times of building and rendering a grid.
struct Row {
    count: u64,
    builds: Times,
    renders: Times,
    /// True if the last contestant of `renders` is the tracer without tree.
    brute: bool,
    agreement: Agreement,
}

/// Measures construction and rendering of grids with increasing numbers of spheres in the same square.
pub(crate) fn spheres(plan: &Plan) -> Result<(Table, Plot), BenchError> {
    let counts = &COUNTS[..plan.options.pick([2, 6, 6])];
    let mut rows = Vec::new();
    for &count in counts {
        (plan.progress)(&format!("paper: Table 3, {count} x {count} spheres"));
        rows.push(row(plan, count)?);
    }
    let title = "Table 3. The tree: grids of spheres in the same square, one thread";
    let mut table = Table::new("paper-spheres", title, columns());
    for row in &rows {
        let brute = row.brute.then(|| row.renders.seconds(2));
        let cells = [
            (row.count * row.count).into(),
            row.builds.seconds(0).into(),
            row.builds.seconds(1).into(),
            row.builds.ratio(1, 0).into(),
            brute.into(),
            row.renders.seconds(0).into(),
            row.renders.seconds(1).into(),
            row.renders.ratio(1, 0).into(),
        ];
        table.push(cells.into_iter().chain(row.agreement.cells()));
    }
    table.notes = vec![
        "The paper took 6.15 s to build the tree of 500 x 500 spheres.".to_owned(),
        format!(
            "Without a tree every ray is tested against every sphere; \"-\" where that would take \
             more than {} tests.",
            HumanCount(plan.options.pick(MAX_TESTS))
        ),
    ];
    Ok((table, plot(&rows)))
}

fn row(plan: &Plan, count: u64) -> Result<Row, BenchError> {
    let scene = PaperScene::grid(count, plan.size, plan.spp)?;
    let setup = SceneSetup::new(&scene)?;
    let (_, rays) = setup.render(Program::Spherule, &setup.settings)?;
    let brute = rays.saturating_mul(count * count) <= plan.options.pick(MAX_TESTS);
    let programs = [PAPER, Program::Spherule, BRUTE];
    let programs = &programs[..2 + usize::from(brute)];
    let entries: Vec<_> = programs.iter().map(|program| setup.entry(*program, 1)).collect();
    Ok(Row {
        count,
        builds: builds(plan, &scene)?,
        renders: time_entries(plan.options.rounds, &entries)?,
        brute,
        agreement: setup.agreement(PAPER, &super::reseeded(&setup.settings))?,
    })
}

/// Times the construction of the paper's tree and of Spherule's best BVH, each on one thread.
fn builds(plan: &Plan, scene: &Scene) -> Result<Times, BenchError> {
    let named = |error| BenchError::World(scene.title.clone(), error);
    let world = World::build(scene).map_err(named)?;
    let tracer = PaperTracer::new(scene, &world, false)?;
    let turn = |contestant| {
        repeat(|| {
            if contestant == 0 {
                return clock(0.0, || tracer.hierarchy()).0;
            }
            let mut spheres = world.spheres.clone();
            clock(0.0, || build(&mut spheres, Builder::SurfaceArea)).0
        })
    };
    let one = pool(1)?;
    Times::measure(plan.options.rounds, 2, |contestant| Ok(one.install(|| turn(contestant))))
}

/// Repeats a build, which returns its seconds, for the duration of a turn. Returns the mean. Dropping
/// what was built is not measured.
fn repeat(mut build: impl FnMut() -> f64) -> f64 {
    let (mut seconds, mut runs) = (build(), 1);
    while seconds < TURN {
        seconds += build();
        runs += 1;
    }
    seconds / f64::from(runs)
}

fn columns() -> Vec<Column> {
    let mut columns = vec![
        Column::new("spheres", "Number of spheres, without the emitter."),
        time("paper's build", "Construction of the paper's tree from the array of spheres.")
            .group("build"),
        time(
            "Spherule's build",
            "Construction by the surface-area heuristic, with sorting of the spheres.",
        ),
        ratio(
            "build, paper : Spherule",
            "Construction time of the paper's tree divided by Spherule's.",
        ),
        time("no tree", "The paper's tracer without its tree.").group("render"),
        time("paper", "The paper's tracer with its tree."),
        time("Spherule", "Spherule."),
        ratio(
            "paper : Spherule",
            "Time of the paper's tracer with its tree divided by Spherule's.",
        ),
    ];
    columns.extend(Agreement::columns());
    columns
}

/// Plots Figure 3.
fn plot(rows: &[Row]) -> Plot {
    type Of = fn(&Row) -> Option<Spread>;
    let series: [(&str, Of); 5] = [
        ("render, no tree", |row| row.brute.then(|| row.renders.seconds(2))),
        ("render, paper's tree", |row| Some(row.renders.seconds(0))),
        ("render, Spherule", |row| Some(row.renders.seconds(1))),
        ("build, paper", |row| Some(row.builds.seconds(0))),
        ("build, Spherule", |row| Some(row.builds.seconds(1))),
    ];
    let points = |of: Of| {
        let place = |row: &Row| (row.count * row.count) as f64;
        rows.iter().filter_map(move |row| Some(Point::spread(place(row), of(row)?)))
    };
    Plot {
        name: "paper-spheres".to_owned(),
        title: "Figure 3. Time by number of spheres".to_owned(),
        about: "Grids in the same square, one thread; median and range over the rounds".to_owned(),
        note: String::new(),
        place: Axis::log("spheres", ""),
        value: Axis::log("time", "s"),
        series: series.map(|(name, of)| Series::joined(name, points(of))).to_vec(),
    }
}
