//! Files that appear whole or not at all.
//!
//! A render takes hours, and the file it replaces may be the only copy of another. So content goes
//! to a temporary file beside the destination, is forced to the disk, and takes the destination's
//! name in one step. Whatever fails before that step leaves the old file as it was.

use std::{
    fs::{self, File, Metadata, OpenOptions},
    io::{self, BufWriter, ErrorKind, Write},
    path::{Path, PathBuf},
};
use tempfile::NamedTempFile;

/// More links in a row than this are taken for a loop, as Linux does.
const MAXIMUM_LINKS: usize = 40;

/// What is at a destination, symbolic links followed.
enum Destination {
    /// Nothing, or a regular file: replaced as a whole.
    Regular { path: PathBuf, folder: PathBuf, old: Option<Metadata> },
    /// A device or pipe, such as `/dev/null`: written to directly, for it must not be replaced.
    Special(PathBuf),
}

/// Writes a file by `fill`, so that afterwards it is either complete or as it was before.
///
/// The writer is buffered. An existing file keeps its permissions, a new one gets those that any
/// new file gets. A symbolic link stays, and what it points to is replaced. Devices and pipes are
/// written to directly. A folder in which no file can be created is refused even if the file itself
/// is writable.
///
/// # Errors
/// What `fill` returns, or what the system says; the old file is then untouched and no temporary
/// file is left behind. A destination that is missing its folder, is a folder itself or is
/// write-protected is refused before `fill` is called, with a message that says what to do.
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
            let mut writer = BufWriter::new(create_temporary(&folder)?);
            fill(&mut writer)?;
            let file = writer.into_inner()?;
            if let Some(old) = old {
                file.as_file().set_permissions(old.permissions())?;
            }
            file.as_file().sync_all()?;
            file.persist(path)?;
            Ok(())
        }
    }
}

/// Finds out whether [`write_atomically`] could start on `path`, without touching what is there.
///
/// # Errors
/// What [`write_atomically`] would return before it calls `fill`.
pub fn check_destination(path: impl AsRef<Path>) -> io::Result<()> {
    match Destination::find(path.as_ref())? {
        // Opening a pipe would wait for its reader.
        Destination::Special(_) => Ok(()),
        // The temporary file goes when it is dropped.
        Destination::Regular { folder, .. } => create_temporary(&folder).map(drop),
    }
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

/// The path with every symbolic link resolved, also if the last one points to nothing yet.
fn follow(path: &Path) -> io::Result<PathBuf> {
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

/// Replacing needs no right to the old file, so that a write-protected one would be lost silently.
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
    let message = format!("there is no folder \"{}\"; create it first", folder.display());
    Err(explain(ErrorKind::NotFound, &message))
}

/// An empty file in `folder` with the permissions of any new file, which goes when it is dropped.
fn create_temporary(folder: &Path) -> io::Result<NamedTempFile<File>> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".spherule-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // Less what the process's umask forbids.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder).map_err(|error| {
        // The error itself would name the temporary file, which is no help.
        let (folder, kind) = (folder.display(), error.kind());
        let message =
            format!("no file can be created in \"{folder}\" ({kind}); choose another folder");
        explain(kind, &message)
    })
}

fn explain(kind: ErrorKind, message: &str) -> io::Error {
    io::Error::new(kind, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn new_and_old_files_get_the_content() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for content in [&b"first, and longer"[..], b"second", b""] {
            write_atomically(&path, |file| file.write_all(content)).unwrap();
            assert_eq!(fs::read(&path).unwrap(), content);
        }
        assert_eq!(names(folder.path()), ["a"]);
    }

    #[test]
    fn failures_leave_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let fail = |file: &mut dyn Write| {
            file.write_all(&[0; 10_000])?;
            Err(io::Error::other("out of ink"))
        };
        assert!(write_atomically(&path, fail).unwrap_err().to_string().contains("ink"));
        assert_eq!(names(folder.path()), [""; 0]);
        fs::write(&path, "old").unwrap();
        assert!(write_atomically(&path, fail).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a"]);
    }

    #[test]
    fn destinations_that_cannot_be_are_refused_before_they_are_filled() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "old").unwrap();
        let missing = folder.path().join("missing").join("a");
        for path in [folder.path(), &missing, &file.join("a"), Path::new(""), Path::new("/")] {
            let refused = check_destination(path).unwrap_err().to_string();
            let called = |_: &mut dyn Write| panic!("must not be called");
            assert_eq!(write_atomically(path, called).unwrap_err().to_string(), refused);
        }
        assert!(check_destination(missing).unwrap_err().to_string().contains("create it first"));
        assert!(check_destination(&file).is_ok());
        assert!(check_destination(folder.path().join("new")).is_ok());
        assert_eq!(names(folder.path()), ["file"]);
        assert_eq!(fs::read(&file).unwrap(), b"old");
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_a_new_file_or_the_old_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        let (path, ordinary) = (folder.path().join("a"), folder.path().join("b"));
        fs::write(&ordinary, "").unwrap();
        write_atomically(&path, |file| file.write_all(b"1")).unwrap();
        assert_eq!(mode(&path), mode(&ordinary));
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        write_atomically(&path, |file| file.write_all(b"2")).unwrap();
        assert_eq!(mode(&path) & 0o777, 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn symbolic_links_stay_and_their_target_is_written() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("elsewhere")).unwrap();
        symlink("elsewhere/target", path("inner")).unwrap();
        symlink("inner", path("outer")).unwrap();
        for content in ["to nothing yet", "to a file"] {
            write_atomically(path("outer"), |file| file.write_all(content.as_bytes())).unwrap();
            assert!(path("outer").is_symlink() && path("inner").is_symlink());
            assert_eq!(fs::read(path("elsewhere/target")).unwrap(), content.as_bytes());
        }
        symlink("loop", path("loop")).unwrap();
        assert!(check_destination(path("loop")).is_err());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn folders_that_take_no_files_are_found() {
        // Not even the superuser can create a file here.
        let message = check_destination("/proc/a").unwrap_err().to_string();
        assert!(message.contains("\"/proc\"") && message.contains("another folder"), "{message}");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_to_directly() {
        use std::os::unix::fs::FileTypeExt;
        let is_device = |path| fs::metadata(path).unwrap().file_type().is_char_device();
        let full = write_atomically("/dev/full", |file| file.write_all(b"1"));
        assert_eq!(full.unwrap_err().kind(), ErrorKind::StorageFull);
        assert!(is_device("/dev/full"));
        write_atomically("/dev/null", |file| file.write_all(b"1")).unwrap();
        assert!(is_device("/dev/null") && check_destination("/dev/null").is_ok());
    }
}
