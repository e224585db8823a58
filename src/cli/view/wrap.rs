//! Line breaking of text, with an ellipsis in the middle if space is short.

use super::font::{ELLIPSIS, SizedFont};

/// Separator of the parts of the status line.
const SEPARATOR: &str = "  |  ";

/// Breaks the parts of a text into at most `max_lines` lines of this width. A part starts a new line rather
/// than being broken; if space is short, the middle is left out.
pub(super) fn flow(
    font: &mut SizedFont,
    parts: &[String],
    width: u32,
    max_lines: usize,
) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in parts {
        if let Some(last) = lines.last_mut() {
            let longer = format!("{last}{SEPARATOR}{part}");
            if font.width(&longer) <= width {
                *last = longer;
                continue;
            }
        }
        lines.extend(broken(font, part, width));
    }
    if lines.len() <= max_lines {
        lines
    } else {
        wrap(font, &parts.join(SEPARATOR), width, max_lines)
    }
}

/// Breaks a text into at most `max_lines` lines of this width; if space is short, the middle is left out.
pub(super) fn wrap(font: &mut SizedFont, text: &str, width: u32, max_lines: usize) -> Vec<String> {
    let lines = broken(font, text, width);
    if lines.len() <= max_lines {
        return lines;
    }
    let all: Vec<char> = text.chars().collect();
    let shortened = |kept: usize| {
        let head = kept - kept / 2;
        let (head, tail) = (&all[..head], &all[all.len() - kept / 2..]);
        head.iter().chain([&ELLIPSIS]).chain(tail).collect::<String>()
    };
    // Binary search for the maximum number of characters that fit.
    let (mut low, mut high) = (0, all.len());
    let mut best = Vec::new();
    while low < high {
        let middle = usize::midpoint(low, high);
        let lines = broken(font, &shortened(middle), width);
        if lines.len() <= max_lines {
            (best, low) = (lines, middle + 1);
        } else {
            high = middle;
        }
    }
    best
}

/// Breaks a text into lines of this width. A wider word is broken too, and a wider character is left out.
fn broken(font: &mut SizedFont, text: &str, width: u32) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_inclusive(' ') {
        let longer = format!("{line}{word}");
        if font.width(longer.trim_end()) <= width {
            line = longer;
            continue;
        }
        if !line.trim().is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        line.clear();
        for letter in word.chars() {
            line.push(letter);
            if font.width(line.trim_end()) > width {
                line.pop();
                if !line.is_empty() {
                    lines.push(std::mem::take(&mut line));
                }
                line.push(letter);
                if font.width(&line) > width {
                    line.clear();
                }
            }
        }
    }
    if !line.trim().is_empty() {
        lines.push(line);
    }
    lines.iter().map(|line| line.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONG: &str =
        "saved /a/very/long/path/without/a/blank/in/it/which/is/no/word.png and more";

    #[test]
    fn lines_fit_at_every_size() {
        for scale in [1.0, 1.5, 2.0] {
            let mut font = SizedFont::new(scale).expect("a font");
            for width in [3, 16, 64, 200, 333, 5000] {
                for max_lines in [1, 2, 5, 100] {
                    let parts = ["10 spheres".to_owned(), LONG.to_owned(), "end".to_owned()];
                    for lines in [
                        wrap(&mut font, LONG, width, max_lines),
                        flow(&mut font, &parts, width, max_lines),
                    ] {
                        assert!(lines.len() <= max_lines);
                        assert!(lines.iter().all(|line| font.width(line) <= width));
                    }
                }
            }
        }
    }

    #[test]
    fn text_that_fits_is_complete() {
        let mut font = SizedFont::new(1.0).expect("a font");
        let lines = wrap(&mut font, LONG, 150, 100);
        assert!(lines.len() > 2);
        assert_eq!(lines.concat().replace(' ', ""), LONG.replace(' ', ""));
        let parts = ["one part".to_owned(), "and another".to_owned()];
        assert_eq!(flow(&mut font, &parts, 5000, 3), ["one part  |  and another"]);
        let narrow = font.width("and another");
        assert_eq!(flow(&mut font, &parts, narrow, 3), ["one part", "and another"]);
    }

    #[test]
    fn long_text_loses_its_middle() {
        let mut font = SizedFont::new(1.0).expect("a font");
        let line = wrap(&mut font, LONG, 200, 1).concat();
        assert!(line.starts_with("saved /a") && line.ends_with("more"), "{line}");
        assert!(line.contains(ELLIPSIS) && font.width(&line) > 180, "{line}");
    }
}
