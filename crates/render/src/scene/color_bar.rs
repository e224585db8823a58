//! The color bar in a picture.

use crate::color::Scale;

/// A color bar in a corner of the picture: the colors of a scale, with their numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorBar {
    /// Map from numbers to colors.
    pub scale: Scale,
    /// Label, such as the quantity and its unit.
    pub label: String,
    /// Position of the color bar.
    pub corner: Corner,
}

/// A corner of a picture; the default is at the bottom right.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Corner {
    /// At the top instead of the bottom.
    pub top: bool,
    /// At the left instead of the right.
    pub left: bool,
}

impl Corner {
    /// All corners, with their names in scene files and options.
    pub const ALL: [(&'static str, Self); 4] = [
        ("bottom-right", Self { top: false, left: false }),
        ("bottom-left", Self { top: false, left: true }),
        ("top-right", Self { top: true, left: false }),
        ("top-left", Self { top: true, left: true }),
    ];

    /// Returns the corner with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(own, _)| *own == name).map(|(_, corner)| *corner)
    }

    /// Returns the name in scene files and options.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, corner)| *corner == self).map_or("", |(name, _)| name)
    }
}
