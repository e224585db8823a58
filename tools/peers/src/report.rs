//! Tables in Markdown.

use crate::builds::Builds;
use crate::contest::{Entry, Outcome, SingleCalls};
use crate::options::Options;
use spherule_core::internals::elementary::{exp, ln};
use std::io::{self, Write};

/// Writes the tables.
///
/// # Errors
/// What the writer says.
pub fn write(
    out: &mut impl Write,
    options: &Options,
    outcomes: &[Outcome],
    builds: &[Builds],
) -> io::Result<()> {
    rates(out, options, outcomes)?;
    means(out, outcomes)?;
    if outcomes.iter().any(|outcome| !outcome.levels.is_empty()) {
        levels(out, outcomes)?;
    }
    if !builds.is_empty() {
        costs(out, builds)?;
    }
    differences(out, outcomes)
}

fn rates(out: &mut impl Write, options: &Options, outcomes: &[Outcome]) -> io::Result<()> {
    writeln!(
        out,
        "\n| scene, rays | count | hit | Embree, Mrays/s | its call | Spherule, Mrays/s | ratio | \
         one call, ns | Embree's | ratio |"
    )?;
    writeln!(out, "|---|--:|--:|--:|---|--:|--:|--:|--:|--:|")?;
    for outcome in outcomes {
        let SingleCalls { embree, spherule } = outcome.single;
        writeln!(
            out,
            "| {} | {} | {:.0} % | {:.2} | {} | {:.2} | {:.2} | {spherule:.0} | {embree:.0} | {:.2} |",
            outcome.name(),
            outcome.rays,
            outcome.hits * 100.0,
            outcome.embree,
            call(options, outcome.fastest),
            outcome.spherule,
            outcome.ratio(),
            embree / spherule,
        )?;
    }
    Ok(())
}

/// Geometric means and the least ratio by class and order.
fn means(out: &mut impl Write, outcomes: &[Outcome]) -> io::Result<()> {
    writeln!(
        out,
        "\n| geometric means | Embree, Mrays/s | Spherule, Mrays/s | ratio | least | one call, ratio | least |"
    )?;
    writeln!(out, "|---|--:|--:|--:|--:|--:|--:|")?;
    for (name, of) in groups(outcomes) {
        let embree = geometric_mean(of.iter().map(|outcome| outcome.embree));
        let spherule = geometric_mean(of.iter().map(|outcome| outcome.spherule));
        let single = |outcome: &&Outcome| outcome.single.embree / outcome.single.spherule;
        let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
        writeln!(
            out,
            "| {name} | {embree:.2} | {spherule:.2} | {:.2} | {:.2} | {:.2} | {:.2} |",
            spherule / embree,
            least(&mut of.iter().map(|outcome| outcome.ratio())),
            geometric_mean(of.iter().map(single)),
            least(&mut of.iter().map(single)),
        )?;
    }
    Ok(())
}

/// Outcomes by order and class, in the order of their first, and all.
fn groups(outcomes: &[Outcome]) -> Vec<(String, Vec<&Outcome>)> {
    let mut groups: Vec<(String, Vec<&Outcome>)> = Vec::new();
    for outcome in outcomes {
        let name = format!("{}, {}", outcome.class.name(), outcome.order.name());
        match groups.iter_mut().find(|group| group.0 == name) {
            Some((_, of)) => of.push(outcome),
            None => groups.push((name, vec![outcome])),
        }
    }
    groups.push(("all".to_owned(), outcomes.iter().collect()));
    groups.retain(|(_, of)| !of.is_empty());
    groups
}

impl Outcome {
    /// Scene, class and order.
    fn name(&self) -> String {
        format!("{}, {}, {}", self.scene, self.class.name(), self.order.name())
    }

    fn ratio(&self) -> f64 {
        self.spherule / self.embree
    }
}

/// Rates of programs for other processor levels, and their ratios to Embree's.
fn levels(out: &mut impl Write, outcomes: &[Outcome]) -> io::Result<()> {
    writeln!(out, "\n| scene, rays | level | Spherule, Mrays/s | ratio |")?;
    writeln!(out, "|---|---|--:|--:|")?;
    for outcome in outcomes {
        for (level, rate) in &outcome.levels {
            let (rays, ratio) = (outcome.name(), rate / outcome.embree);
            writeln!(out, "| {rays} | {level} | {rate:.2} | {ratio:.2} |")?;
        }
    }
    let names = outcomes.first().map(|outcome| outcome.levels.iter().map(|level| &level.0));
    writeln!(out, "\n| geometric means of ratios | level | ratio |")?;
    writeln!(out, "|---|---|--:|")?;
    for level in names.into_iter().flatten() {
        let ratio = |outcome: &Outcome| {
            let of = outcome.levels.iter().find(|(name, _)| name == level);
            of.map_or(f64::NAN, |(_, rate)| rate / outcome.embree)
        };
        for (name, of) in groups(outcomes) {
            let mean = geometric_mean(of.into_iter().map(ratio));
            writeln!(out, "| {name} | {level} | {mean:.2} |")?;
        }
    }
    Ok(())
}

fn costs(out: &mut impl Write, builds: &[Builds]) -> io::Result<()> {
    writeln!(
        out,
        "\n| build | system | 1 thread, ms | 2 threads, ms | of Embree's rate | bytes/sphere | at most |"
    )?;
    writeln!(out, "|---|---|--:|--:|--:|--:|--:|")?;
    for build in builds {
        let Builds { embree, spherule, morton, .. } = build;
        let systems = [("Embree", embree), ("Spherule", spherule), ("Spherule, Morton", morton)];
        let scene = format!("{}{}", build.scene, if build.sorted { ", sorted" } else { "" });
        for (system, cost) in systems {
            let [one, two] = cost.seconds.map(|s| s * 1e3);
            let rate = |i: usize| embree.seconds[i] / cost.seconds[i];
            let (rate_one, rate_two) = (rate(0), rate(1));
            let (bytes, peak) = (cost.bytes, cost.peak);
            writeln!(
                out,
                "| {scene} | {system} | {one:.3} | {two:.3} | {rate_one:.2}, {rate_two:.2} | {bytes:.1} | {peak:.1} |"
            )?;
        }
    }
    Ok(())
}

fn differences(out: &mut impl Write, outcomes: &[Outcome]) -> io::Result<()> {
    writeln!(out, "\n| scene, rays | differ | Embree wrong | Spherule wrong | ties | exact |")?;
    writeln!(out, "|---|--:|--:|--:|--:|--:|")?;
    for outcome in outcomes {
        let verdicts = outcome.verdicts;
        writeln!(
            out,
            "| {} | {} | {} | {} | {} | {} |",
            outcome.name(),
            verdicts.differ,
            verdicts.embree_wrong,
            verdicts.spherule_wrong,
            verdicts.ties,
            outcome.exact
        )?;
    }
    Ok(())
}

fn geometric_mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    exp(values.map(ln).sum::<f64>() / count)
}

/// Such as `8 coherent, sorted, simd256`.
fn call(options: &Options, entry: Entry) -> String {
    let flag = if entry.coherent { "coherent" } else { "incoherent" };
    let configuration = options.configuration.get(entry.configuration);
    let value = configuration.and_then(|text| text.rsplit('=').next()).unwrap_or_default();
    format!("{} {flag}{}, {value}", entry.width, if entry.sorted { ", sorted" } else { "" })
}
