//! Options for checkpoints: files that hold the state of a render.

use super::values::{self, OrNone};
use crate::cli::failure::Failure;
use spherule_render::atomic::FileIdentity;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Default time between two checkpoints: at least the first value, and at least this multiple of the time
/// that the last checkpoint took, so that checkpoints take less than a hundredth of the time.
const EVERY: (Duration, u32) = (Duration::from_secs(60), 100);

/// Options for checkpoints.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Long renders")]
pub(in crate::cli) struct CheckpointArgs {
    /// Save the render's state to FILE, periodically and on exit, also by Ctrl-C, SIGTERM or --time; of a
    /// sequence, the state of the current image and its number
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) checkpoint: Option<PathBuf>,
    /// Time between checkpoints, as in 60s or 10m; none to save only on exit [default: 60s]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = values::time)]
    checkpoint_every: Option<OrNone<Duration>>,
    /// Resume from a checkpoint FILE, and save to it again; the image is the same as without the
    /// interruption. The command's options are stored in FILE; --spp, --time and --until-error may ask for
    /// more, and options that do not change samples may differ
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) resume: Option<PathBuf>,
}

impl CheckpointArgs {
    /// The file that checkpoints are written to.
    pub(in crate::cli) fn file(&self) -> Option<&PathBuf> {
        self.checkpoint.as_ref().or(self.resume.as_ref())
    }

    /// Returns whether the resumed checkpoint and the written one are the same file.
    pub(in crate::cli) fn resumes_into_itself(&self) -> bool {
        let Some(resumed) = &self.resume else { return false };
        let identity = |path: &Path| FileIdentity::of(path).ok().flatten();
        self.checkpoint.as_ref().is_none_or(|kept| {
            kept == resumed || identity(kept).is_some_and(|kept| identity(resumed) == Some(kept))
        })
    }

    /// Time until the next checkpoint if the last one `took` this long; `None` to write one only on exit.
    pub(in crate::cli) fn pause(&self, took: Duration) -> Option<Duration> {
        let default = || Some(EVERY.0.max(took.saturating_mul(EVERY.1)));
        self.checkpoint_every.map_or_else(default, |OrNone(time)| time)
    }

    /// Rejects options that have no effect.
    pub(in crate::cli) fn check(&self) -> Result<(), Failure> {
        if self.file().is_none() && self.checkpoint_every.is_some() {
            let message = "--checkpoint-every needs --checkpoint FILE";
            return Err(Failure::usage("render", message));
        }
        Ok(())
    }
}
