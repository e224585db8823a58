//! A camera for sets of spheres, and random directions from visible points.

use glam::{Vec2, Vec3};
use spherule_render::sampling::{Basis, cosine_hemisphere, mix, stream, unit_pair};

/// Direction toward a distant light; not of unit length.
pub const LIGHT: Vec3 = Vec3::new(0.5, 1.0, 0.3);

/// A pinhole camera that fits a scene into a square image, seen from a corner or from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    eye: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    /// Center of the image plane at distance 1.
    center: Vec2,
    /// Half of the image's side at distance 1.
    half: f32,
}

impl View {
    /// Frames spheres, in columns of x, y, z and radius with at least one row; `flat` ones from above.
    pub fn new(columns: [&[f32]; 4], flat: bool) -> Self {
        let (low, high) = extent(columns);
        let (middle, size) = ((low + high) / 2.0, (high - low).length());
        let toward = if flat { [0.0, -1.0, -0.4] } else { [-0.5, -0.6, -0.6] };
        let forward = Vec3::from(toward).normalize();
        let right = forward.cross(Vec3::Y).normalize();
        let up = right.cross(forward);
        let eye = middle - forward * (1.5 * size);
        let corners = (0..8).map(|corner| {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
            let to = Vec3::new(pick(0), pick(1), pick(2)) - eye;
            Vec2::new(to.dot(right), to.dot(up)) / to.dot(forward)
        });
        let none = (Vec2::INFINITY, Vec2::NEG_INFINITY);
        let (least, greatest) = corners.fold(none, |(low, high), at| (low.min(at), high.max(at)));
        let (center, half) = ((least + greatest) / 2.0, (greatest - least).max_element() / 2.0);
        Self { eye, forward, right, up, center, half }
    }

    /// Returns origin and unit direction of the ray through the center of a pixel (column and row) of an
    /// image with `side` x `side` pixels.
    pub fn ray(&self, pixel: (u32, u32), side: u32) -> (Vec3, Vec3) {
        let across = |pixel: u32| (pixel as f32 + 0.5) / side as f32 * 2.0 - 1.0;
        let at = self.center + Vec2::new(across(pixel.0), -across(pixel.1)) * self.half;
        (self.eye, (self.forward + self.right * at.x + self.up * at.y).normalize())
    }

    /// Returns column and row of pixel `i`, in an order of 4 x 4 blocks; `side` is a multiple of 4.
    pub fn in_blocks(i: u32, side: u32) -> (u32, u32) {
        let (block, inside) = (i / 16, i % 16);
        (block % (side / 4) * 4 + inside % 4, block / (side / 4) * 4 + inside / 4)
    }
}

/// Returns a cosine-distributed unit direction above a surface, the one with index `row` for `seed`.
pub fn above(normal: Vec3, seed: u64, row: u64) -> Vec3 {
    let u = unit_pair(stream(mix(seed), row));
    Basis::new(normal).to_world(cosine_hemisphere(u)).normalize()
}

/// Returns the corners of a box that contains the middle 98 percent of the centers on each axis,
/// enlarged by 5 percent and the median radius. Outliers of a cloud may lie outside.
fn extent([x, y, z, radius]: [&[f32]; 4]) -> (Vec3, Vec3) {
    let percentile = |column: &[f32], fraction: f64| {
        let mut values = column.to_vec();
        let at = ((values.len() - 1) as f64 * fraction) as usize;
        *values.select_nth_unstable_by(at, f32::total_cmp).1
    };
    let corner = |fraction| Vec3::from([x, y, z].map(|column| percentile(column, fraction)));
    let (low, high) = (corner(0.01), corner(0.99));
    let margin = (high - low) * 0.025 + percentile(radius, 0.5);
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_have_every_pixel_once() {
        let mut pixels: Vec<_> = (0..144).map(|i| View::in_blocks(i, 12)).collect();
        assert_eq!(pixels[..6], [(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (1, 1)]);
        pixels.sort_unstable();
        pixels.dedup();
        assert_eq!((pixels.len(), pixels.last()), (144, Some(&(11, 11))));
    }

    #[test]
    fn the_box_fills_the_image() {
        let columns = [&[-1.0, 3.0][..], &[0.0, 1.0], &[2.0, 5.0], &[0.1, 0.1]];
        for flat in [false, true] {
            let view = View::new(columns, flat);
            let (low, high) = extent(columns);
            let mut edges = (Vec2::INFINITY, Vec2::NEG_INFINITY);
            for x in [low.x, high.x] {
                for y in [low.y, high.y] {
                    for z in [low.z, high.z] {
                        let to = Vec3::new(x, y, z) - view.eye;
                        let at = Vec2::new(to.dot(view.right), to.dot(view.up));
                        let at = (at / to.dot(view.forward) - view.center) / view.half;
                        edges = (edges.0.min(at), edges.1.max(at));
                    }
                }
            }
            let extent = edges.1.max(-edges.0).max_element();
            assert!((extent - 1.0).abs() < 1e-5, "{edges:?}");
        }
    }

    #[test]
    fn directions_above_are_above() {
        let normal = Vec3::new(0.6, 0.0, -0.8);
        let mean = (0..1000).map(|row| above(normal, 5, row)).sum::<Vec3>() / 1000.0;
        // The mean of the cosine is 2/3.
        assert!((mean - normal * (2.0 / 3.0)).length() < 0.05, "{mean}");
    }
}
