//! Colors of numbers, categories and elements.
//!
//! Published colors are sRGB codes; all colors returned here are linear. A [`Scale`] maps numbers to
//! colors: a [`Range`] maps each number to a position on a [`Map`]. [`ticks`] are round numbers of a
//! range, for a color bar.

mod categories;
mod custom_map;
pub mod elements;
mod map;
mod names;
mod percentile;
mod range;
mod scale;
mod tables;
mod ticks;

pub use categories::{CATEGORIES, category};
pub use custom_map::CustomMap;
pub use map::Map;
pub use names::{names, of_name, parse};
pub use percentile::percentile;
pub use range::{Range, RangeError, Spacing};
pub use scale::Scale;
pub use spherule_particles::internals::{linear_from_srgb, srgb};
pub use ticks::{Tick, ticks};

use glam::Vec3;

/// A linear RGB triple with the primaries of sRGB: a reflectance in 0..=1, or a radiance of 0 or
/// more.
pub type Rgb = Vec3;
