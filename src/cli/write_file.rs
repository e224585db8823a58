//! Atomic writing of output files, and writing to pipes.

use super::failure::Failure;
use super::files::STREAM;
use super::{output, signals};
use spherule_render::atomic::{self, write_atomically};
use std::fs;
use std::io::{self, Write};
use std::path::Path;
#[cfg(target_os = "linux")]
use std::{thread, time::Duration};

/// Time between two checks for a reader of a pipe.
#[cfg(target_os = "linux")]
const PAUSE: Duration = Duration::from_millis(20);

/// Checks that a file can be written, without changing anything.
pub(super) fn check_destination(path: &Path) -> Result<(), Failure> {
    atomic::check_destination(path).map_err(|error| Failure::Write(path.to_owned(), error))
}

/// Writes a file atomically, or writes to a device, a pipe or standard output, whose name is `-`.
///
/// A pipe may never get a reader, or the reader may stop; a signal ends the wait.
pub(super) fn write_file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    if path == Path::new(STREAM) {
        signals::release();
        output::write_bytes(content);
        return Ok(());
    }
    let failed = |error: io::Error| Failure::Write(path.to_owned(), error);
    match open_pipe(path) {
        Some(pipe) => {
            let mut pipe = pipe?;
            signals::release();
            pipe.write_all(content).map_err(failed)
        }
        None => write_atomically(path, |writer| writer.write_all(content)).map_err(failed),
    }
}

/// Opens a pipe once it has a reader; `None` if the path is not a pipe. A signal before there is a reader is
/// an error.
#[cfg(target_os = "linux")]
fn open_pipe(path: &Path) -> Option<Result<fs::File, Failure>> {
    use rustix::fs::{Mode, OFlags, fcntl_getfl, fcntl_setfl, open};
    use rustix::io::Errno;
    use std::os::unix::fs::FileTypeExt;
    if !fs::metadata(path).is_ok_and(|file| file.file_type().is_fifo()) {
        return None;
    }
    let flags = OFlags::WRONLY | OFlags::NONBLOCK | OFlags::CLOEXEC;
    let opened = loop {
        // Without this flag, opening waits for a reader and ignores signals.
        match open(path, flags, Mode::empty()) {
            Err(Errno::NXIO) => match signals::received() {
                Some(code) => return Some(Err(Failure::NoReader(path.to_owned(), code))),
                None => thread::sleep(PAUSE),
            },
            opened => break opened,
        }
    };
    let waiting = opened.and_then(|pipe| {
        fcntl_setfl(&pipe, fcntl_getfl(&pipe)? - OFlags::NONBLOCK)?;
        Ok(fs::File::from(pipe))
    });
    Some(waiting.map_err(|error| Failure::Write(path.to_owned(), error.into())))
}

/// Leaves pipes to [`write_atomically`] on systems that cannot check for a reader.
#[cfg(not(target_os = "linux"))]
fn open_pipe(_: &Path) -> Option<Result<fs::File, Failure>> {
    signals::release();
    None
}
