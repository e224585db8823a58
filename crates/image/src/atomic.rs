//! Atomic writing of files: they are replaced completely or not at all.
//!
//! A render takes hours, and the file that it replaces may be the only copy. So content is written to a
//! temporary file next to the destination (without a name if the system supports this), flushed to the
//! disk, and moved to the destination in one step. If anything fails before that step, the old file is
//! unchanged.

mod identity;
mod pending;
mod temporary;

pub use self::identity::FileIdentity;
pub use pending::Pending;

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, BufWriter, ErrorKind, Write},
    path::{Path, PathBuf},
};
use temporary::Temporary;

/// Maximum length of a chain of links, as in Linux; longer ones count as a loop.
const MAXIMUM_LINKS: usize = 40;

/// The kind of a destination, with symbolic links resolved.
enum Destination {
    /// No file, or a regular file, which is replaced.
    Regular { path: PathBuf, folder: PathBuf, old: Option<Metadata> },
    /// A device or pipe, such as `/dev/null`, which must not be replaced: written to directly.
    Special(PathBuf),
}

/// Writes a file with `fill`; afterwards it is either complete or unchanged.
///
/// The writer is buffered. An existing file keeps its permissions; a new one gets default permissions.
/// A symbolic link stays, and its target is replaced. Devices and pipes are written to directly. A
/// folder in which no file can be created is refused even if the file itself is writable.
///
/// # Errors
/// Errors of `fill` and of the system; the old file is then unchanged and no temporary file is left
/// behind. A destination whose folder is missing, that is a folder itself or is write-protected is
/// refused before `fill` is called, with a message that says how to fix it.
pub fn write_atomically<F>(path: impl AsRef<Path>, fill: F) -> io::Result<()>
where
    F: FnOnce(&mut dyn Write) -> io::Result<()>,
{
    match Destination::find(path.as_ref())? {
        Destination::Special(path) => {
            let mut writer = BufWriter::new(OpenOptions::new().write(true).open(path)?);
            fill(&mut writer)?;
            writer.flush()
        }
        Destination::Regular { path, folder, old } => {
            let temporary = Temporary::create(&path, &folder)?;
            let mut writer = BufWriter::new(temporary.file());
            fill(&mut writer)?;
            writer.flush()?;
            drop(writer);
            if let Some(old) = old {
                temporary.file().set_permissions(old.permissions())?;
            }
            temporary.file().sync_all()?;
            temporary.persist(&path, &folder)?;
            sync(&folder);
            Ok(())
        }
    }
}

/// Checks whether [`write_atomically`] could start on `path`, without changing an existing file.
///
/// # Errors
/// Those of [`write_atomically`] before it calls `fill`.
pub fn check_destination(path: impl AsRef<Path>) -> io::Result<()> {
    match Destination::find(path.as_ref())? {
        // Opening a pipe would wait for its reader.
        Destination::Special(_) => Ok(()),
        // The file is removed when it is dropped.
        Destination::Regular { path, folder, .. } => Temporary::create(&path, &folder).map(drop),
    }
}

/// Removes temporary files that killed programs have left next to a file. No other process may write
/// the file meanwhile.
///
/// # Errors
/// The folder cannot be read, or a file in it cannot be removed.
pub fn remove_leftovers(path: impl AsRef<Path>) -> io::Result<()> {
    let path = follow(path.as_ref())?;
    let prefix = temporary::prefix(&path);
    for entry in fs::read_dir(folder_of(&path)?)? {
        let entry = entry?;
        let name = entry.file_name();
        let middle = name.to_str().and_then(|name| name.strip_prefix(&prefix));
        let random = middle.and_then(|name| name.strip_suffix(temporary::SUFFIX));
        if random.is_some_and(|random| random.len() == temporary::RANDOM) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}

impl Destination {
    fn find(path: &Path) -> io::Result<Self> {
        let path = follow(path)?;
        let old = match fs::metadata(&path) {
            Ok(old) if old.is_dir() => {
                return Err(explain(ErrorKind::IsADirectory, "it is a folder; name a file in it"));
            }
            Ok(old) if !old.is_file() => return Ok(Self::Special(path)),
            Ok(old) => Some(old),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(error) => return Err(error),
        };
        if old.is_some() {
            check_not_protected(&path)?;
        }
        let folder = folder_of(&path)?;
        Ok(Self::Regular { path, folder, old })
    }
}

/// Resolves all symbolic links of a path, even if the last one points to no file yet.
///
/// # Errors
/// A folder cannot be read, or the links form a loop.
pub fn follow(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MAXIMUM_LINKS {
        match fs::canonicalize(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let Ok(target) = fs::read_link(&path) else { return Ok(path) };
                path = path.parent().unwrap_or(Path::new("")).join(target);
            }
            found => return found,
        }
    }
    Err(explain(ErrorKind::InvalidInput, "its symbolic links form a loop; remove them"))
}

/// Refuses write-protected files: replacing needs no right to the old file, so they would be lost
/// silently.
fn check_not_protected(path: &Path) -> io::Result<()> {
    match OpenOptions::new().write(true).open(path).map(drop) {
        Err(error) if error.kind() == ErrorKind::PermissionDenied => Err(explain(
            error.kind(),
            "it is write-protected; allow writing or choose another name",
        )),
        opened => opened,
    }
}

fn folder_of(path: &Path) -> io::Result<PathBuf> {
    let Some(folder) = path.file_name().and(path.parent()) else {
        return Err(explain(ErrorKind::InvalidInput, "it names no file; give a file name"));
    };
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    if folder.is_dir() {
        return Ok(folder.to_owned());
    }
    let message = format!("folder \"{}\" not found; create it first", folder.display());
    Err(explain(ErrorKind::NotFound, &message))
}

/// Flushes the entry of a file in its folder to the disk, on systems that support it. The file exists
/// even if this fails.
fn sync(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}

fn explain(kind: ErrorKind, message: &str) -> io::Error {
    io::Error::new(kind, message)
}

#[cfg(test)]
mod tests;
