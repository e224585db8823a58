//! Identity of files, independent of their names.

use super::{folder_of, follow};
use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::io::{self, ErrorKind};
use std::path::Path;

/// Maximum number of entries of a folder that are tested to find whether it ignores case.
const MAX_TESTED: usize = 64;

/// The file that a path leads to, through symbolic links, whether it exists or not: equal for all
/// names, hard links and spellings of one file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FileIdentity(Identity);

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Identity {
    Existing(Number),
    /// A free name; in lower case if the folder ignores case.
    New {
        folder: Number,
        name: OsString,
    },
}

/// The file system's identification of a file: its device and inode.
#[cfg(unix)]
type Number = (u64, u64);

/// The file's canonical path, since there are no inodes.
#[cfg(not(unix))]
type Number = std::path::PathBuf;

impl FileIdentity {
    /// Returns the identity of the file at `path`; `None` for a character device such as `/dev/null` or
    /// a terminal, which cannot be replaced.
    ///
    /// # Errors
    /// The folder is missing, cannot be searched, or symbolic links form a loop.
    pub fn of(path: &Path) -> io::Result<Option<Self>> {
        let path = follow(path)?;
        match fs::metadata(&path) {
            Ok(file) if is_character_device(&file) => Ok(None),
            Ok(file) => Ok(Some(Self(Identity::Existing(number(&path, &file))))),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                let folder = folder_of(&path)?;
                let name = path.file_name().unwrap_or_default().to_owned();
                let name = if ignores_case(&folder) { lower_case(name) } else { name };
                let folder = number(&folder, &fs::metadata(&folder)?);
                Ok(Some(Self(Identity::New { folder, name })))
            }
            Err(error) => Err(error),
        }
    }

    /// Returns the identity of an open file or pipe, such as standard output; `None` for devices and
    /// sockets, and on systems without this information.
    ///
    /// # Errors
    /// The system does not describe the file.
    pub fn of_open(file: &File) -> io::Result<Option<Self>> {
        Ok(open_number(&file.metadata()?).map(|number| Self(Identity::Existing(number))))
    }
}

#[cfg(unix)]
fn number(_: &Path, file: &Metadata) -> Number {
    use std::os::unix::fs::MetadataExt;
    (file.dev(), file.ino())
}

#[cfg(not(unix))]
fn number(path: &Path, _: &Metadata) -> Number {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

#[cfg(unix)]
fn open_number(file: &Metadata) -> Option<Number> {
    use std::os::unix::fs::FileTypeExt;
    let kind = file.file_type();
    (kind.is_file() || kind.is_fifo()).then(|| number(Path::new(""), file))
}

#[cfg(not(unix))]
fn open_number(_: &Metadata) -> Option<Number> {
    None
}

#[cfg(unix)]
fn is_character_device(file: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    file.file_type().is_char_device()
}

#[cfg(not(unix))]
fn is_character_device(_: &Metadata) -> bool {
    false
}

/// Returns whether a folder ignores case in names, according to its files; for an empty folder, the
/// default of the system.
fn ignores_case(folder: &Path) -> bool {
    let swapped = |name: &str| -> String {
        let swap = |c: char| {
            if c.is_ascii_lowercase() { c.to_ascii_uppercase() } else { c.to_ascii_lowercase() }
        };
        name.chars().map(swap).collect()
    };
    let entries = fs::read_dir(folder).into_iter().flatten().take(MAX_TESTED).flatten();
    let mut names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    match names.find(|name| name.bytes().any(|byte| byte.is_ascii_alphabetic())) {
        Some(name) => {
            let number = |name: &str| {
                let path = folder.join(name);
                fs::symlink_metadata(&path).map(|file| number(&path, &file)).ok()
            };
            number(&name).is_some_and(|own| number(&swapped(&name)) == Some(own))
        }
        None => cfg!(any(windows, target_vendor = "apple")),
    }
}

fn lower_case(name: OsString) -> OsString {
    name.into_string().map_or_else(|name| name, |name| name.to_lowercase().into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(path: &Path) -> FileIdentity {
        FileIdentity::of(path).unwrap().unwrap()
    }

    #[test]
    fn spellings_of_one_name_are_one_file_existing_or_not() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        fs::create_dir(root.join("below")).unwrap();
        for exists in [false, true] {
            let plain = identity(&root.join("a.png"));
            assert_eq!(identity(&root.join("./a.png")), plain, "{exists}");
            assert_eq!(identity(&root.join("below/../a.png")), plain, "{exists}");
            assert_ne!(identity(&root.join("b.png")), plain, "{exists}");
            assert_ne!(identity(&root.join("below/a.png")), plain, "{exists}");
            fs::write(root.join("a.png"), "").unwrap();
        }
        assert!(FileIdentity::of(&root.join("missing/a.png")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_to_the_file_and_devices_to_none() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        symlink("a.png", path("link")).unwrap();
        symlink(folder.path(), path("here")).unwrap();
        assert_eq!(identity(&path("link")), identity(&path("a.png")));
        assert_eq!(identity(&path("here/a.png")), identity(&path("a.png")));
        fs::write(path("a.png"), "").unwrap();
        fs::hard_link(path("a.png"), path("hard")).unwrap();
        for name in ["link", "hard", "here/a.png"] {
            assert_eq!(identity(&path(name)), identity(&path("a.png")), "{name}");
        }
        let open = File::open(path("hard")).unwrap();
        assert_eq!(FileIdentity::of_open(&open).unwrap(), Some(identity(&path("a.png"))));
        assert_eq!(FileIdentity::of(Path::new("/dev/null")).unwrap(), None);
    }

    #[test]
    fn case_matters_where_the_folder_is_case_sensitive() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("Probe"), "").unwrap();
        let ignored = folder.path().join("pROBE").exists();
        let same = identity(&folder.path().join("a.png")) == identity(&folder.path().join("A.png"));
        assert_eq!(same, ignored);
    }
}
