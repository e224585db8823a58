//! Plan of a sequence: the list of its images.

use crate::cli::failure::Failure;
use crate::cli::options::frames::FrameRange;
use spherule_render::scene::FileError;
use spherule_render::scene::particles::{FrameCount, ReadOptions};
use std::path::Path;

/// Minimum number of digits of a frame's number, so that names sort by frame up to 10,000.
const DIGITS: usize = 4;

/// Minimum number of digits of a turntable's image.
const TURN_DIGITS: usize = 3;

/// Frames of the sequence, in order.
pub(super) struct Frames {
    range: FrameRange,
    /// Number of the range's frames; `None` for input that can be read only once.
    count: Option<u64>,
    /// Number of complete frames of the file, if the range has no end.
    end: Option<u64>,
    /// The error after the complete frames, if there is one.
    rest: Option<FileError>,
}

/// The images of a sequence.
pub(super) struct Plan {
    frames: Option<Frames>,
    turn: Option<u32>,
}

/// An image of a sequence.
pub(super) struct Shot {
    /// Number in the file's name.
    pub(super) number: u64,
    pub(super) frame: Option<u64>,
    /// Place in the turntable.
    pub(super) turn: Option<u32>,
}

/// Returns whether input can be read only once.
pub(super) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-" || path.exists() && !path.is_file()
}

impl Frames {
    /// Counts the frames of a file, if it can be read more than once; an error if the range exceeds them.
    pub(super) fn choose(
        path: &Path,
        options: &ReadOptions,
        range: FrameRange,
    ) -> Result<Self, Failure> {
        if is_stream(path) {
            return Ok(Self { range, count: None, end: None, rest: None });
        }
        let most = range.last.map_or(u64::MAX, |last| last.saturating_add(1));
        let FrameCount { whole, rest } = FrameCount::of(path, options, most)?;
        if let Some(error) = rest.clone().filter(|error| !error.cut_off || whole == 0) {
            let help = hint(range, whole);
            let error = if error.help.is_none() { error.with_help(help) } else { error };
            return Err(Failure::from(error).of_frame(whole));
        }
        if let Some(message) = missing(range, whole) {
            return Err(refuse(path, message, hint(range, whole)));
        }
        let count = range.count_to(range.last.unwrap_or(whole - 1));
        let end = range.last.is_none().then_some(whole);
        Ok(Self { range, count: Some(count), end, rest })
    }
}

/// Returns a message if a range exceeds the frames of a file.
fn missing(range: FrameRange, whole: u64) -> Option<String> {
    if whole == 0 {
        return Some("holds no particles".to_owned());
    }
    let last = range.last.unwrap_or(range.first);
    (whole <= last).then(|| format!("has no frame {last}, only {whole} (the first is 0)"))
}

/// Formats the available frames of a range as the command line takes them.
fn hint(range: FrameRange, whole: u64) -> String {
    match whole.checked_sub(1) {
        None => "a frame may be truncated".to_owned(),
        Some(last) if range.first > last => format!("use the last one, --frame {last}"),
        Some(last) => {
            let there = FrameRange { last: Some(last), ..range };
            format!("render the existing frames with --frame {there}")
        }
    }
}

impl Plan {
    pub(super) fn new(frames: Option<Frames>, turn: Option<u32>) -> Result<Self, Failure> {
        if turn.is_some() && frames.as_ref().is_some_and(|frames| frames.count.is_none()) {
            let message = "--turntable needs the number of frames, which is unknown for input that can be \
                           read only once; write it to a file";
            return Err(Failure::usage("render", message));
        }
        Ok(Self { frames, turn })
    }

    /// Number of images, if known: those of the turntable, or else one for each frame.
    pub(super) fn count(&self) -> Option<u64> {
        self.turn.map(u64::from).or_else(|| self.frame_count())
    }

    /// Number of frames, if known.
    pub(super) fn frame_count(&self) -> Option<u64> {
        self.frames.as_ref().and_then(|frames| frames.count)
    }

