//! Missing parts: samples and tiles of an image that no part has.

use crate::render::ImagePart;
use std::ops::Range;

/// Returns the samples and tiles that no part has, as few and large pieces, by tiles and then by
/// samples.
pub fn uncovered_parts(whole: &ImagePart, parts: &[ImagePart]) -> Vec<ImagePart> {
    let ends = parts.iter().flat_map(|part| [part.tiles.start, part.tiles.end]);
    let mut ends: Vec<u32> = ends.chain([whole.tiles.start, whole.tiles.end]).collect();
    ends.retain(|end| (whole.tiles.start..=whole.tiles.end).contains(end));
    ends.sort_unstable();
    ends.dedup();
    let mut strips: Vec<(Range<u32>, Vec<Range<u32>>)> = Vec::new();
    for pair in ends.windows(2) {
        let strip = ImagePart { tiles: pair[0]..pair[1], ..whole.clone() };
        let gaps = gaps(&whole.samples, parts.iter().filter_map(|part| part.common(&strip)));
        match strips.last_mut() {
            Some((tiles, same)) if *same == gaps => tiles.end = strip.tiles.end,
            _ => strips.push((strip.tiles, gaps)),
        }
    }
    let pieces = |(tiles, gaps): (Range<u32>, Vec<Range<u32>>)| {
        gaps.into_iter().map(move |samples| ImagePart { samples, tiles: tiles.clone() })
    };
    strips.into_iter().flat_map(pieces).collect()
}

/// Returns the samples of the whole that none of the parts of a strip of tiles has.
fn gaps(whole: &Range<u32>, parts: impl Iterator<Item = ImagePart>) -> Vec<Range<u32>> {
    let mut known: Vec<Range<u32>> = parts.map(|part| part.samples).collect();
    known.sort_unstable_by_key(|samples| samples.start);
    let mut gaps = Vec::new();
    let mut at = whole.start;
    for samples in known.into_iter().chain(std::iter::once(whole.end..whole.end)) {
        if samples.start > at {
            gaps.push(at..samples.start);
        }
        at = at.max(samples.end);
    }
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(samples: Range<u32>, tiles: Range<u32>) -> ImagePart {
        ImagePart { samples, tiles }
    }

    #[test]
    fn missing_parts_are_few_and_large() {
        let whole = part(0..16, 0..10);
        assert_eq!(uncovered_parts(&whole, &[]), std::slice::from_ref(&whole));
        assert_eq!(
            uncovered_parts(&whole, &[part(4..8, 0..10)]),
            [part(0..4, 0..10), part(8..16, 0..10)]
        );
        let parts = [part(0..16, 0..3), part(0..8, 3..10), part(8..16, 5..7)];
        assert_eq!(uncovered_parts(&whole, &parts), [part(8..16, 3..5), part(8..16, 7..10)]);
    }

    #[test]
    fn parts_and_missing_parts_are_the_whole() {
        // Every sixth of the rectangles of a grid.
        let whole = part(0..5, 0..6);
        let cells = (0..30_u32).map(|cell| (cell / 6, cell % 6));
        for first in 0..6_usize {
            let parts: Vec<ImagePart> = cells
                .clone()
                .skip(first)
                .step_by(6 - first / 2)
                .map(|(x, y)| part(x..x + 1, y..y + 1))
                .collect();
            let mut all = uncovered_parts(&whole, &parts);
            all.extend(parts);
            assert_eq!(all.iter().map(ImagePart::size).sum::<u64>(), whole.size());
        }
    }

    #[test]
    fn contained_parts_leave_nothing_missing() {
        let whole = part(0..16, 0..10);
        let parts = [part(0..10, 0..10), part(2..4, 0..10), part(12..16, 0..10)];
        assert_eq!(uncovered_parts(&whole, &parts), [part(10..12, 0..10)]);
    }
}
