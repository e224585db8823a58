//! Layout of annotations: blocks are stacked at the corners and edges of the image.

use super::Viewpoint;
use super::block::{self, Block};
use super::tripod::tripod;
use crate::color::Rgb;
use crate::graphics::Drawing;
use crate::overlay::color_bar::{Bar, Direction};
use crate::scene::{Anchor, Annotations, ColorBar, Insets};
use glam::DVec2;

/// Factors on the size of letters, of which the first is used for which all blocks have room.
const SHRINK: [f64; 7] = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4];

/// Minimum size of letters in pixels.
const MIN_LETTER: f64 = 5.0;

/// Lengths of color bars in a corner as fractions of the image's height.
const CORNER_BAR: f64 = 0.35;

/// Lengths of color bars at an edge as fractions of its length, of which the first is used for which all
/// blocks have room.
const EDGE_BARS: [f64; 4] = [0.6, 0.5, 0.4, 0.3];

/// The rest of the image has at least this fraction of its smaller side in each direction, or else no
/// insets are left for annotations.
const MIN_REST: f64 = 0.5;

/// A block with its place.
struct Placed {
    anchor: Anchor,
    block: Block,
    /// Top left corner in pixels.
    corner: DVec2,
}

/// Blocks with their places in an image.
pub(super) struct Layout {
    blocks: Vec<Placed>,
    /// Distance from the image's edge and between blocks.
    gap: f64,
    /// Width and height of the image.
    picture: DVec2,
    /// True if blocks overlap neither one another nor the image's edge.
    pub(super) fits: bool,
}

impl Layout {
    /// Places annotations in an image of this size, with letters of `letter` pixels or less.
    pub(super) fn new(
        annotations: &Annotations,
        (width, height): (u32, u32),
        letter: f64,
        view: &Viewpoint,
        ink: Rgb,
    ) -> Self {
        let picture = DVec2::new(f64::from(width), f64::from(height));
        let mut layout = None;
        let bars = if annotations.color_bar.is_some() { &EDGE_BARS[..] } else { &[1.0] };
        let tries = SHRINK.iter().flat_map(|factor| bars.iter().map(move |share| (factor, share)));
        for (factor, share) in tries {
            let size = (letter * factor).max(MIN_LETTER.min(letter));
            let style = BlockStyle { size, ink, edge_bar: *share };
            let blocks = blocks(annotations, picture, view, style);
            let new = Self::of_blocks(&blocks, picture, size);
            let fits = new.fits;
            layout = Some(new);
            if fits {
                break;
            }
        }
        layout.unwrap_or(Self { blocks: Vec::new(), gap: 0.0, picture, fits: true })
    }

    fn of_blocks(blocks: &[(Anchor, Block)], picture: DVec2, gap: f64) -> Self {
        let mut placed = Vec::new();
        for (_, anchor) in Anchor::ALL {
            let stack = blocks.iter().filter(|(own, _)| *own == anchor);
            let height: f64 = stack.clone().map(|(_, block)| block.size.y + gap).sum();
            let room = picture.y - 2.0 * gap - (height - gap);
            let mut top = gap + anchor.down() * room;
            for (_, block) in stack {
                let left = gap + anchor.across() * (picture.x - 2.0 * gap - block.size.x);
                // Whole pixels, so that edges are sharp.
                let corner = DVec2::new(left, top).round();
                top += block.size.y + gap;
                placed.push(Placed { anchor, block: block.clone(), corner });
            }
        }
        let mut layout = Self { blocks: placed, gap, picture, fits: true };
        layout.fits = layout.has_room();
        layout
    }

    fn has_room(&self) -> bool {
        let ends = |placed: &Placed| (placed.corner, placed.corner + placed.block.size);
        let inside = self.blocks.iter().map(ends).all(|(low, high)| {
            low.min_element() >= 0.0 && (self.picture - high).min_element() >= 0.0
        });
        let apart = |(index, first): (usize, &Placed)| {
            self.blocks[index + 1..].iter().all(|second| {
                let ((low, high), (other_low, other_high)) = (ends(first), ends(second));
                (other_low - high).max(low - other_high).max_element() >= 0.5 * self.gap
            })
        };
        inside && self.blocks.iter().enumerate().all(apart)
    }

    /// Returns the rectangles of panels behind the blocks, from their top left to their bottom right
    /// corners. Blocks of one stack share a panel.
    pub(super) fn panels(&self) -> Vec<(DVec2, DVec2)> {
        let pad = DVec2::splat(0.6 * self.gap);
        let panel = |anchor| {
            let stack = self.blocks.iter().filter(move |placed| placed.anchor == anchor);
            stack
                .map(|placed| (placed.corner - pad, placed.corner + placed.block.size + pad))
                .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
        };
        Anchor::ALL.into_iter().filter_map(|(_, anchor)| panel(anchor)).collect()
    }

