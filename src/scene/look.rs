//! What is drawn over a picture once it is there.

use super::Rgb;
use super::particles::Cell;

/// Dark gray: on what is light.
const INK: Rgb = Rgb::splat(0.02);

/// Light gray: on what is darker than `DARK`.
const LIGHT_INK: Rgb = Rgb::splat(0.6);
const DARK: f32 = 0.2;

/// What is drawn over a picture once it is there, by [`crate::overlay`]; the default is nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// What is seen in the place of the sky, which goes on lighting the scene.
    pub background: Background,
    /// Whether what is far fades, into the background or else into white.
    pub depth_cue: bool,
    /// Whether there are lines where one sphere ends and something else begins.
    pub outline: bool,
    /// A cell whose edges are drawn, hidden where spheres are nearer; whether it repeats does not
    /// matter.
    pub cell: Option<Cell>,
}

/// What is seen in the place of the sky.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Background {
    /// The sky.
    #[default]
    Sky,
    /// A radiance, linear RGB, each value 0..=1e30; of pictures of 8 or 16 bits before exposure.
    Color(Rgb),
    /// Nothing: pictures have alpha, and of a ground only shadows are left.
    Transparent,
}

impl Look {
    /// Whether nothing is drawn.
    pub fn is_plain(&self) -> bool {
        *self == Self::default()
    }

    /// Whether pictures have alpha.
    pub fn is_transparent(&self) -> bool {
        self.background == Background::Transparent
    }

    /// A color in which lines and letters can be told from the background.
    pub fn ink(&self) -> Rgb {
        match self.background {
            Background::Color(color) if color.max_element() < DARK => LIGHT_INK,
            _ => INK,
        }
    }

    /// What far things fade into.
    pub fn haze(&self) -> Rgb {
        match self.background {
            Background::Color(color) => color,
            Background::Sky | Background::Transparent => Rgb::ONE,
        }
    }
}
