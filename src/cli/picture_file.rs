//! Destination of a picture: a file, whose suffix is its format, or standard output.

use super::files::STREAM;
use super::{Failure, output};
use spherule::atomic::check_destination;
use spherule::film::Region;
use spherule::image::Format;
use std::io::{IsTerminal, stdout};
use std::path::Path;

/// Returns whether a picture goes to standard output.
pub(super) fn is_stream(path: &Path) -> bool {
    path == Path::new(STREAM)
}

/// Returns the format that was typed, or else that of the suffix; PNG for standard output.
pub(super) fn format(path: &Path, typed: Option<Format>) -> Result<Format, Failure> {
    match typed {
        Some(format) => Ok(format),
        None if is_stream(path) => Ok(Format::Png),
        None => Ok(Format::of_suffix(path)?),
    }
}

/// Finds out whether a picture could be written, and changes nothing.
pub(super) fn check(path: &Path) -> Result<(), Failure> {
    if is_stream(path) {
        return Ok(());
    }
    check_destination(path).map_err(|error| Failure::Write(path.to_owned(), error))
}

/// Leaves standard output to the picture if it goes there; refuses a terminal, and JSON beside the picture.
pub(super) fn check_stream(command: &str, path: &Path, json: bool) -> Result<(), Failure> {
    if !is_stream(path) {
        return Ok(());
    }
    let refuse = |message| Err(Failure::usage(command, message));
    if json {
        return refuse("--output - and --json both take standard output: give --output a name");
    }
    if stdout().is_terminal() {
        return refuse("--output - is for files and pipes, not for a terminal");
    }
    output::reserve_for_picture();
    Ok(())
}

/// Refuses pictures that are larger than files of the format can be.
pub(super) fn check_size(command: &str, region: Region, format: Format) -> Result<(), Failure> {
    let most = format.largest_side();
    if region.width.max(region.height) <= most {
        return Ok(());
    }
    let message = format!(
        "{format} files have at most {most} pixels on a side; choose another format, or a smaller \
         --size"
    );
    Err(Failure::usage(command, message))
}
