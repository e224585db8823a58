//! Renders that are split over several machines, and merged.
//!
//! Samples of a pixel are added up without rounding (see [`crate::film`]), and which samples they are
//! is a function of the settings and of their index. So it does not matter who takes them: each
//! machine renders a [`ImagePart`], keeps its sums in a file, and all of them merged come to the same
//! bytes as one render of the whole, in any order.

mod cover;
mod merge;

pub use cover::holes;
pub use merge::{Merge, MergeError};

use crate::render::ImagePart;
use std::fmt;
use std::num::NonZeroU32;
use std::ops::Range;
use std::str::FromStr;

/// The way in which an image is split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// Each has some of the samples of every pixel: all parts take about as long.
    Samples,
    /// Each has all samples of some of the tiles, which lie side by side: parts take as little memory
    /// as their tiles, and as long as what is to be seen there.
    Tiles,
}

/// One of several parts of a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    number: u32,
    count: NonZeroU32,
}

/// The reason why a render cannot be split as asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SplitError {
    /// Parts without a sample would be of no use.
    #[error("{count} parts are more than the {samples} samples of a pixel; {mend}", mend = mend(*.samples, *.tiles, *.count))]
    Samples {
        /// Parts that were asked for.
        count: u32,
        /// Samples per pixel.
        samples: u32,
        /// Tiles of the region.
        tiles: u32,
    },
    /// Likewise without a tile.
    #[error("{count} parts are more than the {tiles} tiles of 16 x 16 pixels; {mend}", mend = mend(*.samples, *.tiles, *.count))]
    Tiles {
        /// Parts that were asked for.
        count: u32,
        /// Samples per pixel.
        samples: u32,
        /// Tiles of the region.
        tiles: u32,
    },
}

/// Samples of each pixel from which on it takes a part by samples less than a thirtieth of its time to
/// add them up and to write the sums of all pixels.
const ENOUGH: u32 = 16;

/// An alternative that would work.
fn mend(samples: u32, tiles: u32, count: u32) -> String {
    if samples >= count {
        return "split it by samples".to_owned();
    }
    if tiles >= count {
        return "split it by tiles".to_owned();
    }
    format!("ask for {} parts or fewer", samples.max(tiles))
}

impl Part {
    /// Number `number` of `count`, from 1; `None` if there is no such one.
    pub fn new(number: u32, count: u32) -> Option<Self> {
        let count = NonZeroU32::new(count)?;
        (1..=count.get()).contains(&number).then_some(Self { number, count })
    }

    /// The number of this part, 1..=[`Part::count`].
    pub fn number(self) -> u32 {
        self.number
    }

    /// The number of parts.
    pub fn count(self) -> u32 {
        self.count.get()
    }

    /// Returns its part of the image: no two parts overlap, and all together cover the image.
    /// Without a `split`, it is by samples if every part has at least 16 of each pixel or there
    /// are fewer tiles than parts, and by tiles otherwise.
    ///
    /// # Errors
    /// There are fewer samples, or tiles, than parts.
    pub fn of_image(
        self,
        whole: &ImagePart,
        split: Option<Split>,
    ) -> Result<ImagePart, SplitError> {
        let (count, samples, tiles) = (self.count(), whole.samples.end, whole.tiles.end);
        let few = samples < count.saturating_mul(ENOUGH);
        let usual = if few && tiles >= count { Split::Tiles } else { Split::Samples };
        match split.unwrap_or(usual) {
            Split::Samples if samples < count => Err(SplitError::Samples { count, samples, tiles }),
            Split::Tiles if tiles < count => Err(SplitError::Tiles { count, samples, tiles }),
            Split::Samples => Ok(ImagePart { samples: self.of(samples), ..whole.clone() }),
            Split::Tiles => Ok(ImagePart { tiles: self.of(tiles), ..whole.clone() }),
        }
    }

    /// Its part of so many things in a row.
    pub fn of(self, total: u32) -> Range<u32> {
        let end = |number: u32| u64::from(total) * u64::from(number) / u64::from(self.count());
        // Neither is more than the total.
        end(self.number - 1) as u32..end(self.number) as u32
    }
}

/// As [`Part::from_str`] reads it.
impl fmt::Display for Part {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}/{}", self.number, self.count)
    }
}

/// `K/N`.
impl FromStr for Part {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let read = || {
            let (number, count) = text.split_once('/')?;
            Self::new(number.parse().ok()?, count.parse().ok()?)
        };
        read().ok_or_else(|| {
            "give a part and how many there are, from 1/N to N/N, as in 3/8".to_owned()
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
    fn parts_have_everything_once() {
        let whole = ImagePart { samples: 0..70, tiles: 0..129 };
        for count in [1, 2, 3, 7, 64, 70] {
            for split in [None, Some(Split::Samples), Some(Split::Tiles)] {
                let part = |number| Part::new(number, count).expect("it is one of them");
                let shares: Vec<ImagePart> = (1..=count)
                    .map(|number| part(number).of_image(&whole, split).expect("there are enough"))
                    .collect();
                assert!(shares.iter().all(|share| share.size() > 0));
                assert_eq!(shares.iter().map(ImagePart::size).sum::<u64>(), whole.size());
                assert_eq!(holes(&whole, &shares), []);
            }
        }
    }

    #[test]
    fn what_cannot_be_split_is_refused_with_the_mend() {
        let whole = ImagePart { samples: 0..16, tiles: 0..40 };
        let part = |count| Part::new(count, count).expect("the last one");
        let by =
            |count, split| part(count).of_image(&whole, split).map_err(|error| error.to_string());
        assert_eq!(by(40, None).map(|share| share.tiles), Ok(39..40));
        assert_eq!(by(16, Some(Split::Samples)).map(|share| share.samples), Ok(15..16));
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
