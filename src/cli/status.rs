//! `spherule status`: progress of parts and checkpoints.

use super::output;
use super::ranges::ranges;
use indicatif::HumanDuration;
use serde::Serialize;
use spherule_render::checkpoint::{CheckpointError, Origin, inspect, is_locked};
use spherule_render::render::{ImagePart, Status};
use spherule_render::split::uncovered_parts;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Exit code if something is not rendered yet.
const INCOMPLETE: u8 = 3;

/// Exit codes and examples at the end of `--help`.
pub(super) const EXAMPLES: &str = "\
Exit codes: 0 complete and ready to merge, 1 a file cannot be used, 2 invalid command line, 3 incomplete

Examples:
  spherule status picture.*.part
  until spherule status picture.*.part; do sleep 60; done
  spherule status long.checkpoint --json";

/// Arguments of `spherule status`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Files that `spherule render --part` or --checkpoint write, in any order
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print one JSON object to standard output
    #[arg(long)]
    json: bool,
}

/// State of one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum State {
    /// All samples are taken.
    Complete,
    /// Another process is rendering it.
    Rendering,
    /// Some samples are taken, and no process is rendering it.
    Interrupted,
    /// There is no such file.
    Missing,
    /// The file cannot be used with the others; `problem` is the reason.
    Unusable,
}

/// Report on one file.
#[derive(Debug, Serialize)]
struct FileReport {
    file: String,
    state: State,
    /// Samples of all pixels: taken so far, and wanted in total.
    samples: u64,
    wanted: u64,
    /// The samples and tiles of the part.
    share: Option<String>,
    render_seconds: f64,
    /// Reason why the file cannot be used.
    problem: Option<String>,
    #[serde(skip)]
    status: Option<Status>,
}

/// Report on all files.
#[derive(Debug, Serialize)]
struct Report {
    complete: bool,
    /// Samples of all pixels of the whole image: taken so far, and wanted in total.
    samples: u64,
    wanted: u64,
    /// Samples and tiles that belong to no file.
    missing: Vec<String>,
    /// Parts without a file, by the names of the others.
    missing_parts: Vec<u64>,
    /// Estimated remaining render time, summed over parts; null if unknown.
    remaining_seconds: Option<f64>,
    /// Estimated remaining render time of the file that needs most.
    longest_remaining_seconds: Option<f64>,
    files: Vec<FileReport>,
}

/// Reads the files and prints their progress.
pub(super) fn run(args: &Args) -> ExitCode {
    let mut files = args.files.clone();
    files.extend(started_parts(&args.files));
    let report = Report::of(&files);
    if args.json {
        output::print_json(&report);
    } else {
        report.print();
    }
    let unusable = report.files.iter().any(|file| file.state == State::Unusable);
    match (unusable, report.complete) {
        (true, _) => ExitCode::FAILURE,
        (false, true) => ExitCode::SUCCESS,
        (false, false) => ExitCode::from(INCOMPLETE),
    }
}

impl Report {
    fn of(paths: &[PathBuf]) -> Self {
        let mut first: Option<(String, Origin, Status)> = None;
        let mut files: Vec<FileReport> = Vec::new();
        for path in paths {
            let (mut file, origin) = FileReport::of(path);
            if let (Some(origin), Some(status)) = (origin, file.status.clone()) {
                let problem = match &first {
                    Some(first) => mismatch(first, &origin, &status),
                    None => None,
                };
                let problem = problem.or_else(|| overlap(&files, &status));
                if let Some(problem) = problem {
                    file = file.unusable(problem);
                } else {
                    first.get_or_insert((file.file.clone(), origin, status));
                }
            }
            files.push(file);
        }
        let whole = first.map(|(_, _, status)| status);
        Self::sum(files, whole.as_ref(), paths)
    }

