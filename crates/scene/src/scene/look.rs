//! Overlays and backgrounds of a picture.

use super::Rgb;
use super::particles::Cell;

/// Dark gray, for light backgrounds.
const INK: Rgb = Rgb::splat(0.02);

/// Light gray, for backgrounds darker than `DARK`.
const LIGHT_INK: Rgb = Rgb::splat(0.6);
const DARK: f32 = 0.2;

/// Overlays, drawn after rendering by `overlay` of the renderer, and background; the default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// The backdrop, as camera rays see it; the scene's lighting does not change.
    pub background: Background,
    /// True if far objects fade into the background, or into white if it has no color.
    pub depth_cue: bool,
    /// True if lines are drawn at the silhouettes of spheres.
    pub outline: bool,
    /// A cell whose edges are drawn, hidden behind nearer spheres; its periodicity does not matter.
    pub cell: Option<Cell>,
}

/// The background that the camera sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// The environment.
    #[default]
    Sky,
    /// A radiance, linear RGB, each value 0..=1e30; in pictures of 8 or 16 bits before exposure.
    Color(Rgb),
    /// Nothing: pictures have alpha, and of a ground only shadows remain.
    Transparent,
}

impl Look {
    /// Returns whether nothing is drawn over the picture, and nothing is removed from it.
    pub fn is_plain(&self) -> bool {
        let Self { background: _, depth_cue, outline, cell } = self;
        !(*depth_cue || *outline || cell.is_some() || self.is_transparent())
    }

    /// Returns whether pictures have alpha.
    pub fn is_transparent(&self) -> bool {
        self.background == Background::Transparent
    }

    /// Returns a color in which lines and letters contrast with the background.
    pub fn ink(&self) -> Rgb {
        match self.background {
            Background::Color(color) if color.max_element() < DARK => LIGHT_INK,
            _ => INK,
        }
    }

    /// Returns the color into which far objects fade.
    pub fn haze(&self) -> Rgb {
        match self.background {
            Background::Color(color) => color,
            Background::Sky | Background::Transparent => Rgb::ONE,
        }
    }
}
