//! Temporary files that hold content until it is moved to its destination.
//!
//! Linux has unnamed files, which it removes when the last program that has them open ends for any
//! reason. Elsewhere, and on file systems without unnamed files, the file is next to the destination,
//! and killed programs leave it behind.

use super::explain;
use std::fs::{File, Permissions};
use std::io;
use std::path::Path;
use tempfile::NamedTempFile;

/// The suffix of names of temporary files, after some random characters.
pub(super) const SUFFIX: &str = ".spherule-tmp";
pub(super) const RANDOM: usize = 8;

/// Maximum bytes of the destination's name in the name of a temporary file: systems limit names to 255.
const MAX_PREFIX: usize = 200;

/// An empty file in the folder of its destination, with the permissions of a new file, which is removed
/// when it is dropped.
pub(super) enum Temporary {
    #[cfg(target_os = "linux")]
    Unnamed(File),
    Named(NamedTempFile<File>),
}

impl Temporary {
    /// Creates a temporary file in the folder of `path`.
    pub(super) fn create(path: &Path, folder: &Path) -> io::Result<Self> {
        #[cfg(target_os = "linux")]
        if let Some(file) = unnamed::create(folder) {
            return Ok(Self::Unnamed(file));
        }
        named(path, folder).map(Self::Named)
    }

    pub(super) fn file(&self) -> &File {
        match self {
            #[cfg(target_os = "linux")]
            Self::Unnamed(file) => file,
            Self::Named(file) => file.as_file(),
        }
    }

    /// Replaces the file at `path`, if there is one.
    pub(super) fn persist(self, path: &Path, folder: &Path) -> io::Result<()> {
        match self {
            #[cfg(target_os = "linux")]
            Self::Unnamed(file) => {
                if unnamed::link(&file, path).is_ok() {
                    return Ok(());
                }
                // The destination exists, and links do not replace files. A program that is killed
                // between here and the next line leaves the whole content behind. No file is opened for
                // it, since no descriptor may be left.
                let link = |name: &Path| unnamed::link(&file, name);
                builder(&prefix(path)).make_in(folder, link)?.persist(path)?;
            }
            Self::Named(file) => {
                file.persist(path)?;
            }
        }
        Ok(())
    }
}

/// Returns the prefix of the names of a file's temporary files.
pub(super) fn prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut end = name.len().min(MAX_PREFIX);
    while !name.is_char_boundary(end) {
        end -= 1;
    }
    format!(".{}-", &name[..end])
}

fn builder(prefix: &str) -> tempfile::Builder<'_, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    builder
}

/// Creates a temporary file with a name.
pub(super) fn named(path: &Path, folder: &Path) -> io::Result<NamedTempFile<File>> {
    let prefix = prefix(path);
    let mut builder = builder(&prefix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The process's umask applies.
        builder.permissions(Permissions::from_mode(MODE));
    }
    builder.tempfile_in(folder).map_err(|error| {
        // The error itself would name the temporary file, which does not help.
        let (folder, kind) = (folder.display(), error.kind());
        let message =
            format!("cannot create a file in \"{folder}\" ({kind}); choose another folder");
        explain(kind, &message)
    })
}

/// Permissions of a new file.
#[cfg(unix)]
const MODE: u32 = 0o666;

#[cfg(target_os = "linux")]
mod unnamed {
    use super::MODE;
    use rustix::fs::{AtFlags, CWD, Mode, OFlags};
    use std::fs::File;
    use std::io;
    use std::os::fd::AsRawFd;
    use std::path::{Path, PathBuf};

    /// Creates an unnamed file, if the system supports it and can name it later.
    pub(super) fn create(folder: &Path) -> Option<File> {
        let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
        let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(MODE)).ok()?);
        open_path(&file).exists().then_some(file)
    }

    /// Gives it a new name.
    pub(super) fn link(file: &File, path: &Path) -> io::Result<()> {
        Ok(rustix::fs::linkat(CWD, open_path(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
    }

    /// Returns the path of an open file, if the system provides it.
    fn open_path(file: &File) -> PathBuf {
        format!("/proc/self/fd/{}", file.as_raw_fd()).into()
    }
}
