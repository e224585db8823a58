//! The secret part of the page's address.

use crate::cli::failure::Failure;
use std::env;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Number of hexadecimal digits: 128 bits.
const DIGITS: usize = 32;

/// Returns the token of a port that was asked for, which stays the same so that a page finds a viewer that was started
/// again; a new one for a free port, and where none can be kept.
///
/// # Errors
/// The system has no random numbers.
pub(super) fn token(port: Option<u16>) -> Result<String, Failure> {
    match port.and_then(|port| Some(folder()?.join(format!("view-{port}")))) {
        Some(path) => kept(&path),
        None => random(),
    }
}

/// The folder of the user's own that tokens are kept in.
fn folder() -> Option<PathBuf> {
    let folder = |name: &str| env::var_os(name).filter(|text| !text.is_empty()).map(PathBuf::from);
    let cache = folder("XDG_CACHE_HOME").or_else(|| Some(folder("HOME")?.join(".cache")))?;
    Some(cache.join("spherule"))
}

/// Returns the token in a file that only its owner can read, or puts one there.
fn kept(path: &Path) -> Result<String, Failure> {
    let known = if is_private(path) { fs::read_to_string(path).ok() } else { None };
    let is_whole =
        |text: &String| text.len() == DIGITS && text.bytes().all(|digit| digit.is_ascii_hexdigit());
    if let Some(known) = known.filter(is_whole) {
        return Ok(known);
    }
    let token = random()?;
    // Without the file the next viewer at this port has another address.
    let _ = keep(path, &token);
    Ok(token)
}

fn keep(path: &Path, token: &str) -> std::io::Result<()> {
    path.parent().map_or(Ok(()), fs::create_dir_all)?;
    let _ = fs::remove_file(path);
    let mut options = OpenOptions::new();
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.write(true).create_new(true).open(path)?.write_all(token.as_bytes())
}

/// Returns whether a file is the user's own, and no link.
fn is_private(path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let user = rustix::process::getuid().as_raw();
        path.symlink_metadata().is_ok_and(|data| {
            data.is_file() && data.uid() == user && data.mode().trailing_zeros() >= 6
        })
    }
    #[cfg(not(unix))]
    path.is_file()
}

/// Returns 128 random bits in digits.
fn random() -> Result<String, Failure> {
    let mut bytes = [0; DIGITS / 2];
    getrandom::fill(&mut bytes)
        .map_err(|error| Failure::View(format!("no random numbers for the address: {error}")))?;
    Ok(format!("{:032x}", u128::from_be_bytes(bytes)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_of_ports_stay_and_others_do_not() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a/view-8000");
        let first = kept(&path).expect("a token");
        assert_eq!(first.len(), DIGITS);
        assert_eq!(kept(&path).expect("a token"), first);
        assert_ne!(random().expect("a token"), random().expect("a token"));
        fs::write(&path, "short").expect("a file");
        let second = kept(&path).expect("a token");
        assert!(second != first && kept(&path).expect("a token") == second);
    }

    #[cfg(unix)]
    #[test]
    fn tokens_that_others_can_read_are_replaced() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("view-8000");
        let first = kept(&path).expect("a token");
        let mode = || path.metadata().expect("a file").permissions().mode() & 0o777;
        assert_eq!(mode(), 0o600);
        fs::set_permissions(&path, PermissionsExt::from_mode(0o644)).expect("a mode");
        assert_ne!(kept(&path).expect("a token"), first);
        assert_eq!(mode(), 0o600);
    }
}
