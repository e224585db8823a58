//! Files for tests.

use std::path::PathBuf;

/// A file in a folder that is removed with it.
pub(crate) struct File {
    _folder: tempfile::TempDir,
    pub(crate) path: PathBuf,
}

/// Writes a file.
pub(crate) fn file(content: impl AsRef<[u8]>) -> File {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("input");
    std::fs::write(&path, content).expect("a file");
    File { _folder: folder, path }
}
