//! Whether shares have everything.

use crate::render::Share;
use std::ops::Range;

/// What of the whole no share has: few and large pieces, by tiles and then by samples.
pub fn holes(whole: &Share, shares: &[Share]) -> Vec<Share> {
    let ends = shares.iter().flat_map(|share| [share.tiles.start, share.tiles.end]);
    let mut ends: Vec<u32> = ends.chain([whole.tiles.start, whole.tiles.end]).collect();
    ends.retain(|end| (whole.tiles.start..=whole.tiles.end).contains(end));
    ends.sort_unstable();
    ends.dedup();
    let mut strips: Vec<(Range<u32>, Vec<Range<u32>>)> = Vec::new();
    for pair in ends.windows(2) {
        let strip = Share { tiles: pair[0]..pair[1], ..whole.clone() };
        let gaps = gaps(&whole.samples, shares.iter().filter_map(|share| share.common(&strip)));
        match strips.last_mut() {
            Some((tiles, same)) if *same == gaps => tiles.end = strip.tiles.end,
            _ => strips.push((strip.tiles, gaps)),
        }
    }
    let pieces = |(tiles, gaps): (Range<u32>, Vec<Range<u32>>)| {
        gaps.into_iter().map(move |samples| Share { samples, tiles: tiles.clone() })
    };
    strips.into_iter().flat_map(pieces).collect()
}

/// Samples of the whole that none of the shares of a strip of tiles has.
fn gaps(whole: &Range<u32>, shares: impl Iterator<Item = Share>) -> Vec<Range<u32>> {
    let mut there: Vec<Range<u32>> = shares.map(|share| share.samples).collect();
    there.sort_unstable_by_key(|samples| samples.start);
    let mut gaps = Vec::new();
    let mut at = whole.start;
    for samples in there.into_iter().chain(std::iter::once(whole.end..whole.end)) {
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

    fn share(samples: Range<u32>, tiles: Range<u32>) -> Share {
        Share { samples, tiles }
    }

    #[test]
    fn holes_are_few_and_large() {
        let whole = share(0..16, 0..10);
        assert_eq!(holes(&whole, &[]), std::slice::from_ref(&whole));
        assert_eq!(holes(&whole, &[share(4..8, 0..10)]), [share(0..4, 0..10), share(8..16, 0..10)]);
        let shares = [share(0..16, 0..3), share(0..8, 3..10), share(8..16, 5..7)];
        assert_eq!(holes(&whole, &shares), [share(8..16, 3..5), share(8..16, 7..10)]);
    }

    #[test]
    fn pieces_and_holes_are_the_whole() {
        // Every sixth of the rectangles of a grid.
        let whole = share(0..5, 0..6);
        let cells = (0..30_u32).map(|cell| (cell / 6, cell % 6));
        for first in 0..6_usize {
            let shares: Vec<Share> = cells
                .clone()
                .skip(first)
                .step_by(6 - first / 2)
                .map(|(x, y)| share(x..x + 1, y..y + 1))
                .collect();
            let mut all = holes(&whole, &shares);
            all.extend(shares);
            assert_eq!(all.iter().map(Share::size).sum::<u64>(), whole.size());
        }
    }

    #[test]
    fn shares_within_others_leave_no_holes() {
        let whole = share(0..16, 0..10);
        let shares = [share(0..10, 0..10), share(2..4, 0..10), share(12..16, 0..10)];
        assert_eq!(holes(&whole, &shares), [share(10..12, 0..10)]);
    }
}
