//! `spherule stress`: compares intersection tests with exact arithmetic.

mod args;
mod plot;
mod table;

pub(super) use self::args::{Args, EXAMPLES};
use super::failure::Failure;
use super::files::Files;
use super::progress::{Meter, rate};
use super::write_file::check_destination;
use super::{output, threads};
use indicatif::HumanCount;
use serde::Serialize;
use spherule_measure::report::draw::draw;
use spherule_measure::stress::{self, Form, Options, REGIMES, Regime, Report};
use spherule_render::atomic::write_atomically;
use spherule_render::graphics::Format;
use spherule_render::render::Progress;
use std::io;
use std::path::Path;
use std::process::ExitCode;
use std::ptr;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// JSON output.
#[derive(Serialize)]
struct Summary<'a> {
    /// Wrong results of this program, of all kinds.
    wrong: u64,
    surface_rays: u64,
    #[serde(flatten)]
    report: &'a Report,
}

/// Runs the tests, prints the report, and fails if this program was wrong anywhere.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let format = args.plot.as_deref().map(plot_format).transpose()?;
    let mut files = Files::new("stress");
    args.csv.iter().for_each(|path| files.writes("--csv", path));
    args.plot.iter().for_each(|path| files.writes("--plot", path));
    files.check()?;
    for path in args.csv.iter().chain(&args.plot) {
        check_destination(path)?;
    }
    let report = measure(args)?;
    if let Some(path) = &args.csv {
        write(path, |writer| report.write_csv(writer).map_err(io::Error::from))?;
    }
    if let (Some(path), Some(format)) = (&args.plot, format) {
        let picture = draw(&plot::plot(&report), format)?;
        write(path, |writer| writer.write_all(&picture))?;
    }
    let wrong = report.all_wrong();
    if args.json {
        let surface_rays = report.surface_rays();
        output::print_json(&Summary { wrong, surface_rays, report: &report });
    } else {
        if !args.quiet {
            output::print(table::text(&report));
        }
        output::print(conclusion(&report));
    }
    Ok(if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn plot_format(path: &Path) -> Result<Format, Failure> {
    Format::of_suffix(path).filter(|format| *format != Format::Pdf).ok_or_else(|| {
        let name = path.display();
        let message = format!("--plot {name}: use a name that ends in .png or .svg");
        Failure::usage("stress", message)
    })
}

fn measure(args: &Args) -> Result<Report, Failure> {
    let options = Options { rays: args.rays, seed: args.seed, regimes: regimes(&args.regime) };
    let meter = Meter::new(args.quiet);
    let (start, traced) = (Instant::now(), AtomicU64::new(0));
    let show = |more: u64| {
        let rays = traced.fetch_add(more, Ordering::Relaxed) + more;
        let done = rays as f64 / options.rays as f64;
        meter.show(Progress { done, rays, elapsed: start.elapsed(), noise: None });
    };
    let pool = threads::pool(threads::count(args.threads))?;
    let report = pool.install(|| stress::run(&options, &show));
    meter.finish();
    if !args.quiet {
        let (elapsed, rays) = (start.elapsed(), HumanCount(report.rays));
        let (seconds, rate) = (elapsed.as_secs_f64(), rate(report.rays, elapsed));
        output::note(format_args!("{rays} rays in {seconds:.1} s, {rate}"));
    }
    Ok(report)
}

/// Returns the chosen regimes in the default order, or all if none is chosen.
fn regimes(chosen: &[&'static Regime]) -> Vec<&'static Regime> {
    let is_chosen = |regime: &&Regime| chosen.iter().any(|other| ptr::eq(*other, *regime));
    REGIMES.iter().filter(|regime| chosen.is_empty() || is_chosen(regime)).collect()
}

fn write(
    path: &Path,
    fill: impl FnOnce(&mut dyn io::Write) -> io::Result<()>,
) -> Result<(), Failure> {
    write_atomically(path, fill).map_err(|error| Failure::Write(path.to_owned(), error))
}

/// Returns the last line of the report.
fn conclusion(report: &Report) -> String {
    let wrong = report.all_wrong();
    let rays = report.rays + report.surface_rays() + report.body_rays();
    let [wrong, rays, bounds] = [wrong, rays, report.bounds()].map(HumanCount);
    let counted = format!("{wrong} wrong results in {rays} rays and {bounds} bounds");
    let at_fault = report.regimes.iter().filter(|regime| regime.form(Form::Spherule).wrong() > 0);
    let bodies = report.bodies.iter().filter(|body| body.wrong() > 0).map(|body| body.name);
    let names: Vec<_> = at_fault.map(|regime| regime.name).chain(bodies).collect();
    if names.is_empty() { counted } else { format!("{counted}, in {}", names.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regimes_keep_their_order() {
        assert_eq!(regimes(&[]).len(), REGIMES.len());
        let chosen = [&REGIMES[5], &REGIMES[2], &REGIMES[5]];
        let names: Vec<_> = regimes(&chosen).iter().map(|regime| regime.name).collect();
        assert_eq!(names, [REGIMES[2].name, REGIMES[5].name]);
    }

    #[test]
    fn the_verdict_names_failing_regimes() {
        let regimes = REGIMES[..2].iter().collect();
        let mut report = stress::run(&Options { rays: 64, seed: 0, regimes }, &|_| ());
        assert_eq!(conclusion(&report), "0 wrong results in 80 rays and 36 bounds");
        report.regimes[1].forms[Form::Spherule as usize].wrong_spheres = 1234;
        assert_eq!(conclusion(&report), "1,234 wrong results in 80 rays and 36 bounds, in inside");
    }
}
