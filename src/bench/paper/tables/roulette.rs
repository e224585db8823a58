//! The paper's Table 1: Russian roulette.

use super::super::contest::{Agreement, Entry, Program, Stage, contest};
use super::super::scenes::PaperScene;
use super::{Plan, ratio, time};
use crate::bench::BenchError;
use crate::paper::Threading;
use crate::report::{Column, Style, Table};
use crate::scene::{Roulette, Settings};

/// The paper's probabilities to survive a bounce; the first is no roulette.
pub(crate) const PROBABILITIES: [f64; 3] = [1.0, 0.9, 0.5];

/// Two spheres that mirror each other, at one ray per pixel as in the paper, on one thread.
pub(crate) fn roulette(plan: &Plan) -> Result<Table, BenchError> {
    (plan.tell)("paper: Table 1, roulette");
    let stage = Stage::new(&PaperScene::TWO.scene((plan.size, 1))?)?;
    let programs = [Program::Paper(Threading::Critical), Program::Spherule];
    let entries: Vec<Entry> = PROBABILITIES
        .iter()
        .flat_map(|&p| {
            let settings = Settings { roulette: Roulette::Fixed(p), ..stage.settings.clone() };
            programs.map(|program| Entry { settings: settings.clone(), ..stage.entry(program, 1) })
        })
        .collect();
    let times = contest(plan.options.rounds, &entries)?;
    let mut columns = vec![
        Column::new("p", "Probability to survive a bounce; 1 is no roulette.")
            .style(Style::Fixed(1)),
        time("paper", "The paper's tracer, with its tree, on one thread."),
        ratio("gain of paper", "Times as fast as without roulette."),
        time("Spherule", "This program on one thread."),
        ratio("gain of Spherule", "Times as fast as without roulette."),
        ratio("paper : Spherule", "Time of the paper's tracer over Spherule's."),
    ];
    columns.extend(Agreement::columns());
    let title = "Table 1. Russian roulette: two mirroring spheres, one ray per pixel, one thread";
    let mut table = Table::new("paper-roulette", title, columns);
    for (row, &p) in PROBABILITIES.iter().enumerate() {
        let (paper, ours) = (2 * row, 2 * row + 1);
        let agreement = stage.agreement(programs[0], &entries[paper].settings)?;
        let cells = [
            p.into(),
            times.seconds(paper).into(),
            times.ratio(paper, 0).into(),
            times.seconds(ours).into(),
            times.ratio(ours, 1).into(),
            times.ratio(ours, paper).into(),
        ];
        table.push(cells.into_iter().chain(agreement.cells()));
    }
    table.notes.push(
        "Roulette takes time from the picture and gives it noise: `spherule bench roulette` weighs \
         one against the other."
            .to_owned(),
    );
    Ok(table)
}
