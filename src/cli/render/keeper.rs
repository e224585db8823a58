//! Checkpoints of a render that goes on.

use super::job::Job;
use super::prepare::Prepared;
use crate::cli::command::{Given, TypedOptions, render_command};
use crate::cli::keep::KeepArgs;
use crate::cli::{Failure, output};
use spherule::atomic::{check_destination, remove_leftovers};
use spherule::checkpoint::{self, Caption, Lock, Origin};
use spherule::render::Unfinished;
use std::ffi::OsString;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Keeps a render in a file, which no other process writes meanwhile.
pub(super) struct Keeper {
    path: PathBuf,
    _lock: Option<Lock>,
    folder: OsString,
    typed: TypedOptions,
    /// When the next checkpoint is due, whichever picture of a sequence that is in.
    due: Mutex<Option<Instant>>,
    /// Why it could not be written last time, which is told once.
    failure: Mutex<Option<String>>,
}

impl Keeper {
    /// Finds out whether a render can be kept, if it is to be, before anything is read.
    pub(super) fn new(keep: &KeepArgs) -> Result<Option<Self>, Failure> {
        let Some(path) = keep.file().cloned() else { return Ok(None) };
        check(&path).map_err(|error| Failure::Write(path.clone(), error))?;
        let lock = Lock::take(&path)?;
        if lock.is_none() {
            output::warn(format_args!(
                "{}: its file system has no locks: let no other process write it",
                path.display()
            ));
        }
        if path.is_file() && !keep.resumes_into_itself() {
            return Err(Failure::Kept(path));
        }
        // They cost some space, no more.
        let _ = remove_leftovers(&path);
        let (folder, typed) = (OsString::new(), TypedOptions::default());
        let (due, failure) = (Mutex::default(), Mutex::default());
        Ok(Some(Self { path, _lock: lock, folder, typed, due, failure }))
    }

    /// The same with the command that is kept, and where the picture goes.
    pub(super) fn with(self, given: Given, output: &Path) -> Self {
        Self { folder: given.folder.into(), typed: given.typed.lasting(output), ..self }
    }

    /// When the next checkpoint is due; `None` for none but at the end.
    pub(super) fn due(&self, keep: &KeepArgs) -> Option<Instant> {
        let mut due = self.due.lock().ok()?;
        if due.is_none() {
            *due = keep.pause(Duration::ZERO).map(|pause| Instant::now() + pause);
        }
        *due
    }

    /// The same after one that took so long, if it could be written.
    fn delay(&self, keep: &KeepArgs, took: Option<Duration>) {
        if let Ok(mut due) = self.due.lock() {
            *due = keep.pause(took.unwrap_or_default()).map(|pause| Instant::now() + pause);
        }
    }

    /// Writes a checkpoint, or says why it could not be: the render goes on. Returns whether it was
    /// written.
    pub(super) fn keep(
        &self,
        job: &Job,
        prepared: &Prepared,
        caption: &Caption,
        render: &Unfinished,
    ) -> bool {
        let start = Instant::now();
        let written = self.write(job, prepared, caption, render);
        self.tell(written.as_ref().err());
        self.delay(job.keep, written.is_ok().then(|| start.elapsed()));
        written.is_ok()
    }

    /// Tells why there is no new checkpoint, unless it is why there was none before.
    fn tell(&self, error: Option<&io::Error>) {
        let now = error.map(ToString::to_string);
        let Ok(mut before) = self.failure.lock() else { return };
        if let Some(why) = now.as_ref().filter(|_| *before != now) {
            let left = if self.path.is_file() { "the last one is kept" } else { "there is none" };
            let path = self.path.display();
            output::warn(format_args!(
                "{path}: no checkpoint can be written, {left}: {why}; the render goes on"
            ));
        }
        *before = now;
    }

    /// Writes a checkpoint.
    pub(super) fn write(
        &self,
        job: &Job,
        prepared: &Prepared,
        caption: &Caption,
        render: &Unfinished,
    ) -> io::Result<()> {
        let folder = self.folder.clone();
        let mut typed = self.typed.clone();
        if let Some(place) = job.place {
            typed.set("first_picture", place.index.to_string());
        }
        let arguments = typed.arguments(&render_command());
        let missing = || io::Error::other("the scene was not identified");
        let scene = prepared.identity.clone().ok_or_else(missing)?;
        let origin = Origin { scene, folder, arguments, caption: caption.clone() };
        checkpoint::write(&self.path, &origin, render)
    }

    /// Where checkpoints go.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// How the render is gone on with.
    pub(super) fn advice(&self) -> String {
        format!("go on with: spherule render --resume {}", self.path.display())
    }
}

/// Whether a file can be there, or a new one be made.
fn check(path: &Path) -> io::Result<()> {
    check_destination(path)?;
    if path.exists() && !path.is_file() {
        let message = "it is a device or a pipe; name a file";
        return Err(io::Error::new(ErrorKind::InvalidInput, message));
    }
    Ok(())
}
