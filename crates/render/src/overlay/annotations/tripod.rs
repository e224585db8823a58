//! Axis tripods: three arrows that show directions in the image.

use super::Viewpoint;
use super::block::Block;
use crate::color::{Rgb, srgb};
use crate::graphics::{Align, CAP_HEIGHT, Drawing, Text, X_HEIGHT, text_width};
use crate::scene::AxisTripod;
use glam::{DVec2, DVec3};

/// Length of an arrow in the plane of the image, in ems.
const LENGTH: f64 = 2.8;

/// Distance from the tip of an arrow to the middle of its letter, in ems.
const LETTER: f64 = 0.65;

/// Width of a shaft, width and length of a head, in ems.
const SHAFT: f64 = 0.16;
const HEAD: (f64, f64) = (0.52, 0.75);

/// Length in the image, relative to the whole, below which an axis is a disc.
const SHORT: f64 = 0.2;

/// Cosine of the angle in the image below which one axis hides the letter of another.
const PARALLEL: f64 = 0.95;

/// Radius of that disc, in ems.
const DISC: f64 = 0.24;

/// Red, green and blue, on light and on dark backgrounds.
#[allow(clippy::unreadable_literal, reason = "colors read as in the sRGB hex notation")]
const COLORS: [[u32; 3]; 2] = [[0xC62828, 0x2E7D32, 0x1A55C4], [0xFF6E6E, 0x66D06E, 0x7AA7FF]];

/// An axis in the image.
struct Arrow<'a> {
    /// Direction to the right and downward; shorter if it points out of the plane.
    direction: DVec2,
    /// Direction into the scene.
    depth: f64,
    name: &'a str,
    color: Rgb,
}

impl Arrow<'_> {
    fn is_short(&self) -> bool {
        self.direction.length() < SHORT
    }
}

/// Returns whether an arrow in this direction is drawn over the letter at the tip of a shorter one.
fn covers(longer: DVec2, direction: DVec2) -> bool {
    let (first, second) = (longer.length(), direction.length());
    first > second && longer.dot(direction) > PARALLEL * first * second
}

/// Returns the block of a tripod.
pub(super) fn tripod(axes: &AxisTripod, view: &Viewpoint, size: f64, ink: Rgb) -> Block {
    let [right, up, forward] = view.axes;
    let colors = COLORS[usize::from(ink.max_element() > 0.3)].map(srgb);
    let arrow = |index: usize| {
        let axis: DVec3 = axes.directions[index].normalize_or_zero();
        let direction = DVec2::new(axis.dot(right), -axis.dot(up));
        let (depth, name) = (axis.dot(forward), axes.names[index].as_str());
        Arrow { direction, depth, name, color: colors[index] }
    };
    let mut arrows = [0, 1, 2].map(arrow);
    // The letter of an axis along the view is where no other axis is.
    let free = -arrows.iter().map(|arrow| arrow.direction).sum::<DVec2>();
    let free = free.normalize_or(DVec2::new(-1.0, 1.0).normalize());
    let all = arrows.each_ref().map(|arrow| arrow.direction);
    let letter = |arrow: &Arrow| {
        if arrow.is_short() {
            return free * (DISC + LETTER) * size;
        }
        let long = arrow.direction.length();
        let along = arrow.direction / long;
        if !all.iter().any(|other| covers(*other, arrow.direction)) {
            return along * (long * LENGTH + LETTER) * size;
        }
        // Beside the tip, where the other axes are not.
        let side = along.perp();
        let side = if all.iter().sum::<DVec2>().dot(side) > 0.0 { -side } else { side };
        (along * (long * LENGTH - HEAD.1 / 2.0) + side * LETTER) * size
    };
    let half =
        |arrow: &Arrow| DVec2::new(text_width(arrow.name, size) / 2.0, CAP_HEIGHT * size / 2.0);
    let bounds = if view.turns {
        let reach = (LENGTH + 2.0 * LETTER) * size;
        (DVec2::splat(-reach), DVec2::splat(reach))
    } else {
        let start = DVec2::splat(DISC.max(SHAFT / 2.0) * size);
        arrows.iter().fold((-start, start), |(low, high), arrow| {
            let (at, half) = (letter(arrow), half(arrow));
            (low.min(at - half), high.max(at + half))
        })
    };
    let origin = -bounds.0;
    // Far arrows first.
    arrows.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    let mut drawing = Drawing::default();
    for arrow in &arrows {
        draw(&mut drawing, arrow, origin, size);
        // Without ascenders and descenders, letters look centered at half their height.
        let low = arrow.name.chars().all(|letter| "acemnorsuvwxz".contains(letter));
        let height = if low { X_HEIGHT } else { CAP_HEIGHT };
        let position = origin + letter(arrow) + DVec2::Y * (height * size / 2.0);
        let (text, align, color) = (arrow.name.to_owned(), Align::Middle, arrow.color);
        drawing.text(Text { text, position, align, size, color });
    }
    Block { drawing, size: bounds.1 - bounds.0 }
}

fn draw(drawing: &mut Drawing, arrow: &Arrow, origin: DVec2, size: f64) {
    if arrow.is_short() {
        drawing.disc(origin, DISC * size, arrow.color);
        return;
    }
    let tip = origin + arrow.direction * LENGTH * size;
    let along = arrow.direction.normalize();
    // Foreshortened arrows have shorter heads.
    let (wide, long) = (HEAD.0 * size, HEAD.1 * size * arrow.direction.length().min(1.0));
    let neck = tip - along * long;
    drawing.line([origin, neck + along * (0.05 * size)], SHAFT * size, arrow.color);
    let side = along.perp() * (wide / 2.0);
    drawing.polygon(&[tip, neck + side, neck - side], arrow.color);
}
