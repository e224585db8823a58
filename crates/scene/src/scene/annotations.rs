//! Annotations of the picture: color bar, legend, axes, scale bar, labels and measures.

use super::{Measure, Rgb};
use crate::color::Scale;
use crate::settings::{self, Length};
use glam::DVec3;
use std::num::NonZeroU16;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Annotations of the picture, drawn after rendering; the default is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Annotations {
    /// The numbers that colors stand for.
    pub color_bar: Option<ColorBar>,
    /// The names that colors stand for.
    pub legend: Option<ColorLegend>,
    /// Directions of axes.
    pub axes: Option<AxisTripod>,
    /// A length in the scene's unit.
    pub scale_bar: Option<ScaleBar>,
    /// Lines of text.
    pub labels: Vec<Label>,
    /// Distances and angles between points of the scene.
    pub measures: Vec<Measure>,
    /// Size and color of letters.
    pub lettering: Lettering,
}

/// A color bar: the colors of a scale, with their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorBar {
    /// Map from numbers to colors.
    pub scale: Scale,
    /// Label, such as the quantity and its unit.
    pub label: String,
    /// Position in the picture; at the top and the bottom the bar is horizontal.
    pub position: Anchor,
}

/// A legend: colors with their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ColorLegend {
    /// Label, such as the name of the column; may be empty.
    pub label: String,
    /// Colors and names, from top to bottom.
    pub entries: Vec<(Rgb, String)>,
    /// Number of further names that the legend mentions, but does not list.
    pub omitted: u64,
    /// Position in the picture.
    pub position: Anchor,
}

/// Three arrows that show the directions of axes in the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisTripod {
    /// Directions of the axes, not zero; the arrows have equal lengths in space.
    pub directions: [DVec3; 3],
    /// Names of the axes.
    pub names: [String; 3],
    /// Position in the picture.
    pub position: Anchor,
}

/// A scale bar: a line with its length. In perspective, it holds at the depth of the camera's target,
/// which is the middle of the spheres for a fitted camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScaleBar {
    /// Length in the scene's unit, more than 0; `None` is a round length of up to a quarter of the
    /// picture's width.
    pub length: Option<f64>,
    /// Name of the scene's unit; empty if it has none.
    pub unit: String,
    /// Position in the picture.
    pub position: Anchor,
}

/// A line of text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Label {
    /// The text, which may have several lines.
    pub text: String,
    /// Position in the picture.
    pub position: Anchor,
    /// The point of the scene that the text is at, instead of a position.
    pub at: Option<DVec3>,
}

/// Size of letters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LetterSize {
    /// A fraction of the picture's smaller side, [`LetterSize::SHARES`].
    Share(f64),
    /// A length on paper, [`LetterSize::LENGTHS`].
    Length(Length),
}

/// Size and color of letters, and of the lines that belong to them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lettering {
    /// Size of the em square; `None` is 7 points in a picture with a resolution, and else 0.03 of its smaller
    /// side.
    pub size: Option<LetterSize>,
    /// Linear color; `None` contrasts with the background.
    pub color: Option<Rgb>,
}

/// A position at the picture's edge; the default is the bottom right corner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Anchor {
    /// Top left corner.
    TopLeft,
    /// Middle of the top edge.
    Top,
    /// Top right corner.
    TopRight,
    /// Middle of the left edge.
    Left,
    /// Middle of the right edge.
    Right,
    /// Bottom left corner.
    BottomLeft,
    /// Middle of the bottom edge.
    Bottom,
    /// Bottom right corner.
    #[default]
    BottomRight,
}

impl Annotations {
    /// Returns whether there are none; lettering does not count.
    pub fn is_empty(&self) -> bool {
        let Self { color_bar, legend, axes, scale_bar, labels, measures, lettering: _ } = self;
        color_bar.is_none()
            && legend.is_none()
            && axes.is_none()
            && scale_bar.is_none()
            && labels.is_empty()
            && measures.is_empty()
    }
}

impl LetterSize {
    /// Limits of fractions of the picture's smaller side.
    pub const SHARES: RangeInclusive<f64> = 0.005..=0.2;

    /// Limits of lengths.
    pub const LENGTHS: RangeInclusive<Length> = Length::points(1)..=Length::points(1000);

    /// The sizes that there are, in words.
    pub(in crate::scene) const WORDS: &'static str = "0.005 to 0.2 of the image's smaller side, or a length of 1pt to 1000pt, as in \"7pt\" or \"2.5mm\"";

    /// Returns whether it is within its limits.
    pub fn is_valid(self) -> bool {
        match self {
            Self::Share(share) => Self::SHARES.contains(&share),
            Self::Length(length) => Self::LENGTHS.contains(&length),
        }
    }
}

impl FromStr for LetterSize {
    type Err = String;

