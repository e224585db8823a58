//! Files that another program writes.

use super::{Destination, explain, sync, temporary};
use std::fs::{File, Metadata};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that another program writes by its name, and that replaces its destination once it is
/// complete. If it is dropped before, it is removed, and the destination is unchanged.
#[derive(Debug)]
pub struct Pending {
    temporary: NamedTempFile<File>,
    destination: PathBuf,
    folder: PathBuf,
    old: Option<Metadata>,
}

impl Pending {
    /// Creates an empty file in the folder of its destination.
    ///
    /// # Errors
    /// Those of [`super::write_atomically`] before it writes anything; a device or a pipe is refused.
    pub fn create(path: impl AsRef<Path>) -> io::Result<Self> {
        match Destination::find(path.as_ref())? {
            Destination::Special(_) => {
                Err(explain(ErrorKind::InvalidInput, "it is a device or a pipe; name a file"))
            }
            Destination::Regular { path, folder, old } => {
                let temporary = temporary::named(&path, &folder)?;
                Ok(Self { temporary, destination: path, folder, old })
            }
        }
    }

    /// Returns the temporary path of the file.
    pub fn path(&self) -> &Path {
        self.temporary.path()
    }

    /// Moves the file, which is complete, to its destination.
    ///
    /// # Errors
    /// The system's error; the destination is then unchanged.
    pub fn persist(self) -> io::Result<()> {
        // The program may have replaced the file that was opened here.
        let file = File::open(self.temporary.path())?;
        if let Some(old) = self.old {
            file.set_permissions(old.permissions())?;
        }
        file.sync_all()?;
        self.temporary.persist(&self.destination)?;
        sync(&self.folder);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn complete_files_are_moved_and_others_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("film.mp4");
        fs::write(&path, "old").unwrap();
        let pending = Pending::create(&path).unwrap();
        assert_eq!(pending.path().parent(), Some(folder.path()));
        fs::write(pending.path(), "half").unwrap();
        drop(pending);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        let pending = Pending::create(&path).unwrap();
        fs::write(pending.path(), "whole").unwrap();
        pending.persist().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(Pending::create(folder.path().join("none/a")).is_err());
        assert!(Pending::create(folder.path()).is_err());
    }
}
