//! Temporary files of a session.

use crate::cli::signals;
use std::path::PathBuf;
use tempfile::TempDir;

/// A folder of temporary files, once there are any. It is removed with this.
#[derive(Default)]
pub(super) struct Scratch {
    folder: Option<TempDir>,
    places: u64,
}

impl Scratch {
    /// Returns whether there may be temporary files, which a signal must not leave behind.
    pub(super) fn is_used(&self) -> bool {
        self.folder.is_some()
    }

    /// Returns the path of a new temporary file or folder. Signals are caught from now on.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub(super) fn place(&mut self) -> Result<PathBuf, String> {
        if self.folder.is_none() {
            signals::catch();
        }
        let folder = match self.folder.take() {
            Some(folder) => folder,
            None => tempfile::tempdir().map_err(|error| error.to_string())?,
        };
        self.places += 1;
        Ok(self.folder.insert(folder).path().join(self.places.to_string()))
    }
}
