//! Where reports go.

use crate::cli::Failure;
use spherule::atomic::{check_destination, write_atomically};
use spherule::report::draw::{png, svg};
use spherule::report::{Machine, Report, html};
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// A folder that takes files.
pub(super) struct Folder(PathBuf);

impl fmt::Display for Folder {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.display().fmt(formatter)
    }
}

impl Folder {
    /// Finds out whether files can be written there, and changes nothing: before much time is
    /// spent on what goes in them.
    pub(super) fn new(path: &Path) -> Result<Self, Failure> {
        let probe = if path.is_dir() { path.join("report.json") } else { path.to_owned() };
        let is_file =
            || path.is_file().then(|| std::io::Error::other("it is a file; name a folder"));
        match check_destination(&probe).err().or_else(is_file) {
            Some(error) => Err(Failure::Write(path.to_owned(), error)),
            None => Ok(Self(path.to_owned())),
        }
    }

    /// Writes all that reports hold, and the page.
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
                self.file(&plot.name, "svg", svg(plot)?.as_bytes())?;
                self.file(&plot.name, "png", &png(plot)?)?;
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
