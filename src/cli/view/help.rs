//! Layout of the help in columns and pages that fit into a window.

use super::font::SizedFont;
use super::keys::HELP;
use super::wrap::wrap;

/// Minimum width of an explanation beside its keys, in units of the letter `m`.
const LEAST: u32 = 12;

/// A line of a column: keys and their explanation.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Row {
    pub(super) keys: String,
    pub(super) what: String,
}

/// The pages of the help in a window.
pub(super) struct Layout {
    /// Columns of each page.
    pub(super) pages: Vec<Vec<Vec<Row>>>,
    /// Width of a column, and how far explanations are indented in it.
    pub(super) width: u32,
    pub(super) indent: u32,
}

/// Number of pages in a window of this size on a display of this scale.
pub(super) fn pages((width, height): (u32, u32), scale: f64) -> usize {
    SizedFont::new(scale).map_or(1, |mut font| Layout::new(&mut font, width, height).pages.len())
}

impl Layout {
    /// Lays out the help.
    pub(super) fn new(font: &mut SizedFont, width: u32, height: u32) -> Self {
        let (gap, margin) = (font.margin(), font.margin());
        let width = width.saturating_sub(margin).max(1);
        let widest =
            |font: &mut SizedFont, text: fn(&(&'static str, &'static str)) -> &'static str| {
                HELP.iter().map(|row| font.width(text(row))).max().unwrap_or(0)
            };
        let keys = widest(font, |row| row.0) + gap;
        let whole = keys + widest(font, |row| row.1) + gap;
        let columns = (width / whole).max(1);
        let column = width / columns;
        let beside = column >= keys + LEAST * font.width("m");
        let indent = if beside { keys } else { 0 };
        let room = column.saturating_sub(gap).max(1);
        let blocks: Vec<Vec<Row>> = HELP
            .iter()
            .map(|(keys, what)| {
                let what = wrap(font, what, (room - indent.min(room)).max(1), usize::MAX);
                let keys = wrap(font, keys, room, usize::MAX);
                if beside { beside_each_other(&keys, &what) } else { below_each_other(keys, what) }
            })
            .collect();
        let lines = (height / font.line()).max(1) as usize;
        let mut pages = paged(&blocks, columns as usize, lines);
        if pages.len() > 1 {
            // One line holds the page number.
            pages = paged(&blocks, columns as usize, lines.saturating_sub(1).max(1));
        }
        Self { pages, width: column, indent }
    }
}

fn beside_each_other(keys: &[String], what: &[String]) -> Vec<Row> {
    let text = |lines: &[String], row: usize| lines.get(row).cloned().unwrap_or_default();
    let rows = 0..keys.len().max(what.len());
    rows.map(|row| Row { keys: text(keys, row), what: text(what, row) }).collect()
}

fn below_each_other(keys: Vec<String>, what: Vec<String>) -> Vec<Row> {
    let keys = keys.into_iter().map(|keys| Row { keys, ..Row::default() });
    keys.chain(what.into_iter().map(|what| Row { what, ..Row::default() })).collect()
}

/// Fills columns of at most this many lines, and pages of this many columns, with balanced heights.
fn paged(blocks: &[Vec<Row>], columns: usize, lines: usize) -> Vec<Vec<Vec<Row>>> {
    let fill = |lines: usize| {
        let mut filled: Vec<Vec<Row>> = vec![Vec::new()];
        for block in blocks {
            for part in block.chunks(lines) {
                if filled.last().is_none_or(|last| last.len() + part.len() > lines) {
                    filled.push(Vec::new());
                }
                if let Some(last) = filled.last_mut() {
                    last.extend_from_slice(part);
                }
            }
        }
        filled
    };
    let pages = fill(lines).len().div_ceil(columns);
    let fits = |lines: &usize| fill(*lines).len() <= pages * columns;
    let highest = blocks.iter().map(Vec::len).max().unwrap_or(1).clamp(1, lines);
    let least = (highest..=lines).find(fits).unwrap_or(lines);
    fill(least).chunks(columns).map(<[_]>::to_vec).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_fits_its_window_and_nothing_is_lost() {
        for scale in [1.0, 1.5, 2.0] {
            let mut font = SizedFont::new(scale).expect("a font");
            // A narrower window has no room for the widest letters.
            for (width, height) in [(96, 72), (200, 150), (320, 240), (640, 360), (1280, 720)] {
                let Layout { pages, width: column, indent } = Layout::new(&mut font, width, height);
                let rows = (height / font.line()).max(1) as usize;
                for page in &pages {
                    assert!(page.len() as u32 * column <= width);
                    for row in page.iter().flatten() {
                        assert!(font.width(&row.keys) <= column, "{row:?}");
                        assert!(indent + font.width(&row.what) <= column, "{row:?}");
                    }
                    let highest = page.iter().map(Vec::len).max().unwrap_or(0);
                    assert!(highest + usize::from(pages.len() > 1) <= rows.max(2));
                }
                let all = pages.iter().flatten().flatten();
                let letters_of = |text: &str| text.chars().filter(|c| *c != ' ').count();
                let shown: usize =
                    all.map(|row| letters_of(&row.keys) + letters_of(&row.what)).sum();
                let there: usize =
                    HELP.iter().map(|row| letters_of(row.0) + letters_of(row.1)).sum();
                assert_eq!(shown, there, "{width}x{height} at {scale}");
            }
        }
        assert_eq!(pages((1280, 720), 1.0), 1);
        assert!(pages((320, 240), 1.0) > 1);
    }
}