    /// Returns insets that contain all blocks, and leave the largest square for the rest; `None` if they
    /// would leave too little.
    ///
    /// A corner is in a column at its side, or in a row above or below the rest.
    pub(super) fn insets(&self) -> Option<Insets> {
        let corners = [Anchor::TopLeft, Anchor::TopRight, Anchor::BottomLeft, Anchor::BottomRight];
        let choices = (0..1 << corners.len()).map(|bits: u32| {
            let in_row = |anchor| {
                let index = corners.iter().position(|corner| *corner == anchor);
                index.map_or(anchor.across() == 0.5, |index| bits >> index & 1 == 1)
            };
            self.insets_of(in_row)
        });
        let rest = |insets: &Insets| {
            let Insets { left, right, bottom, top } = *insets;
            self.picture * (1.0 - DVec2::new(left + right, bottom + top))
        };
        let better = |a: Insets, b: Insets| {
            let value = |rest: DVec2| (rest.min_element(), rest.max_element());
            if value(rest(&b)) > value(rest(&a)) { b } else { a }
        };
        let best = choices.reduce(better)?;
        let enough = rest(&best).min_element() >= MIN_REST * self.picture.min_element();
        (self.fits && enough).then_some(best)
    }

    /// Returns insets with blocks in rows at the bottom and the top, or else in columns at the sides.
    fn insets_of(&self, in_row: impl Fn(Anchor) -> bool) -> Insets {
        let mut insets = Insets::default();
        for Placed { anchor, block, .. } in &self.blocks {
            let row = in_row(*anchor);
            // The distance from the image's edge to the far side of the block or its stack.
            let stack = self.blocks.iter().filter(|placed| placed.anchor == *anchor);
            let high: f64 = stack.map(|placed| placed.block.size.y + self.gap).sum();
            let across = (block.size.x + 1.5 * self.gap) / self.picture.x;
            let down = (high + 0.5 * self.gap) / self.picture.y;
            let (side, extent) = match (row, anchor.across(), anchor.down()) {
                (true, _, 0.0) => (&mut insets.top, down),
                (true, ..) => (&mut insets.bottom, down),
                (false, 0.0, _) => (&mut insets.left, across),
                (false, ..) => (&mut insets.right, across),
            };
            *side = side.max(extent);
        }
        insets
    }

    /// Returns all blocks as one drawing.
    pub(super) fn into_drawing(self) -> Drawing {
        let mut drawing = Drawing::default();
        for Placed { block, corner, .. } in self.blocks {
            drawing.append(block.drawing, corner);
        }
        drawing
    }
}

/// Sizes and color of blocks.
#[derive(Clone, Copy, Debug)]
struct BlockStyle {
    /// Size of the em square in pixels.
    size: f64,
    ink: Rgb,
    /// Length of a color bar at an edge, as a fraction of the edge's length.
    edge_bar: f64,
}

/// Returns the blocks of annotations, in the order in which they are stacked from the top.
fn blocks(
    annotations: &Annotations,
    picture: DVec2,
    view: &Viewpoint,
    style: BlockStyle,
) -> Vec<(Anchor, Block)> {
    let BlockStyle { size, ink, .. } = style;
    let Annotations { color_bar, legend, axes, scale_bar, labels, .. } = annotations;
    let labels = labels.iter().filter(|label| label.at.is_none());
    let labels = labels.map(|label| (label.position, block::label(label, size, ink)));
    let legend = legend.iter().map(|colors| (colors.position, block::legend(colors, size, ink)));
    let bar = color_bar.iter().map(|bar| (bar.position, bar_block(bar, picture, style)));
    let axes = axes.iter().map(|axes| (axes.position, tripod(axes, view, size, ink)));
    let scale = scale_bar
        .iter()
        .map(|bar| (bar.position, block::scale_bar(bar, view, picture.x, size, ink)));
    labels.chain(legend).chain(bar).chain(axes).chain(scale).collect()
}

fn bar_block(bar: &ColorBar, picture: DVec2, style: BlockStyle) -> Block {
    let BlockStyle { size, ink, edge_bar } = style;
    let (direction, length) = match bar.position {
        Anchor::Top | Anchor::Bottom => (Direction::Right, edge_bar * picture.x),
        Anchor::Left | Anchor::Right => (Direction::Up, edge_bar * picture.y),
        _ => (Direction::Up, CORNER_BAR * picture.y),
    };
    Bar::new(&bar.scale, &bar.label, length, size, direction).block(ink)
}
