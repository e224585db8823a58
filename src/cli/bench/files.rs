//! The output folder of reports.

use crate::cli::failure::Failure;
use spherule_measure::report::draw::draw;
use spherule_measure::report::{Machine, Report, html};
use spherule_render::atomic::{check_destination, write_atomically};
use spherule_render::graphics::Format;
use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Suffixes of the files of a report.
const SUFFIXES: [&str; 4] = ["csv", "json", "svg", "png"];

/// An output folder.
pub(super) struct Folder(PathBuf);

impl fmt::Display for Folder {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.display().fmt(formatter)
    }
}

impl Folder {
    /// Checks that files can be written to a folder, without changing anything, before benchmarks run.
    pub(super) fn new(path: &Path) -> Result<Self, Failure> {
        let probe = if path.is_dir() { path.join("report.json") } else { path.to_owned() };
        let is_file = || path.is_file().then(|| io::Error::other("it is a file; give a folder"));
        match check_destination(&probe).err().or_else(is_file) {
            Some(error) => Err(Failure::Write(path.to_owned(), error)),
            None => Ok(Self(path.to_owned())),
        }
    }

    /// Checks that reports of these names and their page would replace no file that a scene reads, and no
    /// file but those of earlier reports.
    ///
    /// Tables and plots have names that start with the report's, but their full names are known only at the
    /// end. The report's JSON, which is written first, shows that they are from an earlier run.
    pub(super) fn check_free(
        &self,
        inputs: &[PathBuf],
        page: &str,
        reports: &[&str],
    ) -> Result<(), Failure> {
        let page = self.0.join(format!("{page}.html"));
        let input = inputs.iter().find(|input| {
            self.holds(input)
                && (is_same(input, &page) || reports.iter().any(|name| is_of_report(input, name)))
        });
        if let Some(input) = input {
            let (input, folder) = (input.display(), self.0.display());
            let message = format!(
                "{input}, which a scene reads, is in {folder}, where a table or a plot could overwrite it; \
                 use another folder for --output"
            );
            return Err(Failure::usage("bench", message));
        }
        if page.exists() && !is_own(&page, html::is_page) {
            return Err(not_overwritten(page));
        }
        for name in reports {
            let json = self.0.join(format!("{name}.json"));
            if !is_own(&json, Report::is_json) {
                let found = self.files().into_iter().find(|file| is_of_report(file, name));
                found.map_or(Ok(()), |file| Err(not_overwritten(file)))?;
            }
        }
        Ok(())
    }

    /// Returns whether a file is in the folder, after resolving links.
    fn holds(&self, file: &Path) -> bool {
        let folder = self.0.canonicalize().ok();
        let file = file.canonicalize().ok();
        folder.is_some() && file.as_deref().and_then(Path::parent) == folder.as_deref()
    }

    /// Files of the folder, sorted by name.
    fn files(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.0).into_iter().flatten().flatten();
        let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        files.sort();
        files
    }

    /// Writes the reports and the page.
    pub(super) fn write(
        &self,
        page: &str,
        reports: &[Report],
        machine: &Machine,
    ) -> Result<(), Failure> {
        fs::create_dir_all(&self.0).map_err(|error| Failure::Write(self.0.clone(), error))?;
        for report in reports {
            let json = format!("{:#}\n", report.json(machine));
            self.file(&report.name, "json", json.as_bytes())?;
            for table in &report.tables {
                self.file(&table.name, "csv", table.csv().as_bytes())?;
            }
            for plot in &report.plots {
                self.file(&plot.name, "svg", &draw(plot, Format::Svg)?)?;
                self.file(&plot.name, "png", &draw(plot, Format::Png)?)?;
            }
        }
        self.file(page, "html", html::page(machine, reports)?.as_bytes())
    }

    fn file(&self, name: &str, suffix: &str, content: &[u8]) -> Result<(), Failure> {
        let path = self.0.join(format!("{name}.{suffix}"));
        write_atomically(&path, |writer| writer.write_all(content))
            .map_err(|error| Failure::Write(path.clone(), error))
    }
}

/// Returns whether a file has a name that a table, a plot or the JSON of a report of this name may have.
fn is_of_report(file: &Path, report: &str) -> bool {
    let part =
        |part: Option<&OsStr>| part.unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let (stem, suffix) = (part(file.file_stem()), part(file.extension()));
    let rest = stem.strip_prefix(report);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('-'))
        && SUFFIXES.contains(&suffix.as_str())
}

fn is_same(file: &Path, other: &Path) -> bool {
    file.canonicalize().ok().is_some_and(|file| other.canonicalize().is_ok_and(|own| own == file))
}

/// Returns whether an earlier run wrote a file, by its content.
fn is_own(path: &Path, test: impl Fn(&[u8]) -> bool) -> bool {
    path.is_file() && fs::read(path).is_ok_and(|content| test(&content))
}

fn not_overwritten(path: PathBuf) -> Failure {
    let why = "it already exists, and was not written by bench; move it, or use another folder for --output";
    Failure::Write(path, io::Error::other(why))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_of_the_report_whose_name_they_begin_with() {
        let of = |file: &str| is_of_report(Path::new(file), "build");
        assert!(of("a/build.csv") && of("build.json") && of("build-tree.svg") && of("Build.PNG"));
        assert!(!of("builders.csv") && !of("build.txt") && !of("my-build.csv") && !of("build"));
    }
}
