//! Renders that are kept in a file, and gone on with.

use super::Failure;
use super::values::{self, Target};
use spherule::atomic::FileIdentity;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time between two checkpoints, where nobody says another; and in times of what the last one took,
/// so that they take less than a hundredth of the time.
const EVERY: (Duration, u32) = (Duration::from_secs(60), 100);

/// What a render leaves behind, to be gone on with.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Long renders")]
pub(super) struct KeepArgs {
    /// Save the state of the render to FILE, periodically and when it ends, also by Ctrl-C, SIGTERM or
    /// --time; of a sequence, the picture that is being rendered and its place
    #[arg(long, value_name = "FILE")]
    pub(super) checkpoint: Option<PathBuf>,
    /// Time between two checkpoints, as in 60s or 10m; none for one at the end alone [default: 60s]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = values::time)]
    checkpoint_every: Option<Target<Duration>>,
    /// Go on from such a file, to the same picture as if nothing had been, and keep what comes in
    /// it. Nothing need be said again; more samples, more time, a smaller error, and all that does
    /// not change samples may be
    #[arg(long, value_name = "FILE")]
    pub(super) resume: Option<PathBuf>,
}

impl KeepArgs {
    /// Where checkpoints go.
    pub(super) fn file(&self) -> Option<&PathBuf> {
        self.checkpoint.as_ref().or(self.resume.as_ref())
    }

    /// Returns whether the checkpoint that is resumed is the one that is written, whatever their names.
    pub(super) fn resumes_into_itself(&self) -> bool {
        let Some(resumed) = &self.resume else { return false };
        let identity = |path: &Path| FileIdentity::of(path).ok().flatten();
        self.checkpoint.as_ref().is_none_or(|kept| {
            kept == resumed || identity(kept).is_some_and(|kept| identity(resumed) == Some(kept))
        })
    }

    /// Time until the next one, if the last one `took` so long; `None` for none but at the end.
    pub(super) fn pause(&self, took: Duration) -> Option<Duration> {
        let usual = || Some(EVERY.0.max(took.saturating_mul(EVERY.1)));
        self.checkpoint_every.map_or_else(usual, |Target(time)| time)
    }

    /// Refuses what has no effect.
    pub(super) fn check(&self) -> Result<(), Failure> {
        if self.file().is_none() && self.checkpoint_every.is_some() {
            let message = "--checkpoint-every is for checkpoints: say --checkpoint FILE";
            return Err(Failure::usage("render", message));
        }
        Ok(())
    }
}
