//! Vector graphics: filled polygons and text, drawn over images or written to SVG and PDF files.
//!
//! A [`Drawing`] is a list of shapes in pixels, from the top left corner. Over an image, each pixel gets
//! the exact fraction of its area that a shape covers. The font is included in the program, since the
//! system may have none.

mod font;
mod html;
mod marks;
mod page;
mod pdf;
mod raster;
mod svg;

pub use font::{CAP_HEIGHT, X_HEIGHT, text_width};
pub use html::Figure;
pub use marks::{marked_width, unmarked};
pub use page::{Format, Page, PageError};
pub use svg::base64;

use crate::color::Rgb;
use crate::elementary::{cos, sin};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Number of corners of a disc.
const DISC: u32 = 48;

/// Shapes in the order in which they are drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Drawing {
    shapes: Vec<Shape>,
}

/// A shape of one color.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Shape {
    Polygon(Polygon),
    Text(Text),
}

/// A filled polygon.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Polygon {
    corners: Vec<DVec2>,
    /// Linear color.
    color: Rgb,
    /// 0..=1.
    opacity: f32,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Text {
    /// The characters; those that the font lacks are boxes.
    pub text: String,
    /// Position on the baseline.
    pub position: DVec2,
    /// The part of the text that is at the position.
    pub align: Align,
    /// Size of the em square in pixels.
    pub size: f64,
    /// Linear color.
    pub color: Rgb,
}

/// Horizontal alignment of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Align {
    /// The text begins at its position.
    #[default]
    Start,
    /// The text is centered at its position.
    Middle,
    /// The text ends at its position.
    End,
}

impl Text {
    /// Returns the position of the text's beginning.
    fn start(&self) -> DVec2 {
        self.start_of(text_width(&self.text, self.size))
    }

    /// Returns the position of the beginning of a text of this width.
    fn start_of(&self, width: f64) -> DVec2 {
        let before = match self.align {
            Align::Start => 0.0,
            Align::Middle => 0.5,
            Align::End => 1.0,
        };
        self.position - DVec2::X * (before * width)
    }
}

impl Drawing {
    /// Adds a rectangle between its top left and its bottom right corner.
    pub fn rectangle(&mut self, low: DVec2, high: DVec2, color: Rgb) {
        self.translucent_rectangle(low, high, color, 1.0);
    }

    /// Adds a rectangle with an opacity of 0 to 1.
    pub fn translucent_rectangle(&mut self, low: DVec2, high: DVec2, color: Rgb, opacity: f32) {
        let corners = vec![low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        self.shapes.push(Shape::Polygon(Polygon { corners, color, opacity }));
    }

    /// Adds a polygon, which does not intersect itself.
    pub fn polygon(&mut self, corners: &[DVec2], color: Rgb) {
        let corners = corners.to_vec();
        self.shapes.push(Shape::Polygon(Polygon { corners, color, opacity: 1.0 }));
    }

    /// Adds a straight line of this width, with flat ends; nothing if it has no length.
    pub fn line(&mut self, [from, to]: [DVec2; 2], width: f64, color: Rgb) {
        let Some(along) = (to - from).try_normalize() else { return };
        let side = along.perp() * (width / 2.0);
        self.polygon(&[from + side, to + side, to - side, from - side], color);
    }

    /// Adds a disc.
    pub fn disc(&mut self, center: DVec2, radius: f64, color: Rgb) {
        let angle = |index: u32| TAU * f64::from(index) / f64::from(DISC);
        let corner = |index| center + DVec2::new(cos(angle(index)), sin(angle(index))) * radius;
        self.polygon(&(0..DISC).map(corner).collect::<Vec<_>>(), color);
    }

    /// Adds straight lines of this width from point to point, with flat ends and round corners.
    pub fn path(&mut self, points: &[DVec2], width: f64, color: Rgb) {
        points.windows(2).for_each(|ends| self.line([ends[0], ends[1]], width, color));
        points.windows(3).for_each(|points| self.disc(points[1], width / 2.0, color));
    }

    /// Adds a line of text.
    pub fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }

    /// Adds the shapes of another drawing, moved by an offset.
    pub fn append(&mut self, other: Self, offset: DVec2) {
        self.shapes.extend(other.shapes.into_iter().map(|shape| match shape {
            Shape::Polygon(mut polygon) => {
                polygon.corners.iter_mut().for_each(|corner| *corner += offset);
                Shape::Polygon(polygon)
            }
            Shape::Text(text) => Shape::Text(Text { position: text.position + offset, ..text }),
        }));
    }

    /// Returns the drawing in bytes, for [`Drawing::from_bytes`] of the same version of this library; none if it is
    /// empty.
    #[expect(clippy::missing_panics_doc, reason = "vectors take all bytes")]
    pub fn to_bytes(&self) -> Vec<u8> {
        if self.is_empty() {
            return Vec::new();
        }
        postcard::to_stdvec(self).expect("vectors take all bytes")
    }

    /// Returns the drawing of these bytes; `None` if they are not one.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        if bytes.is_empty() { Some(Self::default()) } else { postcard::from_bytes(bytes).ok() }
    }

    /// Returns whether there are no shapes.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }
}

#[cfg(test)]
mod tests;
