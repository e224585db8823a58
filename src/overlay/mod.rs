//! What is drawn over a finished picture: thin lines at the places in the scene where they belong,
//! contours of spheres, a fog, another background or none.
//!
//! Lines have no thickness in the scene, so no ray is traced for them. They are projected through
//! the camera, drawn in pixels with smooth edges, and hidden by what the [layers](crate::layers) say
//! is nearer. Their places are in the scene's own coordinates.

mod contours;
mod lines;
mod look;
mod matte;
mod range;
mod shadow;
mod sky;

pub use lines::{Line, Pen};
pub use matte::{Matte, draw_alpha, draw_over};
pub use range::{Runs, depths};
pub use shadow::{Ground, GroundRender, ground};

use crate::film::Region;
use crate::image::Image;
use crate::layers::Layers;
use crate::world::World;
use rayon::prelude::*;

/// A rendered picture, or a region of one, that is drawn over.
#[derive(Clone, Copy, Debug)]
pub struct Overlay<'a> {
    /// The world that was rendered.
    pub world: &'a World,
    /// The part of the picture that there is.
    pub region: Region,
    /// What its pixels see: at least [`Layer::Depth`](crate::layers::Layer::Depth).
    pub layers: &'a Layers,
    /// What [`depths`] says of the world, if it is known already.
    pub depths: Option<[f64; 2]>,
}

/// Pixels that a thread takes at once.
const PIXELS: usize = 1 << 12;

impl Overlay<'_> {
    /// Between which distances from the camera all spheres are, in the scene's unit.
    fn depths(&self) -> [f64; 2] {
        self.depths.unwrap_or_else(|| depths(self.world))
    }
}

/// Blends `color` over a picture, by its share of each pixel, 0..=1.
fn blend(image: &mut Image, shares: &[f32], color: [f32; 3]) {
    let pixels = image.pixels.par_iter_mut().zip(shares).with_min_len(PIXELS);
    pixels.for_each(|(pixel, &share)| {
        if share > 0.0 {
            let over = |(old, new): (f32, f32)| old + (new - old) * share;
            *pixel = std::array::from_fn(|channel| over((pixel[channel], color[channel])));
        }
    });
}
