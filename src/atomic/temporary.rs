//! Where content is until it takes its destination's name.
//!
//! Linux has files without a name, which it removes when the last program that has them open ends, however
//! that ends. Elsewhere, and on file systems that have no such files, it is a file beside the destination
//! that programs which are killed leave behind.

use super::explain;
use std::fs::{File, Permissions};
use std::io;
use std::path::Path;
use tempfile::NamedTempFile;

/// What the names of temporary files end with, after so many random characters.
pub(super) const SUFFIX: &str = ".spherule-tmp";
pub(super) const RANDOM: usize = 8;

/// Bytes of a file's name that are in those of its temporary files: systems take 255 in all.
const NAMED: usize = 200;

/// An empty file in the folder of its destination, with the permissions of any new file, which goes
/// when it is dropped.
pub(super) enum Temporary {
    #[cfg(target_os = "linux")]
    Unnamed(File),
    Named(NamedTempFile<File>),
}

impl Temporary {
    /// In the folder of `path`.
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

    /// Takes the place of what is at `path`, if there is anything.
    pub(super) fn persist(self, path: &Path, folder: &Path) -> io::Result<()> {
        match self {
            #[cfg(target_os = "linux")]
            Self::Unnamed(file) => {
                if unnamed::link(&file, path).is_ok() {
                    return Ok(());
                }
                // Something is there, and links replace nothing. From here to the next line a
                // program that is killed leaves the whole content behind. Nothing is opened for it:
                // there may be no descriptor left.
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

/// What the names of a file's temporary files begin with.
pub(super) fn prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut end = name.len().min(NAMED);
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

/// One with a name.
pub(super) fn named(path: &Path, folder: &Path) -> io::Result<NamedTempFile<File>> {
    let prefix = prefix(path);
    let mut builder = builder(&prefix);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Less what the process's umask forbids.
        builder.permissions(Permissions::from_mode(MODE));
    }
    builder.tempfile_in(folder).map_err(|error| {
        // The error itself would name the temporary file, which is no help.
        let (folder, kind) = (folder.display(), error.kind());
        let message =
            format!("no file can be created in \"{folder}\" ({kind}); choose another folder");
        explain(kind, &message)
    })
}

/// Permissions of any new file.
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

    /// A file without a name, if there can be one and it can get one later.
    pub(super) fn create(folder: &Path) -> Option<File> {
        let flags = OFlags::TMPFILE | OFlags::WRONLY | OFlags::CLOEXEC;
        let file = File::from(rustix::fs::open(folder, flags, Mode::from_raw_mode(MODE)).ok()?);
        here(&file).exists().then_some(file)
    }

    /// Gives it a name that nothing else has.
    pub(super) fn link(file: &File, path: &Path) -> io::Result<()> {
        Ok(rustix::fs::linkat(CWD, here(file), CWD, path, AtFlags::SYMLINK_FOLLOW)?)
    }

    /// Where an open file is, if the system tells.
    fn here(file: &File) -> PathBuf {
        format!("/proc/self/fd/{}", file.as_raw_fd()).into()
    }
}
