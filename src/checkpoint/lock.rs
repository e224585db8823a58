//! One process for one file.

use crate::atomic::follow;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time after which a lock that is not held for a render is given back.
const MOMENT: Duration = Duration::from_millis(2);

/// The right to write a file: no other process has it as long as this is there.
///
/// It is a lock of the system on a file beside it, whose name has `.lock` at its end: not on the
/// file itself, which is replaced each time that it is written. The system takes it back from
/// processes that are killed; the file of the lock goes when the lock is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Locked as long as it is open.
    _file: File,
}

/// Why there is no lock.
#[derive(Debug, thiserror::Error)]
pub enum LockError {
    /// Another process has it.
    #[error(
        "{}: another process writes it; wait for its end, or choose another file", .0.display()
    )]
    Held(PathBuf),
    /// The file of the lock cannot be made.
    #[error("{}: cannot be locked: {}", .0.display(), .1)]
    Failed(PathBuf, io::Error),
}

impl Lock {
    /// Takes the lock on a file, which need not be there yet; symbolic links are followed. `None`
    /// on file systems that have no locks.
    ///
    /// # Errors
    /// Another process has it, or the file of the lock cannot be made.
    pub fn take(path: &Path) -> Result<Option<Self>, LockError> {
        let failed = |error| LockError::Failed(path.to_owned(), error);
        let beside = beside(path).map_err(failed)?;
        let mut again = false;
        loop {
            let file = OpenOptions::new().write(true).create(true).truncate(false).open(&beside);
            let file = file.map_err(failed)?;
            if file.metadata().map_err(failed)?.len() > 0 {
                let name = beside.display();
                let message = format!(
                    "{name} is in the way, which is no lock; move it, or choose another file"
                );
                return Err(failed(io::Error::new(ErrorKind::AlreadyExists, message)));
            }
            match file.try_lock() {
                Ok(()) => {}
                // `is_locked` has locks for a moment.
                Err(TryLockError::WouldBlock) if !again => {
                    again = true;
                    std::thread::sleep(MOMENT);
                    continue;
                }
                Err(TryLockError::WouldBlock) => return Err(LockError::Held(path.to_owned())),
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                    return Ok(None);
                }
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
            // Who had it before may have removed the file since it was opened.
            if is_at(&file, &beside).map_err(failed)? {
                return Ok(Some(Self { path: beside, _file: file }));
            }
        }
    }
}

/// Whether another process has the lock on a file. Changes nothing, and says no where there are no locks.
pub fn is_locked(path: &Path) -> bool {
    let open = beside(path).and_then(File::open);
    // A shared lock, which is given back at once, can be had of files that are open for reading.
    open.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

impl Drop for Lock {
    fn drop(&mut self) {
        // While it is locked still: the next one makes a new file. If it stays, it does no harm.
        let _ = fs::remove_file(&self.path);
    }
}

/// The file of a file's lock.
fn beside(path: &Path) -> io::Result<PathBuf> {
    let mut name = OsString::from(follow(path)?);
    name.push(".lock");
    Ok(name.into())
}

/// Whether a file that is open is the one of that name.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let open = file.metadata()?;
    match fs::metadata(path) {
        Ok(named) => Ok((open.dev(), open.ino()) == (named.dev(), named.ino())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Elsewhere files that are open cannot be removed.
#[cfg(not(unix))]
fn is_at(_: &File, _: &Path) -> io::Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_at_a_time_has_the_lock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("render");
        for _ in 0..3 {
            let lock = Lock::take(&path).unwrap();
            assert!(lock.is_some());
            assert!(matches!(Lock::take(&path), Err(LockError::Held(_))));
            assert!(is_locked(&path) && !is_locked(&folder.path().join("other")));
            assert!(Lock::take(&folder.path().join("other")).is_ok());
            drop(lock);
        }
        assert!(!is_locked(&path));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn what_was_left_behind_does_no_harm() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("render");
        fs::write(folder.path().join("render.lock"), "").unwrap();
        assert!(Lock::take(&path).unwrap().is_some());
    }

    #[test]
    fn one_of_many_threads_has_the_lock() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("render");
        let inside = std::sync::atomic::AtomicU32::new(0);
        let order = std::sync::atomic::Ordering::SeqCst;
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    for _ in 0..500 {
                        let Ok(lock) = Lock::take(&path) else { continue };
                        assert_eq!(inside.fetch_add(1, order), 0);
                        inside.fetch_sub(1, order);
                        drop(lock);
                    }
                });
            }
        });
    }

    #[cfg(unix)]
    #[test]
    fn links_to_a_file_have_its_lock() {
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("render"), folder.path().join("link"));
        std::os::unix::fs::symlink("render", &link).unwrap();
        let _lock = Lock::take(&path).unwrap();
        assert!(matches!(Lock::take(&link), Err(LockError::Held(_))));
        assert!(Lock::take(&folder.path().join("nowhere/render")).is_err());
    }
}
