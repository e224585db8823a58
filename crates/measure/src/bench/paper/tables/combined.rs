//! All optimizations combined: the paper's 5.5 hours, and the time that remains.

use super::super::comparison::{Agreement, Entry, Program, SceneSetup, time_entries};
use super::super::scenes::{FULL, PaperScene};
use super::{Plan, ratio, time};
use crate::bench::BenchError;
use crate::report::{Cell, Column, Style, Table};
use spherule_paper::Threading;
use spherule_render::scene::{Roulette, Settings};

/// Bounds of the growth with four times as many pixels within which times are extrapolated.
const LINEAR: [f64; 2] = [0.8 * 4.0, 1.25 * 4.0];

/// A program with one more optimization than the last.
struct Step {
    name: &'static str,
    program: Program,
    /// Probability of surviving a bounce.
    p: f64,
    /// True if all threads render.
    parallel: bool,
}

impl Step {
    const fn new(name: &'static str, program: Program, p: f64, parallel: bool) -> Self {
        Self { name, program, p, parallel }
    }
}

/// The optimizations, one after another.
const STEPS: [Step; 6] = [
    Step::new("plain", Program::Brute(Threading::Critical), 1.0, false),
    Step::new("with roulette", Program::Brute(Threading::Critical), 0.9, false),
    Step::new("with threads", Program::Brute(Threading::Critical), 0.9, true),
    Step::new("with the tree", Program::Paper(Threading::Critical), 0.9, true),
    Step::new("without critical sections", Program::Paper(Threading::Independent), 0.9, true),
    Step::new("Spherule", Program::Spherule, 0.9, true),
];

/// Measures all optimizations on the random field of 20 x 20 spheres.
pub(crate) fn combined(plan: &Plan) -> Result<Table, BenchError> {
    (plan.progress)("paper: Table 4, all changes combined");
    let threads = plan.options.threads;
    let field = |size| SceneSetup::new(&PaperScene::FIELD.scene(size, plan.spp)?);
    let (setup, quarter) = (field(plan.size)?, field(plan.size.div_ceil(2))?);
    let entries = [&setup, &quarter].map(|setup| STEPS.map(|step| entry(setup, &step, threads)));
    let times = time_entries(plan.options.rounds, entries.as_flattened())?;
    let title = "Table 4. All optimizations combined: the random field of 20 x 20 spheres";
    let mut table = Table::new("paper-together", title, columns());
    let samples = |size: u32, spp: u32| f64::from(size).powi(2) * f64::from(spp);
    let measured = samples(plan.size, plan.spp);
    let factor = samples(FULL.0, FULL.1) / measured;
    // Not quite four for odd sizes.
    let pixels = measured / samples(plan.size.div_ceil(2), plan.spp);
    for (row, Step { name, program, p, .. }) in STEPS.into_iter().enumerate() {
        let growth = times.ratio(STEPS.len() + row, row).median * 4.0 / pixels;
        let is_linear = factor == 1.0 || (LINEAR[0]..=LINEAR[1]).contains(&growth);
        let full = is_linear.then(|| times.seconds(row).times(factor));
        // Spherule is the reference.
        let agreement = match program {
            Program::Spherule => None,
            other => Some(setup.agreement(other, &entries[0][row].settings)?),
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
    table.notes = notes(plan, factor);
    Ok(table)
}

fn entry<'a>(setup: &'a SceneSetup, step: &Step, threads: usize) -> Entry<'a> {
    let settings = Settings { roulette: Roulette::Fixed(step.p), ..setup.settings.clone() };
    Entry { settings, ..setup.entry(step.program, if step.parallel { threads } else { 1 }) }
}

fn columns() -> Vec<Column> {
    let mut columns = vec![
        Column::new(
            "program",
            "The paper's tracer with one more optimization in each row, then Spherule.",
        ),
        Column::new("threads", "Number of threads."),
        Column::new("p", "Probability of surviving a bounce.").style(Style::Fixed(1)),
        time("time", "Measured time, at the scale of this run."),
        ratio("gain", "Speedup over the plain tracer."),
        ratio("growth", "Time relative to that of a quarter of the pixels: 4 if time is linear."),
        time(
            "at the paper's scale",
            "Time with the paper's number of pixels and samples: measured, or extrapolated from the \
             number of samples where growth is linear.",
        ),
    ];
    columns.extend(Agreement::columns());
    columns
}

fn notes(plan: &Plan, factor: f64) -> Vec<String> {
    let (Plan { size, spp, .. }, (full, full_spp)) = (plan, FULL);
    let scale = if factor == 1.0 {
        format!(
            "{full} x {full} pixels with {full_spp} samples, as in the paper; nothing is extrapolated."
        )
    } else {
        format!(
            "Measured with {size} x {size} pixels and {spp} samples per pixel. The paper has {full} x \
             {full} pixels and {full_spp} samples per pixel, {factor:.0} times as many in total. \"-\" \
             where growth is not between {:.1} and {:.1}.",
            LINEAR[0], LINEAR[1]
        )
    };
    let paper =
        "The paper reports 5.5 hours reduced to 2, on a laptop with four threads.".to_owned();
    vec![scale, paper]
}
