//! All changes on top of one another: what the paper's 5.5 hours became, and what they become.

use super::super::contest::{Agreement, Entry, Program, Stage, contest};
use super::super::scenes::{FULL, PaperScene};
use super::{Plan, ratio, time};
use crate::bench::BenchError;
use crate::paper::Threading;
use crate::report::{Cell, Column, Style, Table};
use crate::scene::{Roulette, Settings};

/// Times are extrapolated if four times as many pixels take so many times as long.
const LINEAR: [f64; 2] = [0.8 * 4.0, 1.25 * 4.0];

/// A name, a program, the probability to survive a bounce, and whether all threads render.
type Step = (&'static str, Program, f64, bool);

/// What is changed, one after another.
const STEPS: [Step; 6] = [
    ("plain", Program::Brute(Threading::Critical), 1.0, false),
    ("with roulette", Program::Brute(Threading::Critical), 0.9, false),
    ("with threads", Program::Brute(Threading::Critical), 0.9, true),
    ("with the tree", Program::Paper(Threading::Critical), 0.9, true),
    ("without critical sections", Program::Paper(Threading::Independent), 0.9, true),
    ("Spherule", Program::Spherule, 0.9, true),
];

/// The random field of 20 x 20 spheres.
pub(crate) fn together(plan: &Plan) -> Result<Table, BenchError> {
    (plan.tell)("paper: Table 4, all together");
    let threads = plan.options.threads;
    let field = |size| Stage::new(&PaperScene::FIELD.scene((size, plan.spp))?);
    let (stage, quarter) = (field(plan.size)?, field(plan.size.div_ceil(2))?);
    let entries = [&stage, &quarter].map(|stage| STEPS.map(|step| entry(stage, step, threads)));
    let times = contest(plan.options.rounds, entries.as_flattened())?;
    let title = "Table 4. Everything together: the random field of 20 x 20 spheres";
    let mut table = Table::new("paper-together", title, columns());
    let samples = |(size, spp): (u32, u32)| f64::from(size).powi(2) * f64::from(spp);
    let factor = samples(FULL) / samples(plan.scale());
    // Not quite four for odd sizes.
    let pixels = samples(plan.scale()) / samples((plan.size.div_ceil(2), plan.spp));
    for (row, (name, program, p, _)) in STEPS.into_iter().enumerate() {
        let growth = times.ratio(STEPS.len() + row, row).median * 4.0 / pixels;
        let is_linear = factor == 1.0 || (LINEAR[0]..=LINEAR[1]).contains(&growth);
        let full = is_linear.then(|| times.seconds(row).times(factor));
        // Itself is nothing to compare with.
        let agreement = match program {
            Program::Spherule => None,
            other => Some(stage.agreement(other, &entries[0][row].settings)?),
        };
        let cells = [
            name.into(),
            (entries[0][row].threads as u64).into(),
            p.into(),
            times.seconds(row).into(),
            times.ratio(row, 0).into(),
            growth.into(),
            Cell::from(full),
        ];
        table.push(cells.into_iter().chain(agreement.iter().flat_map(Agreement::cells)));
    }
    table.notes = notes(plan.scale(), factor);
    Ok(table)
}

fn entry(stage: &Stage, (_, program, p, parallel): Step, threads: usize) -> Entry<'_> {
    let settings = Settings { roulette: Roulette::Fixed(p), ..stage.settings.clone() };
    Entry { settings, ..stage.entry(program, if parallel { threads } else { 1 }) }
}

fn columns() -> Vec<Column> {
    let mut columns = vec![
        Column::new("program", "The paper's tracer with one change after another, then Spherule."),
        Column::new("threads", "How many threads render."),
        Column::new("p", "Probability to survive a bounce.").style(Style::Fixed(1)),
        time("time", "As measured, at the scale of this run."),
        ratio("gain", "Times as fast as the plain tracer."),
        ratio("growth", "Times as long as a quarter of the pixels takes: 4 if time is linear."),
        time(
            "at the paper's scale",
            "With as many pixels and samples as in the paper: measured, or extrapolated from the \
             number of samples where growth is linear.",
        ),
    ];
    columns.extend(Agreement::columns());
    columns
}

fn notes((size, spp): (u32, u32), factor: f64) -> Vec<String> {
    let (full, full_spp) = FULL;
    let scale = if factor == 1.0 {
        format!(
            "{full} x {full} pixels of {full_spp} samples, as in the paper: nothing is extrapolated."
        )
    } else {
        format!(
            "Measured are {size} x {size} pixels of {spp} samples; the paper's scale is {full} x \
             {full} of {full_spp}, {factor:.0} times as many samples. \"-\" where growth is not \
             between {:.1} and {:.1}.",
            LINEAR[0], LINEAR[1]
        )
    };
    let paper = "The paper: from 5.5 hours to 2, on a laptop with four threads.".to_owned();
    vec![scale, paper]
}
