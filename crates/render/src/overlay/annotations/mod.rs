//! Annotations of an image: their layout at its edges or at points of the scene, and their drawing.
//!
//! ```text
//! annotations -> blocks, one for each               block, tripod, color_bar
//!             -> stacks at corners and edges        layout
//!             -> insets that a fitted camera leaves free, or backing panels over spheres
//! labels and measures at points of the scene        marks
//!             -> one Drawing                        graphics
//! ```
//!
//! All sizes are in proportion to the letters, whose size is relative to the image's smaller side, or a length on
//! paper.

mod block;
mod layout;
mod marks;
mod tripod;

pub use block::Block;

use self::layout::Layout;
use crate::color::Rgb;
use crate::graphics::Drawing;
use crate::scene::{Annotations, Background, Insets, Look, Pose, Scene};
use crate::world::{World, framing};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::num::NonZeroU16;

/// Opacity of a light and of a dark panel behind annotations that cover spheres. Blending is linear, where
/// what is bright shows through more.
const LIGHT_PANEL: f32 = 0.8;
const DARK_PANEL: f32 = 0.93;

/// Luminance of a background below which letters are light.
const DARK: f32 = 0.2;

/// Light gray, for letters on dark backgrounds.
const LIGHT_INK: Rgb = Rgb::splat(0.8);

/// The properties of the camera that annotations show.
#[derive(Clone, Copy, Debug)]
struct Viewpoint {
    /// Unit axes of the image: to the right, upward, and into the scene.
    axes: [DVec3; 3],
    /// Edge of a pixel at the depth of the target, in the scene's unit; `None` if it is not known yet.
    pixel: Option<f64>,
    /// True if the camera turns from image to image, and axes need room for all directions.
    turns: bool,
}

/// Returns the insets that a fitted camera needs so that annotations cover no sphere: none without
/// annotations, for a camera that is not fitted, or if annotations take too much of the image.
///
/// `turns` is true if the camera turns from image to image.
pub fn insets(scene: &Scene, turns: bool) -> Insets {
    let fitted = matches!(scene.camera.pose, Pose::Fit { .. });
    let axes = framing::picture_axes(&scene.camera);
    let Some(axes) = axes.filter(|_| fitted && !scene.annotations.is_empty()) else {
        return Insets::default();
    };
    let view = Viewpoint { axes, pixel: None, turns };
    let size = (scene.settings.width, scene.settings.height);
    let letter = scene.annotations.lettering.pixels(size.0.min(size.1), scene.settings.dpi);
    let layout = Layout::new(&scene.annotations, size, letter, &view, Rgb::ZERO);
    layout.insets().unwrap_or_default()
}

/// Annotations of an image, and whether all of them have room.
#[derive(Clone, Debug)]
pub struct AnnotationDrawing {
    /// The drawing, in pixels of the whole image.
    pub drawing: Drawing,
    /// False if annotations overlap one another or the image's edge although their letters are as
    /// small as they may be.
    pub fits: bool,
}

/// Draws the annotations of an image of a world, which may have a `resolution` in pixels per inch. Those that cover a sphere get a panel behind them.
pub fn draw(
    annotations: &Annotations,
    world: &World,
    look: &Look,
    resolution: Option<NonZeroU16>,
    turns: bool,
) -> AnnotationDrawing {
    let camera = &world.camera;
    let pixel = Some(camera.pixel_at_target() / world.transform.scale);
    let view = Viewpoint { axes: camera.axes(), pixel, turns };
    let ink = annotations.lettering.color.unwrap_or_else(|| ink(world, look));
    let size = (camera.width, camera.height);
    let letter = annotations.lettering.pixels(size.0.min(size.1), resolution);
    let layout = Layout::new(annotations, size, letter, &view, ink);
    let paper = paper(look, ink);
    let opacity = if paper.max_element() < DARK { DARK_PANEL } else { LIGHT_PANEL };
    let mut drawing = Drawing::default();
    let pen = marks::Pen { letter, ink, paper, opacity };
    marks::draw(&mut drawing, annotations, world, pen);
    for (low, high) in layout.panels() {
        if covers_sphere(world, low, high) {
            drawing.translucent_rectangle(low, high, paper, opacity);
        }
    }
    let fits = layout.fits;
    drawing.append(layout.into_drawing(), DVec2::ZERO);
    AnnotationDrawing { drawing, fits }
}

/// Returns a color for letters that contrasts with the background: with its color, or else with the sky
/// in the corners of the image.
fn ink(world: &World, look: &Look) -> Rgb {
    if look.background != Background::Sky {
        return look.ink();
    }
    let (width, height) = (f64::from(world.camera.width), f64::from(world.camera.height));
    let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
    let radiance = |corner: [f64; 2]| {
        let (_, direction) = world.camera.rays::<f64>(corner, None);
        let toward = DVec3::new(direction.x, direction.y, direction.z).as_vec3();
        world.environment.radiance(toward).max_element()
    };
    let mean = corners.map(radiance).iter().sum::<f32>() / 4.0;
    if mean < DARK { LIGHT_INK } else { look.ink() }
}

/// Returns the color of panels: that of the background, or else white or black behind these letters.
fn paper(look: &Look, ink: Rgb) -> Rgb {
    match look.background {
        Background::Color(color) => color,
        _ if ink.max_element() > 0.5 => Rgb::ZERO,
        _ => Rgb::ONE,
    }
}

/// Returns whether a ray through a rectangle of the image hits a sphere.
fn covers_sphere(world: &World, low: DVec2, high: DVec2) -> bool {
    let rows = (0..world.spheres.len()).into_par_iter().with_min_len(1 << 12);
    rows.into_par_iter().any(|row| world.camera.coverage(world.spheres.exact(row), low, high) > 0.0)
}

#[cfg(test)]
mod tests;
