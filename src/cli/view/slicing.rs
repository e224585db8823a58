//! Drawing of the line of the next slice, and of the side that is cut away.

use super::font::Surface;
use glam::DVec2;

/// Colors of the line and of the shading.
const LINE: u32 = 0x00FF_C040;
const SHADE: u32 = 0x0000_0000;

/// Opacity of the shading, and of its stripes.
const COVER: f32 = 0.35;
const STRIPES: f32 = 0.6;

/// Distance of stripes, width of a stripe, and half the width of the line, in pixels at a scale of 1.
const PITCH: f64 = 12.0;
const STRIPE: f64 = 2.0;
const HALF: f64 = 1.0;

/// Length of the arrow toward the side that is cut away, and of its head.
const ARROW: f64 = 36.0;
const HEAD: f64 = 10.0;

/// Draws the line between two points, an arrow to its right, and shading over the right side of the image.
/// Draws nothing if the points are equal.
pub(super) fn draw(surface: &mut Surface, [from, to]: [DVec2; 2], scale: f64) {
    let Some(along) = (to - from).try_normalize() else { return };
    let right = DVec2::new(-along.y, along.x);
    let middle = (from + to) / 2.0;
    let tip = middle + right * ARROW * scale;
    let head = [along - right, -along - right].map(|way| tip + way * (HEAD * scale / 2f64.sqrt()));
    let strokes = [[from, to], [middle, tip], [tip, head[0]], [tip, head[1]]];
    for y in 0..surface.height {
        for x in 0..surface.width {
            let place = DVec2::new(f64::from(x), f64::from(y));
            let pixel = (x as i32, y as i32);
            if (place - from).dot(right) > 0.0 {
                let stripe = (place.x + place.y).rem_euclid(PITCH * scale) < STRIPE * scale;
                surface.blend(pixel, SHADE, if stripe { STRIPES } else { COVER });
            }
            let distance = strokes.iter().map(|&stroke| to_stroke(place, stroke));
            let distance = distance.fold(f64::INFINITY, f64::min);
            let cover = (HALF * scale + 0.5 - distance).clamp(0.0, 1.0);
            if cover > 0.0 {
                surface.blend(pixel, LINE, cover as f32);
            }
        }
    }
}

/// Distance of a point from a line segment.
fn to_stroke(place: DVec2, [from, to]: [DVec2; 2]) -> f64 {
    let way = to - from;
    let along = (place - from).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
    place.distance(from + way * along.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHITE: u32 = 0x00FF_FFFF;

    fn drawn(from: (f64, f64), to: (f64, f64)) -> Vec<u32> {
        let mut pixels = vec![WHITE; 120 * 90];
        let mut surface = Surface { pixels: &mut pixels, width: 120, height: 90 };
        draw(&mut surface, [from, to].map(DVec2::from), 1.0);
        pixels
    }

    #[test]
    fn the_side_to_the_right_is_shaded() {
        let at = |pixels: &[u32], x: usize, y: usize| pixels[y * 120 + x];
        for (from, to, gone, kept) in [
            ((60.0, 80.0), (60.0, 10.0), (110, 5), (10, 85)),
            ((60.0, 10.0), (60.0, 80.0), (10, 85), (110, 5)),
            ((10.0, 45.0), (110.0, 45.0), (5, 85), (115, 5)),
            ((110.0, 45.0), (10.0, 45.0), (115, 5), (5, 85)),
        ] {
            let pixels = drawn(from, to);
            assert_eq!(at(&pixels, kept.0, kept.1), WHITE, "{from:?} {to:?}");
            assert!(at(&pixels, gone.0, gone.1) < 0x00C0_C0C0, "{from:?} {to:?}");
            assert_eq!(at(&pixels, 60, 45), LINE);
        }
    }

    #[test]
    fn the_arrow_points_to_the_removed_side() {
        let pixels = drawn((60.0, 80.0), (60.0, 10.0));
        assert_eq!(pixels[45 * 120 + 60 + 30], LINE);
        assert_ne!(pixels[45 * 120 + 60 - 30], LINE);
        assert!(drawn((3.0, 3.0), (3.0, 3.0)).iter().all(|pixel| *pixel == WHITE));
    }
}
