//! The image file: its format, and checks of its destination.

use super::failure::Failure;
use super::files::STREAM;
use super::output;
use super::write_file::check_destination;
use spherule_render::film::Region;
use spherule_render::image::{Format, ImageError};
use spherule_render::video::Container;
use std::io::{IsTerminal, stdout};
use std::path::Path;

/// The kind of an album, a file of all images of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) enum AlbumKind {
    Video(Container),
    Figure,
}

impl AlbumKind {
    /// Returns the kind for the suffix of a name; `None` for other names.
    pub(in crate::cli) fn of_suffix(path: &Path) -> Option<Self> {
        let suffix = path.extension()?.to_str()?;
        if ["html", "htm"].iter().any(|own| suffix.eq_ignore_ascii_case(own)) {
            return Some(Self::Figure);
        }
        Container::of_suffix(path).map(Self::Video)
    }

    /// Returns its name with an article.
    pub(in crate::cli) fn name(self) -> &'static str {
        match self {
            Self::Video(_) => "a video",
            Self::Figure => "a page of HTML",
        }
    }
}

/// Returns whether the image goes to standard output.
pub(super) fn is_stream(path: &Path) -> bool {
    path == Path::new(STREAM)
}

/// Returns the format of `--output-format`, or else that of the suffix; PNG for standard output.
pub(super) fn format(path: &Path, typed: Option<Format>) -> Result<Format, ImageError> {
    match typed {
        Some(format) => Ok(format),
        None if is_stream(path) => Ok(Format::Png),
        None => Format::of_suffix(path),
    }
}

/// Checks that the image can be written, without changing anything.
pub(super) fn check(path: &Path) -> Result<(), Failure> {
    if is_stream(path) {
        return Ok(());
    }
    check_destination(path)
}

/// Reserves standard output for the image if it goes there; rejects a terminal, and `--json` at the same
/// time.
pub(super) fn check_stream(command: &str, path: &Path, json: bool) -> Result<(), Failure> {
    if !is_stream(path) {
        return Ok(());
    }
    let refuse = |message| Err(Failure::usage(command, message));
    if json {
        return refuse(
            "--output - and --json both write to standard output; give --output a file name",
        );
    }
    if stdout().is_terminal() {
        return refuse(
            "--output - cannot write to a terminal; redirect standard output to a file or a pipe",
        );
    }
    output::reserve_for_picture();
    Ok(())
}

/// Rejects images that are larger than the format allows.
pub(super) fn check_size(command: &str, region: Region, format: Format) -> Result<(), Failure> {
    let most = format.largest_side();
    if region.width.max(region.height) <= most {
        return Ok(());
    }
    let message = format!(
        "{format} files have at most {most} pixels per side; use another format or a smaller --size"
    );
    Err(Failure::usage(command, message))
}
