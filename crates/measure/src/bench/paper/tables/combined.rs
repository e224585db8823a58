//! All optimizations combined: the paper's 5.5 hours, and the time that remains.

use super::super::comparison::{Agreement, Entry, Program, SceneSetup, time_entries};
use super::super::scenes::{FULL, PaperScene};
use super::{Plan, ratio, time};
use crate::bench::BenchError;
use crate::paper::Threading;
use crate::report::{Cell, Column, Style, Table};
use spherule_render::scene::{Roulette, Settings};

/// Bounds of the growth with four times as many pixels within which times are extrapolated.
const LINEAR: [f64; 2] = [0.8 * 4.0, 1.25 * 4.0];

/// A name, a program, the probability of surviving a bounce, and whether all threads render.
type Step = (&'static str, Program, f64, bool);

/// The optimizations, one after another.
const STEPS: [Step; 6] = [
    ("plain", Program::Brute(Threading::Critical), 1.0, false),
    ("with roulette", Program::Brute(Threading::Critical), 0.9, false),
    ("with threads", Program::Brute(Threading::Critical), 0.9, true),
    ("with the tree", Program::Paper(Threading::Critical), 0.9, true),
    ("without critical sections", Program::Paper(Threading::Independent), 0.9, true),
    ("Spherule", Program::Spherule, 0.9, true),
];

/// Measures all optimizations on the random field of 20 x 20 spheres.
pub(crate) fn combined(plan: &Plan) -> Result<Table, BenchError> {
    (plan.progress)("paper: Table 4, all changes combined");
    let threads = plan.options.threads;
    let field = |size| SceneSetup::new(&PaperScene::FIELD.scene((size, plan.spp))?);
    let (setup, quarter) = (field(plan.size)?, field(plan.size.div_ceil(2))?);
    let entries = [&setup, &quarter].map(|setup| STEPS.map(|step| entry(setup, step, threads)));
    let times = time_entries(plan.options.rounds, entries.as_flattened())?;
    let title = "Table 4. All optimizations combined: the random field of 20 x 20 spheres";
    let mut table = Table::new("paper-together", title, columns());
    let samples = |(size, spp): (u32, u32)| f64::from(size).powi(2) * f64::from(spp);
    let factor = samples(FULL) / samples(plan.scale());
    // Not quite four for odd sizes.
    let pixels = samples(plan.scale()) / samples((plan.size.div_ceil(2), plan.spp));
    for (row, (name, program, p, _)) in STEPS.into_iter().enumerate() {
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
    table.notes = notes(plan.scale(), factor);
    Ok(table)
}

fn entry(setup: &SceneSetup, (_, program, p, parallel): Step, threads: usize) -> Entry<'_> {
    let settings = Settings { roulette: Roulette::Fixed(p), ..setup.settings.clone() };
    Entry { settings, ..setup.entry(program, if parallel { threads } else { 1 }) }
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

fn notes((size, spp): (u32, u32), factor: f64) -> Vec<String> {
    let (full, full_spp) = FULL;
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
