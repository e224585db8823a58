//! Values of `--frame`.

use spherule_render::scene::particles::FrameChoice;
use std::fmt;
use std::str::FromStr;

/// One frame or a range of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) enum FrameArg {
    One(FrameChoice),
    Many(FrameRange),
}

/// A range of frames with a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::cli) struct FrameRange {
    pub(in crate::cli) first: u64,
    /// Inclusive; `None` for the last frame of the file.
    pub(in crate::cli) last: Option<u64>,
    pub(in crate::cli) step: u64,
}

impl FrameRange {
    const ALL: Self = Self { first: 0, last: None, step: 1 };

    /// Number of frames up to `last`, inclusive.
    pub(in crate::cli) fn count_to(self, last: u64) -> u64 {
        last.checked_sub(self.first).map_or(0, |span| (span / self.step).saturating_add(1))
    }
}

/// Formats the range as the command line takes it.
impl fmt::Display for FrameRange {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, last, step } = *self;
        match last {
            Some(last) if step == 1 => write!(formatter, "{first}-{last}"),
            Some(last) => write!(formatter, "{first}..{last}..{step}"),
            None if step == 1 => write!(formatter, "{first}.."),
            None => write!(formatter, "{first}....{step}"),
        }
    }
}

impl FrameArg {
    pub(in crate::cli) fn first(self) -> FrameChoice {
        match self {
            Self::One(choice) => choice,
            Self::Many(range) => FrameChoice::Index(range.first),
        }
    }

    pub(in crate::cli) fn range(self) -> Option<FrameRange> {
        match self {
            Self::One(_) => None,
            Self::Many(range) => Some(range),
        }
    }
}

impl FromStr for FrameArg {
    type Err = String;

    /// `all`, `A-B`, `A..B`, `A..B..STEP`, `A..` or what [`FrameChoice`] is read from.
    fn from_str(text: &str) -> Result<Self, String> {
        let range = match text {
            "all" => Some(FrameRange::ALL),
            _ if text.contains("..") => dotted(text),
            _ => text.split_once('-').and_then(|(first, last)| between(first, last, "1")),
        };
        match range {
            Some(range) => Ok(Self::Many(range)),
            None => text.parse().map(Self::One).map_err(|_| {
                format!(
                    "`{text}` is not a frame or a range of frames: give first, last, a number from 0, or \
                     all, A-B or A..B..STEP, with A no more than B and STEP 1 or more"
                )
            }),
        }
    }
}

fn dotted(text: &str) -> Option<FrameRange> {
    let parts: Vec<&str> = text.split("..").collect();
    match *parts.as_slice() {
        [first, last] => between(first, last, "1"),
        [first, last, step] => between(first, last, step),
        _ => None,
    }
}

fn between(first: &str, last: &str, step: &str) -> Option<FrameRange> {
    let first = first.parse().ok()?;
    let last = if last.is_empty() { None } else { Some(last.parse().ok()?) };
    let step = step.parse().ok().filter(|&step| step > 0)?;
    last.is_none_or(|last| first <= last).then_some(FrameRange { first, last, step })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_of_frames_do_not_overflow() {
        let all = FrameRange { first: 0, last: None, step: 1 };
        assert_eq!((all.count_to(u64::MAX), all.count_to(9)), (u64::MAX, 10));
    }

    #[test]
    fn ranges_are_read() {
        let range = |first, last, step| Ok(FrameArg::Many(FrameRange { first, last, step }));
        for (text, expected) in [
            ("all", range(0, None, 1)),
            ("3-7", range(3, Some(7), 1)),
            ("3..7", range(3, Some(7), 1)),
            ("3..7..2", range(3, Some(7), 2)),
            ("3....2", range(3, None, 2)),
            ("3..", range(3, None, 1)),
            ("5", Ok(FrameArg::One(FrameChoice::Index(5)))),
            ("last", Ok(FrameArg::One(FrameChoice::Last))),
        ] {
            assert_eq!(text.parse(), expected, "{text}");
        }
        for text in ["", "-1", "7-3", "1..5..0", "..", "..3", "1..2..3..4", "all..3", "1.5"] {
            assert!(text.parse::<FrameArg>().is_err(), "{text}");
        }
    }

    #[test]
    fn steps_begin_with_the_first() {
        let range = FrameRange { first: 3, last: None, step: 4 };
        assert_eq!([2, 3, 6, 7, 12].map(|last| range.count_to(last)), [0, 1, 1, 2, 3]);
    }

    #[test]
    fn ranges_are_written_as_they_are_read() {
        for text in ["3-7", "3..7..2", "3....2", "3.."] {
            let Ok(FrameArg::Many(range)) = text.parse() else { panic!("{text} is a range") };
            assert_eq!(range.to_string(), text);
        }
    }
}
