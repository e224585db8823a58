//! Writing whole output files, pipes among them.

use super::files::STREAM;
use super::{Failure, output, signals};
use spherule::atomic::write_atomically;
use std::fs;
use std::io;
use std::path::Path;

/// Writes a file as a whole, or content to a device, a pipe or standard output, which is called `-`.
///
/// A pipe's reader may never come, or stop reading: meanwhile any signal ends the program at once, and after
/// a signal only a reader that is there is written to.
pub(super) fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    if path == Path::new(STREAM) {
        signals::release();
        output::write_bytes(content);
        return Ok(());
    }
    let failed = |error: io::Error| Failure::Write(path.to_owned(), error);
    if is_special(path)
        && let Some(code) = signals::release()
    {
        return if to_reader(path, content).map_err(failed)? {
            Ok(())
        } else {
            Err(Failure::NoReader(path.to_owned(), code))
        };
    }
    write_atomically(path, |writer| writer.write_all(content)).map_err(failed)
}

/// Returns whether a path leads to a device, a pipe or the like.
fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|file| !file.is_file() && !file.is_dir())
}

/// Writes to a pipe if it has a reader, and returns whether it has; to a device in any case.
#[cfg(target_os = "linux")]
fn to_reader(path: &Path, content: &[u8]) -> io::Result<bool> {
    use rustix::fs::{Mode, OFlags, fcntl_getfl, fcntl_setfl, open};
    use rustix::io::Errno;
    use std::io::Write;
    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let pipe = match open(path, flags, Mode::empty()) {
        Ok(pipe) => pipe,
        Err(Errno::NXIO) => return Ok(false),
        Err(error) => return Err(error.into()),
    };
    fcntl_setfl(&pipe, fcntl_getfl(&pipe)? - OFlags::NONBLOCK)?;
    fs::File::from(pipe).write_all(content).map(|()| true)
}

/// Waits for a reader, where there is no way to ask for one.
#[cfg(not(target_os = "linux"))]
fn to_reader(path: &Path, content: &[u8]) -> io::Result<bool> {
    write_atomically(path, |writer| writer.write_all(content)).map(|()| true)
}