    /// Parses `0.03`, `3%`, `7pt` or `2.5mm`.
    fn from_str(text: &str) -> Result<Self, String> {
        let share = settings::share(text).map(Self::Share);
        let size = share.or_else(|| text.parse().ok().map(Self::Length));
        size.filter(|size| size.is_valid()).ok_or_else(|| format!("give {}", Self::WORDS))
    }
}

impl Lettering {
    /// Size in a picture with a resolution.
    const USUAL: Length = Length::points(7);

    /// Size in a picture without a resolution.
    const USUAL_SHARE: f64 = 0.03;

    /// Returns the size of the em square in pixels, in a picture whose smaller side has so many pixels, and with so many pixels
    /// per inch.
    pub fn pixels(&self, smaller_side: u32, resolution: Option<NonZeroU16>) -> f64 {
        let share = |share: f64| share * f64::from(smaller_side);
        match (self.size, resolution) {
            (Some(LetterSize::Share(own)), _) => share(own),
            (Some(LetterSize::Length(length)), _) => {
                length.exact_pixels(resolution.unwrap_or(Length::RESOLUTION))
            }
            (None, Some(resolution)) => Self::USUAL.exact_pixels(resolution),
            (None, None) => share(Self::USUAL_SHARE),
        }
    }
}

impl Default for AxisTripod {
    fn default() -> Self {
        Self {
            directions: DVec3::AXES,
            names: ["x", "y", "z"].map(str::to_owned),
            position: Anchor::BottomLeft,
        }
    }
}

impl Anchor {
    /// All anchors, with their names in scene files and options.
    pub const ALL: [(&'static str, Self); 8] = [
        ("top-left", Self::TopLeft),
        ("top", Self::Top),
        ("top-right", Self::TopRight),
        ("left", Self::Left),
        ("right", Self::Right),
        ("bottom-left", Self::BottomLeft),
        ("bottom", Self::Bottom),
        ("bottom-right", Self::BottomRight),
    ];

    /// Returns the anchor with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(own, _)| *own == name).map(|(_, anchor)| *anchor)
    }

    /// Returns the name in scene files and options.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, anchor)| *anchor == self).map_or("", |(name, _)| name)
    }

    /// Returns the horizontal position: 0 at the left edge, 0.5 in the middle, 1 at the right edge.
    pub fn across(self) -> f64 {
        match self {
            Self::TopLeft | Self::Left | Self::BottomLeft => 0.0,
            Self::Top | Self::Bottom => 0.5,
            Self::TopRight | Self::Right | Self::BottomRight => 1.0,
        }
    }

    /// Returns the vertical position: 0 at the top edge, 0.5 in the middle, 1 at the bottom edge.
    pub fn down(self) -> f64 {
        match self {
            Self::TopLeft | Self::Top | Self::TopRight => 0.0,
            Self::Left | Self::Right => 0.5,
            Self::BottomLeft | Self::Bottom | Self::BottomRight => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_have_names_and_positions() {
        for (name, anchor) in Anchor::ALL {
            assert_eq!((Anchor::named(name), anchor.name()), (Some(anchor), name));
            let words = [(0.0, "left"), (1.0, "right")]
                .map(|(at, word)| (anchor.across() == at) == name.contains(word));
            let rows = [(0.0, "top"), (1.0, "bottom")]
                .map(|(at, word)| (anchor.down() == at) == name.contains(word));
            assert_eq!((words, rows), ([true; 2], [true; 2]), "{name}");
        }
        assert_eq!(Anchor::named("middle"), None);
    }

    #[test]
    fn letters_are_a_share_of_the_picture_or_a_length_on_paper() {
        let pixels = |text: Option<&str>, dpi| {
            let size = text.map(|text| text.parse().expect("a size"));
            let lettering = Lettering { size, ..Lettering::default() };
            lettering.pixels(600, NonZeroU16::new(dpi))
        };
        assert_eq!(pixels(Some("5%"), 0), 30.0);
        assert_eq!(pixels(Some("0.05"), 600), 30.0);
        assert_eq!(pixels(Some("36pt"), 144), 72.0);
        assert_eq!(pixels(Some("25.4 mm"), 0), 300.0);
        assert_eq!(pixels(None, 0), 18.0);
        assert_eq!(pixels(None, 720), 70.0);
        for text in ["", "0", "0.3", "30%", "nan", "big", "0.9pt", "1001pt", "7px"] {
            assert!(text.parse::<LetterSize>().is_err(), "{text}");
        }
    }

    #[test]
    fn lettering_is_no_annotation() {
        let lettering = Lettering { size: Some(LetterSize::Share(0.1)), color: Some(Rgb::ONE) };
        assert!(Annotations { lettering, ..Annotations::default() }.is_empty());
        let labels = vec![Label::default()];
        assert!(!Annotations { labels, ..Annotations::default() }.is_empty());
    }
}