    /// Returns the noun for the numbers of images.
    pub(super) fn noun(&self) -> &'static str {
        if self.turn.is_some() { "numbers" } else { "frames" }
    }

    /// Returns whether its frames can be read only once.
    pub(super) fn is_stream(&self) -> bool {
        self.frames.as_ref().is_some_and(|frames| frames.count.is_none())
    }

    /// Digits of the numbers in names.
    pub(super) fn digits(&self) -> usize {
        match self.turn {
            Some(pictures) => (pictures - 1).to_string().len().max(TURN_DIGITS),
            None => DIGITS,
        }
    }

    /// Returns an image by its place from 0. Frames are spread evenly over the images of a turntable.
    pub(super) fn shot(&self, index: u64) -> Option<Shot> {
        if self.count().is_some_and(|count| index >= count) {
            return None;
        }
        let Some(Frames { range, count, .. }) = &self.frames else {
            return Some(Shot { number: index, frame: None, turn: u32::try_from(index).ok() });
        };
        let place = match (self.turn, *count) {
            (Some(pictures), Some(count)) => {
                (u128::from(index) * u128::from(count) / u128::from(pictures)) as u64
            }
            _ => index,
        };
        let frame = range.step.checked_mul(place).and_then(|step| range.first.checked_add(step))?;
        if range.last.is_some_and(|last| frame > last) {
            return None;
        }
        let turn = self.turn.and_then(|_| u32::try_from(index).ok());
        Some(Shot { number: if turn.is_some() { index } else { frame }, frame: Some(frame), turn })
    }

    /// Returns all images.
    pub(super) fn shots(&self) -> impl Iterator<Item = Shot> + use<> {
        let shots: Vec<Shot> =
            (0..self.count().unwrap_or(0)).map_while(|index| self.shot(index)).collect();
        shots.into_iter()
    }

    /// Returns the error that comes after the frames of a range without an end.
    pub(super) fn rest(&self) -> Option<FileError> {
        let frames = self.frames.as_ref().filter(|frames| frames.end.is_some())?;
        frames.rest.clone()
    }

    /// Number of frames of the file, if the range has no end.
    pub(super) fn open_end(&self) -> Option<u64> {
        self.frames.as_ref().and_then(|frames| frames.end)
    }

    /// Checks that input that can be read only once had all frames; `passed` were read.
    pub(super) fn check_end(&self, path: &Path, passed: u64) -> Result<(), Failure> {
        let Some(Frames { range, count: None, .. }) = &self.frames else { return Ok(()) };
        // Frames after the last step were not read.
        let last = range.last.map_or(range.first, |last| {
            range.first + (last - range.first) / range.step * range.step
        });
        if passed > last {
            return Ok(());
        }
        let name = stream_name(path);
        let message = format!("{name} has no frame {last}, only {passed} (the first is 0)");
        Err(refuse(path, message, hint(*range, passed)))
    }
}

/// Returns the name of input that can be read only once, for messages.
pub(super) fn stream_name(path: &Path) -> String {
    if path.as_os_str() == "-" { "standard input".to_owned() } else { path.display().to_string() }
}

/// An error of a whole file, before anything is rendered.
fn refuse(path: &Path, message: String, help: String) -> Failure {
    FileError::whole_file(path, message).with_help(help).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(range: FrameRange, count: u64, turn: Option<u32>) -> Plan {
        let frames = Frames { range, count: Some(count), end: None, rest: None };
        Plan { frames: Some(frames), turn }
    }

    fn frames(plan: &Plan) -> Vec<u64> {
        plan.shots().filter_map(|shot| shot.frame).collect()
    }

    #[test]
    fn frames_are_spread_over_a_turn() {
        let range = FrameRange { first: 3, last: Some(12), step: 3 };
        assert_eq!(frames(&plan(range, 4, None)), [3, 6, 9, 12]);
        assert_eq!(frames(&plan(range, 4, Some(4))), [3, 6, 9, 12]);
        assert_eq!(frames(&plan(range, 4, Some(2))), [3, 9]);
        assert_eq!(frames(&plan(range, 4, Some(6))), [3, 3, 6, 9, 9, 12]);
        let turn: Vec<_> = plan(range, 4, Some(3)).shots().map(|shot| shot.turn).collect();
        assert_eq!(turn, [Some(0), Some(1), Some(2)]);
    }

    #[test]
    fn names_have_enough_digits() {
        let range = FrameRange { first: 0, last: None, step: 1 };
        let digits = |turn| plan(range, 9, turn).digits();
        assert_eq!(
            [digits(None), digits(Some(5)), digits(Some(1000)), digits(Some(1001))],
            [4, 3, 3, 4]
        );
    }

    #[test]
    fn valid_ranges_are_suggested() {
        let range = |first, last, step| FrameRange { first, last, step };
        assert_eq!(
            missing(range(15, Some(40), 1), 20).unwrap(),
            "has no frame 40, only 20 (the first is 0)"
        );
        assert!(hint(range(15, Some(40), 1), 20).ends_with("--frame 15-19"));
        assert!(hint(range(15, Some(40), 2), 20).ends_with("--frame 15..19..2"));
        assert!(hint(range(25, None, 1), 20).ends_with("--frame 19"));
        assert!(
            missing(range(20, None, 1), 20).is_some() && missing(range(19, None, 1), 20).is_none()
        );
        assert!(missing(range(0, Some(19), 1), 20).is_none());
    }
}
