//! The paper's Table 2: threads.

use super::super::comparison::{Agreement, Program, SceneSetup, time_entries};
use super::super::scenes::PaperScene;
use super::{Plan, ratio, time};
use crate::bench::BenchError;
use crate::bench::rounds::Times;
use crate::bench::threads::pool;
use crate::report::{Axis, Column, Plot, Point, Series, Table};
use spherule_paper::Threading;

const PROGRAMS: [(Program, &str); 3] = [
    (Program::Paper(Threading::Critical), "paper, critical sections"),
    (Program::Paper(Threading::Independent), "paper, own numbers"),
    (Program::Spherule, "Spherule"),
];

/// Index of the color of models.
const GRAY: usize = 7;

/// Measures the speedup of the random field on 1, 2, 4, ... threads and on all.
pub(crate) fn threads(plan: &Plan) -> Result<(Table, Plot), BenchError> {
    (plan.progress)("paper: Table 2, threads");
    let setup = SceneSetup::new(&PaperScene::FIELD.scene(plan.size, plan.spp)?)?;
    let counts = counts(plan.options.threads);
    let entries: Vec<_> = counts
        .iter()
        .flat_map(|&count| PROGRAMS.map(|(program, _)| setup.entry(program, count)))
        .collect();
    let times = time_entries(plan.options.rounds, &entries)?;
    let title = "Table 2. Threads: the random field of 20 x 20 spheres";
    let mut table = Table::new("paper-threads", title, columns());
    for (row, &count) in counts.iter().enumerate() {
        let first = row * PROGRAMS.len();
        let mut cells = vec![(count as u64).into()];
        for program in 0..PROGRAMS.len() {
            cells.push(times.seconds(first + program).into());
            cells.push(times.ratio(first + program, program).into());
        }
        cells.push(times.ratio(first + 2, first).into());
        let settings = super::reseeded(&setup.settings);
        let compared = pool(count)?.install(|| setup.agreement(PROGRAMS[0].0, &settings))?;
        table.push(cells.into_iter().chain(compared.cells()));
    }
    table.notes.push(
        "The paper: 573 s on one thread, 289 s on four (1.98 times as fast), because random \
         numbers and the list of finished pixels were in critical sections."
            .to_owned(),
    );
    Ok((table, plot(&times, &counts)))
}

/// Returns the powers of two below `all`, and `all`.
fn counts(all: usize) -> Vec<usize> {
    let powers = (0..).map(|exponent| 1 << exponent).take_while(|count| *count < all);
    powers.chain([all]).collect()
}

fn columns() -> Vec<Column> {
    let speedup = |name: &str| ratio(name, "Speedup over one thread.");
    let mut columns = vec![
        Column::new("threads", "Number of threads."),
        time("paper", "The paper's tracer with its tree and its critical sections."),
        speedup("gain of paper"),
        time(
            "own numbers",
            "The same with a random sequence for each row, without critical sections.",
        ),
        speedup("gain of own numbers"),
        time("Spherule", "Spherule."),
        speedup("gain of Spherule"),
        ratio("paper : Spherule", "Time of the paper's tracer divided by Spherule's."),
    ];
    columns.extend(Agreement::columns());
    columns
}

fn plot(times: &Times, counts: &[usize]) -> Plot {
    let series = PROGRAMS.iter().enumerate().map(|(program, (_, name))| {
        let points = counts.iter().enumerate().map(|(row, &count)| {
            let speedup = times.ratio(row * PROGRAMS.len() + program, program);
            Point::spread(count as f64, speedup)
        });
        Series::joined(*name, points)
    });
    let ends = [1.0, counts.last().map_or(1.0, |&count| count as f64)];
    let ideal = Series::model("ideal", ends.map(|end| Point::new(end, end)), GRAY);
    Plot {
        name: "paper-threads".to_owned(),
        title: "Thread scaling".to_owned(),
        about: "Random field of 20 x 20 spheres; median and range over the rounds".to_owned(),
        note: "The paper reached 1.98 on four threads.".to_owned(),
        place: Axis::linear("threads", ""),
        value: Axis::linear("speedup over one thread", ""),
        series: series.chain([ideal]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_double_up_to_all() {
        assert_eq!(counts(1), [1]);
        assert_eq!(counts(2), [1, 2]);
        assert_eq!(counts(6), [1, 2, 4, 6]);
    }
}
