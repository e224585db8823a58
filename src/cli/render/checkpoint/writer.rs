//! Writing of checkpoints.

use super::invocation::Invocation;
use crate::cli::failure::Failure;
use crate::cli::options::checkpoints::CheckpointArgs;
use crate::cli::output;
use crate::cli::render::prepare::Prepared;
use crate::cli::render::setup::RenderSetup;
use spherule_render::atomic::{check_destination, remove_leftovers};
use spherule_render::checkpoint::{self, Caption, Lock, Origin};
use spherule_render::render::ResumableRender;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Writes checkpoints to a file, which is locked against other processes.
pub(in crate::cli) struct CheckpointWriter {
    path: PathBuf,
    _lock: Option<Lock>,
    /// The command that checkpoints store.
    invocation: Invocation,
    /// Time of the next checkpoint, across the images of a sequence.
    due: Mutex<Option<Instant>>,
    /// The last error, so that it is reported once.
    failure: Mutex<Option<String>>,
}

impl CheckpointWriter {
    /// Checks that checkpoints can be written, if they are requested, and locks their file, before anything
    /// is read.
    pub(in crate::cli) fn new(args: &CheckpointArgs) -> Result<Option<Self>, Failure> {
        let Some(path) = args.file().cloned() else { return Ok(None) };
        check(&path).map_err(|error| Failure::Write(path.clone(), error))?;
        let lock = Lock::take(&path)?;
        if lock.is_none() {
            output::warn(format_args!(
                "{}: its file system does not support locks; make sure that no other process writes it",
                path.display()
            ));
        }
        if path.is_file() && !args.resumes_into_itself() {
            return Err(Failure::CheckpointExists(path));
        }
        // They cost some space, no more.
        let _ = remove_leftovers(&path);
        let invocation = Invocation::default();
        let (due, failure) = (Mutex::default(), Mutex::default());
        Ok(Some(Self { path, _lock: lock, invocation, due, failure }))
    }

    /// Sets the command that checkpoints store, with its output file.
    pub(in crate::cli) fn with(self, given: Invocation, output: &Path) -> Self {
        let typed = given.typed.stored(output);
        Self { invocation: Invocation { typed, ..given }, ..self }
    }

    /// Time of the next checkpoint; `None` to write one only on exit.
    pub(in crate::cli) fn due(&self, args: &CheckpointArgs) -> Option<Instant> {
        let mut due = self.due.lock().ok()?;
        if due.is_none() {
            *due = args.pause(Duration::ZERO).map(|pause| Instant::now() + pause);
        }
        *due
    }

    /// Sets the time of the next checkpoint, after the last one took `took`.
    fn reschedule(&self, args: &CheckpointArgs, took: Option<Duration>) {
        if let Ok(mut due) = self.due.lock() {
            *due = args.pause(took.unwrap_or_default()).map(|pause| Instant::now() + pause);
        }
    }

    /// Writes a checkpoint. On an error, prints a warning and continues the render. Returns whether it was
    /// written.
    pub(in crate::cli) fn save(
        &self,
        setup: &RenderSetup,
        prepared: &Prepared,
        caption: &Caption,
        render: &ResumableRender,
    ) -> bool {
        let start = Instant::now();
        let written = self.write(setup, prepared, caption, render);
        self.report(written.as_ref().err());
        self.reschedule(setup.checkpoints, written.is_ok().then(|| start.elapsed()));
        written.is_ok()
    }

    /// Warns of a failure to write a checkpoint, unless the last one failed with the same error.
    fn report(&self, error: Option<&io::Error>) {
        let now = error.map(ToString::to_string);
        let Ok(mut before) = self.failure.lock() else { return };
        if let Some(why) = now.as_ref().filter(|_| *before != now) {
            let left = if self.path.is_file() { "the last one remains" } else { "there is none" };
            let path = self.path.display();
            output::warn(format_args!(
                "{path}: cannot write a checkpoint, {left}: {why}; the render continues"
            ));
        }
        *before = now;
    }

    /// Writes a checkpoint.
    pub(in crate::cli) fn write(
        &self,
        setup: &RenderSetup,
        prepared: &Prepared,
        caption: &Caption,
        render: &ResumableRender,
    ) -> io::Result<()> {
        let Invocation { command, folder, typed } = &self.invocation;
        let mut typed = typed.clone();
        if let Some(place) = setup.place {
            typed.set("first_picture", place.index.to_string());
        }
        let arguments = typed.arguments(command);
        let missing = || io::Error::other("the scene was not identified");
        let scene = prepared.identity.clone().ok_or_else(missing)?;
        let origin = Origin { scene, folder: folder.into(), arguments, caption: caption.clone() };
        checkpoint::write(&self.path, &origin, render)
    }

    /// The file of checkpoints.
    pub(in crate::cli) fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the command that resumes the render.
    pub(in crate::cli) fn resume_command(&self) -> String {
        format!("resume with: spherule render --resume {}", self.path.display())
    }
}

/// Checks that a file exists or can be created.
fn check(path: &Path) -> io::Result<()> {
    check_destination(path)?;
    if path.exists() && !path.is_file() {
        let message = "it is a device or a pipe; give a file";
        return Err(io::Error::new(ErrorKind::InvalidInput, message));
    }
    Ok(())
}
