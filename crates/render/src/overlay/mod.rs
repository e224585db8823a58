//! Overlays on a finished image: lines in the scene, contours of spheres, depth cue, and removal of
//! the background.
//!
//! Lines have no thickness in the scene, so no rays are traced for them. They are projected through the
//! camera, drawn in pixels with smooth edges, and hidden by nearer objects according to the
//! [layers](crate::layers). Their coordinates are those of the scene.

#[cfg(feature = "drawing")]
pub mod annotations;
mod canvas;
#[cfg(feature = "drawing")]
pub mod color_bar;
mod contours;
mod lines;
mod look;
mod matte;
mod range;
mod shadow;
mod sky;

pub use canvas::{Canvas, settings_of_layers};
pub use lines::{Line, Pen};
pub use matte::{Matte, draw_alpha, draw_over};
pub use range::{RunBounds, depths};
pub use shadow::{GroundLayers, GroundRender, ground};

use crate::film::Region;
use crate::image::Image;
use crate::layers::Layers;
use crate::world::World;
use rayon::prelude::*;

/// A rendered image, or a region of one, with the data for overlays.
#[derive(Clone, Copy, Debug)]
pub struct Overlay<'a> {
    /// The world that was rendered.
    pub world: &'a World,
    /// The rendered region of the image.
    pub region: Region,
    /// Layers of its pixels: at least [`Layer::Depth`](crate::layers::Layer::Depth).
    pub layers: &'a Layers,
    /// The result of [`depths`], if it is known already.
    pub depths: Option<[f64; 2]>,
}

/// Minimum number of pixels per task.
const PIXELS: usize = 1 << 12;

impl Overlay<'_> {
    /// Returns the range of distances of all spheres from the camera, in the scene's unit.
    fn depths(&self) -> [f64; 2] {
        self.depths.unwrap_or_else(|| depths(self.world))
    }
}

/// Blends `color` over an image, with opacities of 0..=1 per pixel.
fn blend(image: &mut Image, opacities: &[f32], color: [f32; 3]) {
    let pixels = image.pixels.par_iter_mut().zip(opacities).with_min_len(PIXELS);
    pixels.for_each(|(pixel, &opacity)| {
        if opacity > 0.0 {
            let over = |(old, new): (f32, f32)| old + (new - old) * opacity;
            *pixel = std::array::from_fn(|channel| over((pixel[channel], color[channel])));
        }
    });
}
