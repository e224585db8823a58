//! Lines of text that fit: broken between words, or shortened in the middle.

use super::letters::{ELLIPSIS, Letters};

/// Between two parts of the status line.
const SEPARATOR: &str = "  |  ";

/// Parts of a text as lines of at most this width, no more of them than there is room for: a part
/// begins a line rather than being broken, and what has no room is left out of the middle.
pub(super) fn flow(
    letters: &mut Letters,
    parts: &[String],
    width: u32,
    most: usize,
) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in parts {
        if let Some(last) = lines.last_mut() {
            let longer = format!("{last}{SEPARATOR}{part}");
            if letters.width(&longer) <= width {
                *last = longer;
                continue;
            }
        }
        lines.extend(broken(letters, part, width));
    }
    if lines.len() <= most { lines } else { wrap(letters, &parts.join(SEPARATOR), width, most) }
}

/// A text as lines of at most this width, no more of them than there is room for: what has no room
/// is left out of the middle.
pub(super) fn wrap(letters: &mut Letters, text: &str, width: u32, most: usize) -> Vec<String> {
    let lines = broken(letters, text, width);
    if lines.len() <= most {
        return lines;
    }
    let all: Vec<char> = text.chars().collect();
    let shortened = |kept: usize| {
        let head = kept - kept / 2;
        let (head, tail) = (&all[..head], &all[all.len() - kept / 2..]);
        head.iter().chain([&ELLIPSIS]).chain(tail).collect::<String>()
    };
    // The most letters for which there is room.
    let (mut low, mut high) = (0, all.len());
    let mut best = Vec::new();
    while low < high {
        let middle = usize::midpoint(low, high);
        let lines = broken(letters, &shortened(middle), width);
        if lines.len() <= most {
            (best, low) = (lines, middle + 1);
        } else {
            high = middle;
        }
    }
    best
}

/// A text as lines of at most this width; a word that is wider is broken too, and a letter that is
/// wider is left out.
fn broken(letters: &mut Letters, text: &str, width: u32) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_inclusive(' ') {
        let longer = format!("{line}{word}");
        if letters.width(longer.trim_end()) <= width {
            line = longer;
            continue;
        }
        if !line.trim().is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        line.clear();
        for letter in word.chars() {
            line.push(letter);
            if letters.width(line.trim_end()) > width {
                line.pop();
                if !line.is_empty() {
                    lines.push(std::mem::take(&mut line));
                }
                line.push(letter);
                if letters.width(&line) > width {
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
            let mut letters = Letters::new(scale).expect("a font");
            for width in [3, 16, 64, 200, 333, 5000] {
                for most in [1, 2, 5, 100] {
                    let parts = ["10 spheres".to_owned(), LONG.to_owned(), "end".to_owned()];
                    for lines in [
                        wrap(&mut letters, LONG, width, most),
                        flow(&mut letters, &parts, width, most),
                    ] {
                        assert!(lines.len() <= most);
                        assert!(lines.iter().all(|line| letters.width(line) <= width));
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_is_lost_that_has_room() {
        let mut letters = Letters::new(1.0).expect("a font");
        let lines = wrap(&mut letters, LONG, 150, 100);
        assert!(lines.len() > 2);
        assert_eq!(lines.concat().replace(' ', ""), LONG.replace(' ', ""));
        let parts = ["one part".to_owned(), "and another".to_owned()];
        assert_eq!(flow(&mut letters, &parts, 5000, 3), ["one part  |  and another"]);
        let narrow = letters.width("and another");
        assert_eq!(flow(&mut letters, &parts, narrow, 3), ["one part", "and another"]);
    }

    #[test]
    fn the_middle_goes_first() {
        let mut letters = Letters::new(1.0).expect("a font");
        let line = wrap(&mut letters, LONG, 200, 1).concat();
        assert!(line.starts_with("saved /a") && line.ends_with("more"), "{line}");
        assert!(line.contains(ELLIPSIS) && letters.width(&line) > 180, "{line}");
    }
}
