//! What is drawn over a finished picture: thin lines at the places in the scene where they belong,
//! contours of spheres, a fog, another background or none.
//!
//! Lines have no thickness in the scene, so no ray is traced for them. They are projected through
//! the camera, drawn in pixels with smooth edges, and hidden by what the [layers](crate::layers) say
//! is nearer. Their places are in the scene's own coordinates.

mod contours;
mod lines;
mod matte;
mod shadow;
mod sky;

pub use lines::{Line, Pen};
pub use matte::{Matte, draw_alpha};
pub use shadow::{Ground, ground};

use crate::film::Region;
use crate::image::Image;
use crate::layers::Layers;
use crate::world::World;

/// A rendered picture, or a region of one, that is drawn over.
#[derive(Clone, Copy, Debug)]
pub struct Overlay<'a> {
    /// What was rendered.
    pub world: &'a World,
    /// The part of the picture that there is.
    pub region: Region,
    /// What its pixels see: at least [`Layer::Depth`](crate::layers::Layer::Depth).
    pub layers: &'a Layers,
}

/// Blends `color` over a picture, by its share of each pixel, 0..=1.
fn blend(image: &mut Image, shares: &[f32], color: [f32; 3]) {
    for (pixel, &share) in image.pixels.iter_mut().zip(shares) {
        if share > 0.0 {
            let over = |(old, new): (f32, f32)| old + (new - old) * share;
            *pixel = std::array::from_fn(|channel| over((pixel[channel], color[channel])));
        }
    }
}
