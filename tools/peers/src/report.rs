//! Tables in Markdown.

use crate::builds::Builds;
use crate::contest::{Entry, Outcome};
use crate::options::Options;
use crate::rays::Class;
use clap::ValueEnum;
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
        "\n| scene, rays | count | hit | Embree, Mrays/s | its call | Spherule, Mrays/s | ratio |"
    )?;
    writeln!(out, "|---|--:|--:|--:|---|--:|--:|")?;
    for outcome in outcomes {
        writeln!(
            out,
            "| {}, {} | {} | {:.0} % | {:.2} | {} | {:.2} | {:.2} |",
            outcome.scene,
            name(&outcome.class),
            outcome.rays,
            outcome.hits * 100.0,
            outcome.embree,
            call(options, outcome.fastest),
            outcome.spherule,
            outcome.spherule / outcome.embree
        )?;
    }
    Ok(())
}

fn means(out: &mut impl Write, outcomes: &[Outcome]) -> io::Result<()> {
    writeln!(out, "\n| geometric means | Embree, Mrays/s | Spherule, Mrays/s | ratio |")?;
    writeln!(out, "|---|--:|--:|--:|")?;
    let mut row = |name: String, of: Vec<&Outcome>| {
        if of.is_empty() {
            return Ok(());
        }
        let embree = geometric_mean(of.iter().map(|outcome| outcome.embree));
        let spherule = geometric_mean(of.iter().map(|outcome| outcome.spherule));
        writeln!(out, "| {name} | {embree:.2} | {spherule:.2} | {:.2} |", spherule / embree)
    };
    for &class in Class::value_variants() {
        row(name(&class), outcomes.iter().filter(|outcome| outcome.class == class).collect())?;
    }
    row("all".to_owned(), outcomes.iter().collect())
}

/// Rates of programs for other processor levels, and their ratios to Embree's.
fn levels(out: &mut impl Write, outcomes: &[Outcome]) -> io::Result<()> {
    writeln!(out, "\n| scene, rays | level | Spherule, Mrays/s | ratio |")?;
    writeln!(out, "|---|---|--:|--:|")?;
    for outcome in outcomes {
        for (level, rate) in &outcome.levels {
            let (scene, class, ratio) =
                (outcome.scene, name(&outcome.class), rate / outcome.embree);
            writeln!(out, "| {scene}, {class} | {level} | {rate:.2} | {ratio:.2} |")?;
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
        let mut row = |name: &str, of: Vec<&Outcome>| {
            if of.is_empty() {
                return Ok(());
            }
            let mean = geometric_mean(of.into_iter().map(ratio));
            writeln!(out, "| {name} | {level} | {mean:.2} |")
        };
        for &class in Class::value_variants() {
            let of = outcomes.iter().filter(|outcome| outcome.class == class).collect();
            row(&name(&class), of)?;
        }
        row("all", outcomes.iter().collect())?;
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
            "| {}, {} | {} | {} | {} | {} | {} |",
            outcome.scene,
            name(&outcome.class),
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

/// As on the command line.
pub fn name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
