//! The paper's Table 1: Russian roulette.

use super::super::comparison::{Agreement, Entry, Program, SceneSetup, time_entries};
use super::super::scenes::PaperScene;
use super::{Plan, ratio, time};
use crate::bench::BenchError;
use crate::report::{Column, Style, Table};
use spherule_paper::Threading;
use spherule_render::scene::{Roulette, Settings};

/// The paper's probabilities of surviving a bounce; the first is no roulette.
pub(crate) const PROBABILITIES: [f64; 3] = [1.0, 0.9, 0.5];

/// Renders two mirrors that reflect each other with one ray per pixel, as in the paper, on one thread.
pub(crate) fn roulette(plan: &Plan) -> Result<Table, BenchError> {
    (plan.progress)("paper: Table 1, roulette");
    let setup = SceneSetup::new(&PaperScene::TWO.scene(plan.size, 1)?)?;
    let programs = [Program::Paper(Threading::Critical), Program::Spherule];
    let entries: Vec<Entry> = PROBABILITIES
        .iter()
        .flat_map(|&p| {
            let settings = Settings { roulette: Roulette::Fixed(p), ..setup.settings.clone() };
            programs.map(|program| Entry { settings: settings.clone(), ..setup.entry(program, 1) })
        })
        .collect();
    let times = time_entries(plan.options.rounds, &entries)?;
    let mut columns = vec![
        Column::new("p", "Probability of surviving a bounce; 1 is no roulette.")
            .style(Style::Fixed(1)),
        time("paper", "The paper's tracer, with its tree, on one thread."),
        ratio("gain of paper", "Speedup over no roulette."),
        time("Spherule", "Spherule on one thread."),
        ratio("gain of Spherule", "Speedup over no roulette."),
        ratio("paper : Spherule", "Time of the paper's tracer divided by Spherule's."),
    ];
    columns.extend(Agreement::columns());
    let title = "Table 1. Russian roulette: two mirror spheres, one ray per pixel, one thread";
    let mut table = Table::new("paper-roulette", title, columns);
    for (row, &p) in PROBABILITIES.iter().enumerate() {
        let (paper, ours) = (2 * row, 2 * row + 1);
        let agreement = setup.agreement(programs[0], &entries[paper].settings)?;
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
        "Roulette saves time but adds noise; see `spherule bench roulette` for the efficiency."
            .to_owned(),
    );
    Ok(table)
}