    fn sum(files: Vec<FileReport>, whole: Option<&Status>, paths: &[PathBuf]) -> Self {
        let usable: Vec<&Status> = files.iter().filter_map(|file| file.status.as_ref()).collect();
        let samples = usable.iter().map(|status| status.samples).sum();
        let shares: Vec<ImagePart> = usable.iter().map(|status| status.part.clone()).collect();
        let missing = whole.map_or_else(Vec::new, |status| {
            uncovered_parts(&ImagePart::whole(status.region, status.settings.spp), &shares)
        });
        let wanted = whole.map_or(0, |status| {
            let pixels = u64::from(status.region.width) * u64::from(status.region.height);
            pixels.saturating_mul(status.settings.spp.into())
        });
        let done = |file: &FileReport| file.state == State::Complete;
        let complete = whole.is_some() && files.iter().all(done) && missing.is_empty();
        // A target may end a render before it has taken the maximum number of samples.
        let targeted = whole.is_some_and(|status| status.settings.has_target());
        let remaining = Remaining::of(&usable, if targeted { 0 } else { wanted });
        Self {
            complete,
            samples,
            wanted: if targeted && complete { samples } else { wanted },
            missing: missing.iter().map(ImagePart::to_string).collect(),
            missing_parts: missing_parts(paths),
            remaining_seconds: remaining.as_ref().map(|remaining| remaining.all.as_secs_f64()),
            longest_remaining_seconds: remaining.map(|remaining| remaining.longest.as_secs_f64()),
            files,
        }
    }

    fn print(&self) {
        let width = self.files.iter().map(|file| file.file.chars().count()).max().unwrap_or(0);
        self.files.iter().for_each(|file| file.print(width));
        if !self.missing_parts.is_empty() {
            let missing = ranges(&self.missing_parts, usize::MAX);
            output::print(format_args!("no file for parts {missing}"));
        }
        for missing in &self.missing {
            output::print(format_args!("no file has {missing}"));
        }
        if self.wanted == 0 {
            return;
        }
        let percent = 100.0 * self.samples as f64 / self.wanted as f64;
        let left = match (self.remaining_seconds, self.longest_remaining_seconds) {
            _ if self.complete => "complete".to_owned(),
            (Some(all), Some(longest)) => format!(
                "about {:#} of render time left, at most {:#} for one file",
                HumanDuration(seconds(all)),
                HumanDuration(seconds(longest))
            ),
            _ => "time left unknown".to_owned(),
        };
        output::print(format_args!("{percent:.1} % of all samples; {left}"));
    }
}

impl FileReport {
    fn of(path: &Path) -> (Self, Option<Origin>) {
        let file = path.display().to_string();
        let blank = Self {
            file,
            state: State::Missing,
            samples: 0,
            wanted: 0,
            share: None,
            render_seconds: 0.0,
            problem: None,
            status: None,
        };
        let rendering = is_locked(path);
        if !path.exists() {
            let state = if rendering { State::Rendering } else { State::Missing };
            return (Self { state, ..blank }, None);
        }
        let (origin, status) = match inspect(path) {
            Ok(read) => read,
            // The file was removed in the meantime.
            Err(CheckpointError::Read(..)) if !path.exists() => return (blank, None),
            Err(error) => {
                let message = error.to_string();
                let problem = message.strip_prefix(&format!("{}: ", path.display()));
                let problem = problem.unwrap_or(&message).to_owned();
                return (blank.unusable(problem), None);
            }
        };
        let state = match (status.complete, rendering) {
            (true, _) => State::Complete,
            (false, true) => State::Rendering,
            (false, false) => State::Interrupted,
        };
        let report = Self {
            state,
            samples: status.samples,
            wanted: status.wanted,
            share: Some(status.part.to_string()),
            render_seconds: status.elapsed.as_secs_f64(),
            status: Some(status),
            ..blank
        };
        (report, Some(origin))
    }

    /// Marks the file as unusable.
    fn unusable(self, problem: String) -> Self {
        Self { state: State::Unusable, problem: Some(problem), status: None, ..self }
    }

    fn print(&self, width: usize) {
        let state = match self.state {
            State::Complete => "complete",
            State::Rendering => "rendering",
            State::Interrupted => "interrupted",
            State::Missing => "missing",
            State::Unusable => "unusable",
        };
        let details = match (&self.problem, &self.share) {
            (Some(problem), _) => problem.clone(),
            (None, Some(share)) => {
                let percent = 100.0 * self.samples as f64 / self.wanted.max(1) as f64;
                let time = HumanDuration(seconds(self.render_seconds));
                format!("{percent:5.1} %  {share}, in {time:#}")
            }
            (None, None) if self.state == State::Rendering => "no checkpoint yet".to_owned(),
            (None, None) if self.file.contains(['*', '?']) => "no file matches".to_owned(),
            (None, None) => "no such file".to_owned(),
        };
        output::print(format_args!("{:width$}  {state:<11}  {details}", self.file));
    }
}

/// Estimated remaining time, from the time that the files took.
struct Remaining {
    all: Duration,
    /// Time of the file that needs most.
    longest: Duration,
}

