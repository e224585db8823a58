//! Labels and measures at points of the scene, over all spheres: the nearest labels last, and then values of measures.

use super::block;
use crate::color::Rgb;
use crate::elementary::{atan2, cos, sin};
use crate::graphics::Drawing;
use crate::overlay::lines::clipped;
use crate::scene::{Anchor, Annotations, Label, Measure};
use crate::world::World;
use glam::{DVec2, DVec3};

/// Width of lines, and of the lighter line around them, in ems.
const LINE: f64 = 0.13;
const AROUND: f64 = 0.32;

/// Length of a dash and of a gap, in ems.
const DASH: (f64, f64) = (0.5, 0.28);

/// Radius of the arc of an angle, relative to the shorter of its lines.
const ARC: f64 = 0.35;

/// Number of lines of an arc.
const STEPS: u32 = 24;

/// Margin of a text's panel, in ems.
const MARGIN: f64 = 0.22;

/// Sizes and colors of labels and measures.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    /// Size of the em square in pixels.
    pub(super) letter: f64,
    pub(super) ink: Rgb,
    /// Color behind letters and lines, and its opacity.
    pub(super) paper: Rgb,
    pub(super) opacity: f32,
}

/// A text with its middle in the image, and its depth along the view axis.
struct Placed {
    text: String,
    middle: DVec2,
    depth: f64,
}

/// Draws the labels and measures that are at points of the scene.
pub(super) fn draw(drawing: &mut Drawing, annotations: &Annotations, world: &World, pen: Pen) {
    annotations.measures.iter().for_each(|measure| lines(drawing, measure, world, pen));
    let at_point = |label: &Label| {
        let (middle, depth) = project(world, label.at?)?;
        Some(Placed { text: label.text.clone(), middle, depth })
    };
    let mut labels: Vec<Placed> = annotations.labels.iter().filter_map(at_point).collect();
    let measures = annotations.measures.iter();
    let mut values: Vec<Placed> =
        measures.filter_map(|measure| text_of(measure, world, pen)).collect();
    for texts in [&mut labels, &mut values] {
        texts.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    }
    for Placed { text, middle, .. } in labels.into_iter().chain(values) {
        let label = Label { text, position: Anchor::Top, at: None };
        let block = block::label(&label, pen.letter, pen.ink);
        let half = block.size / 2.0 + MARGIN * pen.letter;
        let size = DVec2::new(f64::from(world.camera.width), f64::from(world.camera.height));
        if (middle + half).min_element() > 0.0 && (size - middle + half).min_element() > 0.0 {
            let corner = middle - half;
            drawing.translucent_rectangle(corner, middle + half, pen.paper, pen.opacity);
            drawing.append(block.drawing, corner + MARGIN * pen.letter);
        }
    }
}

/// Returns the place of a point in the image and its depth; `None` if it is not in front of the camera.
fn project(world: &World, point: DVec3) -> Option<(DVec2, f64)> {
    let seen = world.camera.view(world.transform.point(point));
    let [seen, _] = clipped(&world.camera, [seen, seen])?;
    Some((world.camera.pixel(seen), seen.z))
}

/// Draws the lines between the points of a measure, and the arc of an angle.
fn lines(drawing: &mut Drawing, measure: &Measure, world: &World, pen: Pen) {
    let mut dashes = Vec::new();
    for ends in measure.points.windows(2) {
        let seen = [ends[0], ends[1]].map(|end| world.camera.view(world.transform.point(end)));
        let Some(seen) = clipped(&world.camera, seen) else { continue };
        let ends = seen.map(|end| world.camera.pixel(end));
        let size = DVec2::new(f64::from(world.camera.width), f64::from(world.camera.height));
        if let Some(ends) = inside(ends, -DVec2::splat(pen.letter), size + pen.letter) {
            drawing.line(ends, AROUND * pen.letter, pen.paper);
            dashes.push(ends);
        }
    }
    let arc = arc(measure, world).unwrap_or_default();
    drawing.path(&arc, AROUND * pen.letter, pen.paper);
    for ends in dashes {
        dash(drawing, ends, pen);
    }
    drawing.path(&arc, LINE * pen.letter, pen.ink);
}

/// Draws a dashed line that begins and ends with a dash.
fn dash(drawing: &mut Drawing, [from, to]: [DVec2; 2], pen: Pen) {
    let length = from.distance(to) / pen.letter;
    let (dash, gap) = DASH;
    let gaps = ((length - dash) / (dash + gap)).round().max(0.0);
    let scale = length / (gaps * (dash + gap) + dash);
    for step in 0..=gaps as u32 {
        let start = f64::from(step) * (dash + gap) * scale / length;
        let ends = [start, start + dash * scale / length].map(|share| from.lerp(to, share));
        drawing.line(ends, LINE * pen.letter, pen.ink);
    }
}

