//! Splitting of renders over several machines, and merging of their parts.
//!
//! Samples of a pixel are added up without rounding (see [`crate::film`]), and each sample is a
//! function of the settings and of its index. So each machine can render an [`ImagePart`] and save its
//! sums in a file; merged in any order, they give the same bytes as one render of the whole.

mod cover;
mod merge;

pub use cover::uncovered_parts;
pub use merge::{Merge, MergeError};

use crate::render::ImagePart;
use std::fmt;
use std::num::NonZeroU32;
use std::ops::Range;
use std::str::FromStr;

/// The way to split an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Each part has some of the samples of every pixel: all parts take about the same time.
    Samples,
    /// Each part has all samples of some adjacent tiles: the memory of a part is that of its tiles, and
    /// its time depends on the content of its tiles.
    Tiles,
}

/// One of several parts of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    number: u32,
    count: NonZeroU32,
}

/// Reasons why a render cannot be split as requested.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SplitError {
    /// There are more parts than samples.
    #[error("{count} parts are more than the {samples} samples of a pixel; {suggestion}", suggestion = suggestion(*.samples, *.tiles, *.count))]
    Samples {
        /// Requested number of parts.
        count: u32,
        /// Samples per pixel.
        samples: u32,
        /// Tiles of the region.
        tiles: u32,
    },
    /// There are more parts than tiles.
    #[error("{count} parts are more than the {tiles} tiles of 16 x 16 pixels; {suggestion}", suggestion = suggestion(*.samples, *.tiles, *.count))]
    Tiles {
        /// Requested number of parts.
        count: u32,
        /// Samples per pixel.
        samples: u32,
        /// Tiles of the region.
        tiles: u32,
    },
}

/// Minimum number of samples per pixel for which adding up and writing the sums of all pixels takes
/// less than a thirtieth of the time of a part by samples.
const MIN_SAMPLES: u32 = 16;

/// Returns an alternative that works.
fn suggestion(samples: u32, tiles: u32, count: u32) -> String {
    if samples >= count {
        return "split it by samples".to_owned();
    }
    if tiles >= count {
        return "split it by tiles".to_owned();
    }
    format!("ask for {} parts or fewer", samples.max(tiles))
}

impl Part {
    /// Returns part `number` of `count`, from 1; `None` if it does not exist.
    pub fn new(number: u32, count: u32) -> Option<Self> {
        let count = NonZeroU32::new(count)?;
        (1..=count.get()).contains(&number).then_some(Self { number, count })
    }

    /// Returns the number of this part, 1..=[`Part::count`].
    pub fn number(self) -> u32 {
        self.number
    }

    /// Returns the number of parts.
    pub fn count(self) -> u32 {
        self.count.get()
    }

    /// Returns its part of the image: no two parts overlap, and all together cover the image. The
    /// default of `split` is by samples if every part has at least 16 of each pixel or there are fewer
    /// tiles than parts, and by tiles otherwise.
    ///
    /// # Errors
    /// There are fewer samples, or tiles, than parts.
    pub fn of_image(
        self,
        whole: &ImagePart,
        split: Option<Split>,
    ) -> Result<ImagePart, SplitError> {
        let (count, samples, tiles) = (self.count(), whole.samples.end, whole.tiles.end);
        let few = samples < count.saturating_mul(MIN_SAMPLES);
        let default = if few && tiles >= count { Split::Tiles } else { Split::Samples };
        match split.unwrap_or(default) {
            Split::Samples if samples < count => Err(SplitError::Samples { count, samples, tiles }),
            Split::Tiles if tiles < count => Err(SplitError::Tiles { count, samples, tiles }),
            Split::Samples => Ok(ImagePart { samples: self.of(samples), ..whole.clone() }),
            Split::Tiles => Ok(ImagePart { tiles: self.of(tiles), ..whole.clone() }),
        }
    }

    /// Returns its range of `total` items.
    pub fn of(self, total: u32) -> Range<u32> {
        let end = |number: u32| u64::from(total) * u64::from(number) / u64::from(self.count());
        // Neither is more than the total.
        end(self.number - 1) as u32..end(self.number) as u32
    }
}

/// Formats a part for [`Part::from_str`].
impl fmt::Display for Part {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.number, self.count)
    }
}

/// Parses `K/N`.
impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let read = || {
            let (number, count) = text.split_once('/')?;
            Self::new(number.parse().ok()?, count.parse().ok()?)
        };
        read().ok_or_else(|| {
            "expected K/N, a part from 1 to N and the number N of parts, as in 3/8".to_owned()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_renders_are_split_by_tiles() {
        let image_part = |samples, tiles, count| {
            let part = Part::new(1, count).expect("it is one of them");
            part.of_image(&ImagePart { samples: 0..samples, tiles: 0..tiles }, None)
        };
        let by_tiles = |samples, tiles, count| {
            let part = image_part(samples, tiles, count).expect("there are enough");
            part.samples == (0..samples)
        };
        assert!(by_tiles(64, 300, 64) && by_tiles(63, 64, 4));
        assert!(!by_tiles(64, 300, 4) && !by_tiles(1024, 300, 64) && !by_tiles(64, 63, 64));
        assert!(matches!(image_part(3, 3, 4), Err(SplitError::Samples { .. })));
    }

    #[test]
    fn parts_cover_the_image_once() {
        let whole = ImagePart { samples: 0..70, tiles: 0..129 };
        for count in [1, 2, 3, 7, 64, 70] {
            for split in [None, Some(Split::Samples), Some(Split::Tiles)] {
                let part = |number| Part::new(number, count).expect("it is one of them");
                let parts: Vec<ImagePart> = (1..=count)
                    .map(|number| part(number).of_image(&whole, split).expect("there are enough"))
                    .collect();
                assert!(parts.iter().all(|part| part.size() > 0));
                assert_eq!(parts.iter().map(ImagePart::size).sum::<u64>(), whole.size());
                assert_eq!(uncovered_parts(&whole, &parts), []);
            }
        }
    }

    #[test]
    fn impossible_splits_are_refused_with_a_suggestion() {
        let whole = ImagePart { samples: 0..16, tiles: 0..40 };
        let part = |count| Part::new(count, count).expect("the last one");
        let by =
            |count, split| part(count).of_image(&whole, split).map_err(|error| error.to_string());
        assert_eq!(by(40, None).map(|part| part.tiles), Ok(39..40));
        assert_eq!(by(16, Some(Split::Samples)).map(|part| part.samples), Ok(15..16));
        let samples = "40 parts are more than the 16 samples of a pixel; split it by tiles";
        assert_eq!(by(40, Some(Split::Samples)), Err(samples.to_owned()));
        let both = "41 parts are more than the 16 samples of a pixel; ask for 40 parts or fewer";
        assert_eq!(by(41, None), Err(both.to_owned()));
        let flat = ImagePart { samples: 0..16, tiles: 0..1 };
        let tiles = part(2).of_image(&flat, Some(Split::Tiles)).map_err(|error| error.to_string());
        let expected = "2 parts are more than the 1 tiles of 16 x 16 pixels; split it by samples";
        assert_eq!(tiles, Err(expected.to_owned()));
    }

    #[test]
    fn parts_are_read_and_written() {
        for text in ["1/1", "3/8", "4294967295/4294967295"] {
            assert_eq!(text.parse().map(|part: Part| part.to_string()), Ok(text.to_owned()));
        }
        for text in ["0/1", "2/1", "1", "1/0", "/", "-1/3", "1/2/3", "a/b", ""] {
            assert!(text.parse::<Part>().is_err(), "{text}");
        }
    }
}
