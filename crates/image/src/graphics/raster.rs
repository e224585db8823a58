//! Drawing over images, with the exact coverage of each pixel.

use super::font::{glyphs, outline};
use super::{Drawing, Polygon, Shape, Text};
use crate::color::Rgb;
use crate::image::Image;
use ab_glyph::{OutlineCurve, Point, point};
use ab_glyph_rasterizer::Rasterizer;
use glam::DVec2;

/// Maximum area of a shape beside that of the image, and in pixels; shapes that are larger than both are not drawn.
const MAX_SHARE: f64 = 4.0;
const MAX_AREA: f64 = 1_048_576.0;

impl Drawing {
    /// Draws over an image; shapes outside are cut off. Colors are linear like the image's: exposure
    /// and tone affect both.
    pub fn draw_over(&self, image: &mut Image) {
        for shape in &self.shapes {
            match shape {
                Shape::Polygon(Polygon { corners, color, opacity }) => {
                    let next = corners.iter().cycle().skip(1);
                    let edges = corners
                        .iter()
                        .zip(next)
                        .map(|(a, b)| OutlineCurve::Line(single(*a), single(*b)));
                    fill(image, &edges.collect::<Vec<_>>(), *color, *opacity);
                }
                Shape::Text(text) => fill(image, &curves(text), text.color, 1.0),
            }
        }
    }
}

fn single(position: DVec2) -> Point {
    point(position.x as f32, position.y as f32)
}

/// Returns the outlines of a text's glyphs, in pixels.
fn curves(text: &Text) -> Vec<OutlineCurve> {
    let (start, size) = (text.start(), text.size);
    let mut curves = Vec::new();
    for glyph in glyphs(&text.text) {
        let at = |p: Point| {
            let ems = DVec2::new(glyph.start + f64::from(p.x), -f64::from(p.y));
            single(start + ems * size)
        };
        curves.extend(outline(glyph.id).into_iter().map(|curve| match curve {
            OutlineCurve::Line(a, b) => OutlineCurve::Line(at(a), at(b)),
            OutlineCurve::Quad(a, b, c) => OutlineCurve::Quad(at(a), at(b), at(c)),
            OutlineCurve::Cubic(a, b, c, d) => OutlineCurve::Cubic(at(a), at(b), at(c), at(d)),
        }));
    }
    curves
}

/// Returns the points that determine a curve; the curve is in their convex hull.
fn points(curve: &OutlineCurve) -> impl Iterator<Item = Point> {
    let points = match *curve {
        OutlineCurve::Line(a, b) => [a, a, b, b],
        OutlineCurve::Quad(a, b, c) => [a, b, b, c],
        OutlineCurve::Cubic(a, b, c, d) => [a, b, c, d],
    };
    points.into_iter()
}

/// Fills the area inside closed curves.
fn fill(image: &mut Image, curves: &[OutlineCurve], color: Rgb, opacity: f32) {
    let all = || curves.iter().flat_map(points);
    let low = all().fold(DVec2::INFINITY, |low, p| low.min(DVec2::new(p.x.into(), p.y.into())));
    let high =
        all().fold(DVec2::NEG_INFINITY, |high, p| high.max(DVec2::new(p.x.into(), p.y.into())));
    let (low, high) = (low.floor(), high.ceil());
    let size = high - low;
    let picture = DVec2::new(image.width.into(), image.height.into());
    let within = high.cmpgt(DVec2::ZERO).all() && low.cmplt(picture).all();
    let most = MAX_AREA.max(MAX_SHARE * picture.element_product());
    if !(within && size.min_element() > 0.0 && size.element_product() < most) {
        return;
    }
    if !(color.is_finite() && (0.0..=1.0).contains(&opacity)) {
        return;
    }
    let local = |p: Point| point(p.x - low.x as f32, p.y - low.y as f32);
    let mut raster = Rasterizer::new(size.x as usize, size.y as usize);
    for curve in curves {
        match *curve {
            OutlineCurve::Line(a, b) => raster.draw_line(local(a), local(b)),
            OutlineCurve::Quad(a, b, c) => raster.draw_quad(local(a), local(b), local(c)),
            OutlineCurve::Cubic(a, b, c, d) => {
                raster.draw_cubic(local(a), local(b), local(c), local(d));
            }
        }
    }
    let color = color.to_array();
    let (width, height) = (i64::from(image.width), i64::from(image.height));
    raster.for_each_pixel_2d(|x, y, covered| {
        let (x, y) = (low.x as i64 + i64::from(x), low.y as i64 + i64::from(y));
        if covered > 0.0 && (0..width).contains(&x) && (0..height).contains(&y) {
            let cover = covered.min(1.0) * opacity;
            let pixel = &mut image.pixels[(y * width + x) as usize];
            *pixel = std::array::from_fn(|i| pixel[i] + (color[i] - pixel[i]) * cover);
        }
    });
}
