//! Contours: lines at silhouettes of spheres and where spheres meet.

use super::{Overlay, PIXELS, blend};
use crate::image::Image;
use crate::layers::{Features, NOTHING};
use glam::Vec3;
use rayon::prelude::*;

/// Minimum difference of the depths of two spheres for a silhouette between them, as a fraction of the
/// scene's depth range.
const JUMP: f64 = 0.02;

/// Range of 1 - cosine of the angle between normals over which a crease becomes a line.
const CREASE: [f32; 2] = [0.1, 0.8];

/// Darkness of a crease relative to a silhouette.
const CREASE_STRENGTH: f32 = 0.7;

/// Compensates for the smoothing of a line of one pixel.
const GAIN: f32 = 1.8;

impl Overlay<'_> {
    /// Draws silhouettes, and weaker the creases where spheres meet, from ids, normals and depths of
    /// the layers: about two pixels wide, inside of the nearer sphere.
    pub fn draw_contours(&self, image: &mut Image, color: [f32; 3]) {
        let (width, height) = (self.layers.width as usize, self.layers.height as usize);
        let [near, far] = self.depths();
        let jump = JUMP * (far - near);
        let pixels = &self.layers.pixels;
        let mark = |row: usize| {
            let right = (!(row + 1).is_multiple_of(width)).then_some(row + 1);
            let below = (row + width < pixels.len()).then_some(row + width);
            let (left, above) = ((row % width).min(1), (row / width).min(1) * width);
            // In each pair one pixel is nearer; of equal depths, the left or upper one.
            let after = right.into_iter().chain(below);
            let after = after.filter(|&other| nearer(&pixels[row], &pixels[other]));
            let before = [row - left, row - above].into_iter().filter(|&other| other != row);
            let before = before.filter(|&other| !nearer(&pixels[other], &pixels[row]));
            let others = after.chain(before);
            others.map(|other| strength(&pixels[row], &pixels[other], jump)).fold(0.0, f32::max)
        };
        let rows = (0..pixels.len()).into_par_iter().with_min_len(PIXELS);
        let marks: Vec<f32> = rows.map(mark).collect();
        blend(image, &smooth(&marks, width, height), color);
    }
}

/// Returns whether a line between two pixels is drawn in the first.
fn nearer(a: &Features, b: &Features) -> bool {
    a.depth <= b.depth
}

/// Returns the strength of the line between two pixels, 0..=1.
fn strength(a: &Features, b: &Features, jump: f64) -> f32 {
    if a.id == b.id {
        return 0.0;
    }
    let apart = f64::from((a.depth - b.depth).abs()) > jump;
    if a.id == NOTHING || b.id == NOTHING || apart {
        return 1.0;
    }
    let normal = |pixel: &Features| Vec3::from(pixel.normal).normalize_or_zero();
    let [low, high] = CREASE;
    let turn = (1.0 - normal(a).dot(normal(b)) - low) / (high - low);
    CREASE_STRENGTH * turn.clamp(0.0, 1.0)
}

/// Smooths marks by a binomial filter of 3 x 3 pixels.
fn smooth(marks: &[f32], width: usize, height: usize) -> Vec<f32> {
    let at = |x: usize, y: usize| marks[y * width + x];
    let across = |x: usize, y: usize| {
        (at(x.saturating_sub(1), y) + 2.0 * at(x, y) + at((x + 1).min(width - 1), y)) / 4.0
    };
    let value = |row: usize| {
        let (x, y) = (row % width, row / width);
        let beside = across(x, y.saturating_sub(1)) + across(x, (y + 1).min(height - 1));
        (GAIN * (beside + 2.0 * across(x, y)) / 4.0).min(1.0)
    };
    (0..marks.len()).into_par_iter().with_min_len(PIXELS).map(value).collect()
}
