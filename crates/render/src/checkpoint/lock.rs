//! Locks on files, for one process at a time.

use crate::atomic::follow;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time after which a lock that is only tested is released.
const RETRY_DELAY: Duration = Duration::from_millis(2);

/// The exclusive right of a process to write a file, as long as this value exists.
///
/// It is a system lock on a file next to it with the suffix `.lock`, not on the file itself, which is
/// replaced each time that it is written. The system releases the locks of killed processes; the lock
/// file is removed when the lock is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    /// Locked as long as it is open.
    _file: File,
}

/// Reasons why a lock could not be taken.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LockError {
    /// Another process holds it.
    #[error(
        "{}: another process is writing it; wait until it ends, or choose another file", .0.display()
    )]
    Held(PathBuf),
    /// The lock file cannot be created.
    #[error("{}: cannot be locked: {}", .0.display(), .1)]
    Failed(PathBuf, io::Error),
}

impl Lock {
    /// Takes the lock on a file, which need not exist; symbolic links are followed. `None` on file
    /// systems without locks.
    ///
    /// # Errors
    /// Another process holds it, or the lock file cannot be created.
    pub fn take(path: &Path) -> Result<Option<Self>, LockError> {
        let failed = |error| LockError::Failed(path.to_owned(), error);
        let lock_file = lock_path(path).map_err(failed)?;
        let mut retried = false;
        loop {
            let file = OpenOptions::new().write(true).create(true).truncate(false).open(&lock_file);
            let file = file.map_err(failed)?;
            if file.metadata().map_err(failed)?.len() > 0 {
                let name = lock_file.display();
                let message =
                    format!("{name} exists and is not a lock; move it, or choose another file");
                return Err(failed(io::Error::new(ErrorKind::AlreadyExists, message)));
            }
            match file.try_lock() {
                Ok(()) => {}
                // `is_locked` may hold the lock for a short time.
                Err(TryLockError::WouldBlock) if !retried => {
                    retried = true;
                    std::thread::sleep(RETRY_DELAY);
                    continue;
                }
                Err(TryLockError::WouldBlock) => return Err(LockError::Held(path.to_owned())),
                Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
                    return Ok(None);
                }
                Err(TryLockError::Error(error)) => return Err(failed(error)),
            }
            // The previous holder may have removed the file since it was opened.
            if is_same_file(&file, &lock_file).map_err(failed)? {
                return Ok(Some(Self { path: lock_file, _file: file }));
            }
        }
    }
}

/// Returns whether another process holds the lock on a file. Changes nothing; false where there are
/// no locks.
pub fn is_locked(path: &Path) -> bool {
    let open = lock_path(path).and_then(File::open);
    // A shared lock, released at once, is possible on files that are open for reading.
    open.is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Removed while it is still locked: the next process creates a new file. If it stays, it does
        // no harm.
        let _ = fs::remove_file(&self.path);
    }
}

/// Returns the path of a file's lock.
fn lock_path(path: &Path) -> io::Result<PathBuf> {
    let mut name = OsString::from(follow(path)?);
    name.push(".lock");
    Ok(name.into())
}

/// Returns whether an open file is the one at a path.
#[cfg(unix)]
fn is_same_file(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let open = file.metadata()?;
    match fs::metadata(path) {
        Ok(named) => Ok((open.dev(), open.ino()) == (named.dev(), named.ino())),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// On other systems open files cannot be removed.
#[cfg(not(unix))]
fn is_same_file(_: &File, _: &Path) -> io::Result<bool> {
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_process_at_a_time_holds_the_lock() {
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
    fn leftover_lock_files_do_no_harm() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("render");
        fs::write(folder.path().join("render.lock"), "").unwrap();
        assert!(Lock::take(&path).unwrap().is_some());
    }

    #[test]
    fn one_of_many_threads_holds_the_lock() {
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
    fn links_to_a_file_have_the_same_lock() {
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("render"), folder.path().join("link"));
        std::os::unix::fs::symlink("render", &link).unwrap();
        let _lock = Lock::take(&path).unwrap();
        assert!(matches!(Lock::take(&link), Err(LockError::Held(_))));
        assert!(Lock::take(&folder.path().join("nowhere/render")).is_err());
    }
}