/// Returns the part of a line within a rectangle, if there is one.
fn inside([from, to]: [DVec2; 2], low: DVec2, high: DVec2) -> Option<[DVec2; 2]> {
    let along = to - from;
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        if along[axis] == 0.0 {
            if from[axis] < low[axis] || from[axis] > high[axis] {
                return None;
            }
            continue;
        }
        let ends = [low, high].map(|edge| (edge[axis] - from[axis]) / along[axis]);
        first = first.max(ends[0].min(ends[1]));
        last = last.min(ends[0].max(ends[1]));
    }
    (first <= last).then(|| [first, last].map(|share| from.lerp(to, share)))
}

/// Returns the points of the arc of an angle in the image; `None` for other measures, and if it is not in front of the camera.
fn arc(measure: &Measure, world: &World) -> Option<Vec<DVec2>> {
    let &[a, b, c] = measure.points.as_slice() else { return None };
    measure.value()?;
    let radius = ARC * (a - b).length().min((c - b).length());
    let (first, second) = (a - b, c - b);
    let along = first.normalize();
    let across = second.reject_from_normalized(along).try_normalize()?;
    let angle = atan2(second.dot(across), second.dot(along));
    let point = |step: u32| {
        let turn = angle * f64::from(step) / f64::from(STEPS);
        let point = b + (along * cos(turn) + across * sin(turn)) * radius;
        project(world, point).map(|(place, _)| place)
    };
    (0..=STEPS).map(point).collect()
}

/// Returns the text of a measure: in the middle of a line, or beside the arc of an angle.
fn text_of(measure: &Measure, world: &World, pen: Pen) -> Option<Placed> {
    let text = measure.text();
    let points = measure.points.as_slice();
    if let (&[_, vertex, _], Some(arc)) = (points, arc(measure, world)) {
        let (vertex, depth) = project(world, vertex)?;
        let middle = arc[STEPS as usize / 2];
        let outward = (middle - vertex).normalize_or(DVec2::Y);
        let label = Label { text: text.clone(), position: Anchor::Top, at: None };
        let half = block::label(&label, pen.letter, pen.ink).size / 2.0 + 2.0 * MARGIN * pen.letter;
        let middle = middle + outward * (half * outward.abs()).element_sum();
        return Some(Placed { text, middle, depth });
    }
    let middle = match *points {
        [a, b] | [_, a, b, _] => (a + b) / 2.0,
        [_, vertex, _] => vertex,
        _ => return None,
    };
    let (middle, depth) = project(world, middle)?;
    Some(Placed { text, middle, depth })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_at_the_edges() {
        let (low, high) = (DVec2::ZERO, DVec2::new(10.0, 8.0));
        let cut = |from: [f64; 2], to: [f64; 2]| inside([from.into(), to.into()], low, high);
        assert_eq!(cut([-5.0, 4.0], [15.0, 4.0]), Some([[0.0, 4.0].into(), [10.0, 4.0].into()]));
        assert_eq!(cut([1.0, 1.0], [2.0, 2.0]), Some([[1.0, 1.0].into(), [2.0, 2.0].into()]));
        assert_eq!(cut([-1.0, 7.0], [4.0, 12.5]), None);
        assert_eq!(cut([5.0, -1.0], [5.0, -2.0]), None);
        assert_eq!(cut([11.0, -1.0], [11.0, 9.0]), None);
    }

    #[test]
    fn dashes_begin_and_end_at_the_ends() {
        let pen = Pen { letter: 10.0, ink: Rgb::ZERO, paper: Rgb::ONE, opacity: 1.0 };
        let mut drawing = Drawing::default();
        dash(&mut drawing, [DVec2::new(2.0, 5.0), DVec2::new(98.0, 5.0)], pen);
        let mut image = crate::image::Image::filled(100, 10, [1.0; 3]).expect("an image");
        drawing.draw_over(&mut image);
        let dark = |x: u32| image.pixel(x, 5).is_some_and(|[red, ..]| red < 0.5);
        assert_eq!([1, 2, 97, 98].map(dark), [false, true, true, false]);
        let changes = (1..100).filter(|&x| dark(x) != dark(x - 1)).count();
        assert!((20..30).contains(&changes), "{changes}");
    }
}