impl Remaining {
    /// Estimates the time for `wanted` samples in total; `None` if nothing is known.
    fn of(files: &[&Status], wanted: u64) -> Option<Self> {
        let samples: u64 = files.iter().map(|status| status.samples).sum();
        let elapsed: f64 = files.iter().map(|status| status.elapsed.as_secs_f64()).sum();
        if samples == 0 || wanted == 0 {
            return None;
        }
        let each = elapsed / samples as f64;
        let left = |status: &&Status| status.wanted.saturating_sub(status.samples);
        let most = files.iter().map(left).max().unwrap_or(0);
        let given: u64 = files.iter().map(|status| status.wanted).sum();
        // A missing part is assumed to be as large as the largest existing one.
        let largest = files.iter().map(|status| status.wanted).max().unwrap_or(0);
        let missing = wanted.saturating_sub(given).min(largest);
        let time = |samples: u64| seconds(samples as f64 * each);
        Some(Self { all: time(wanted.saturating_sub(samples)), longest: time(most.max(missing)) })
    }
}

fn seconds(seconds: f64) -> Duration {
    Duration::try_from_secs_f64(seconds).unwrap_or_default()
}

/// Returns the reason why a file belongs to another image than the first file.
fn mismatch(first: &(String, Origin, Status), origin: &Origin, status: &Status) -> Option<String> {
    let (name, first_origin, first_status) = first;
    if let Some(what) = first_origin.scene.difference(&origin.scene) {
        return Some(format!("belongs to another scene than {name}, with different {what}"));
    }
    if first_origin.caption.layers != origin.caption.layers {
        return Some(format!("has different layers than {name}"));
    }
    let (what, theirs, ours) = status.difference(first_status)?;
    Some(format!("belongs to another render than {name}: {what} is {theirs} instead of {ours}"))
}

/// Returns the reason why a file cannot be merged with those before it.
fn overlap(files: &[FileReport], status: &Status) -> Option<String> {
    files.iter().find_map(|file| {
        let common = file.status.as_ref()?.part.common(&status.part)?;
        Some(format!("overlaps {}: both have {common}", file.file))
    })
}

/// Returns the numbers of missing parts, if all names end in `K-of-N.part` with the same N.
fn missing_parts(paths: &[PathBuf]) -> Vec<u64> {
    let Some(numbers) = paths.iter().map(|path| number(path)).collect::<Option<Vec<_>>>() else {
        return Vec::new();
    };
    let counts: BTreeSet<u32> = numbers.iter().map(|number| number.1).collect();
    let there: BTreeSet<u32> = numbers.iter().map(|number| number.0).collect();
    match counts.iter().collect::<Vec<_>>()[..] {
        // Names may contain any number.
        [&count] if count <= 1 << 20 => {
            (1..=count).filter(|k| !there.contains(k)).map(u64::from).collect()
        }
        _ => Vec::new(),
    }
}

/// Returns the files of parts that another process is rendering and has not written yet.
fn started_parts(paths: &[PathBuf]) -> Vec<PathBuf> {
    let part = |path: &Path| {
        let name = path.file_name()?.to_str()?.strip_suffix(".part")?;
        Some((name.rsplit_once('.')?.0.to_owned(), number(path)?.1))
    };
    let Some((path, (stem, count))) = paths.first().and_then(|path| Some((path, part(path)?)))
    else {
        return Vec::new();
    };
    let digits = count.to_string().len();
    let file = |k: u64| path.with_file_name(format!("{stem}.{k:0digits$}-of-{count}.part"));
    missing_parts(paths).into_iter().map(file).filter(|path| is_locked(path)).collect()
}

/// Parses K and N of a name that ends in `K-of-N.part`.
fn number(path: &Path) -> Option<(u32, u32)> {
    let name = path.file_name()?.to_str()?.strip_suffix(".part")?;
    let (_, part) = name.rsplit_once('.')?;
    let (number, count) = part.split_once("-of-")?;
    Some((number.parse().ok()?, count.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_parts_follow_from_file_names() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let some = paths(&["b/a.1-of-6.part", "b/a.4-of-6.part"]);
        assert_eq!(missing_parts(&some), [2, 3, 5, 6]);
        let others: [&[&str]; 4] = [
            &["a.1-of-6.part", "a.1-of-7.part"],
            &["a.checkpoint"],
            &["a.1-of-4294967295.part"],
            &["a.1-of-1.part"],
        ];
        for names in others {
            assert_eq!(missing_parts(&paths(names)), [0; 0], "{names:?}");
        }
    }
}
