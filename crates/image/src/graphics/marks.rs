//! Subscripts and superscripts in lines of text.
//!
//! `_` and `^` lower and raise what follows: a number with its sign, a word, or anything between braces, as in `v_x`,
//! `10^-3` and `E_{pot, 1}`. After a backslash they are themselves, and so they are where nothing follows.

use super::{Align, Drawing, Text, text_width};
use glam::DVec2;

/// Size of raised and lowered letters, as a fraction of that of others.
const SMALL: f64 = 0.7;

/// Distances by which letters are raised and lowered, in ems.
const RAISED: f64 = 0.32;
const LOWERED: f64 = 0.2;

/// Letters of one height.
#[derive(Clone, Debug, PartialEq)]
struct Run {
    text: String,
    /// The mark before them.
    mark: Option<char>,
}

/// Returns the width of a line of text with marks in pixels, for an em square of `size` pixels.
pub fn marked_width(text: &str, size: f64) -> f64 {
    runs(text).iter().map(|run| run.width(size)).sum()
}

/// Returns a line of text without marks: numbers and `x` after them become characters that are raised or lowered.
pub fn unmarked(text: &str) -> String {
    let small = |run: &Run| -> Option<String> {
        run.text.chars().map(|letter| small_letter(run.mark?, letter)).collect()
    };
    let plain = |run: &Run| match run.mark {
        None => run.text.clone(),
        Some(mark) => small(run).unwrap_or_else(|| format!("{mark}{}", run.text)),
    };
    runs(text).iter().map(plain).collect()
}

impl Drawing {
    /// Adds a line of text with marks.
    pub fn marked_text(&mut self, line: &Text) {
        let mut position = line.start_of(marked_width(&line.text, line.size));
        for run in runs(&line.text) {
            let width = run.width(line.size);
            let (size, down) = match run.mark {
                None => (line.size, 0.0),
                Some('^') => (SMALL * line.size, -RAISED * line.size),
                Some(_) => (SMALL * line.size, LOWERED * line.size),
            };
            let at = position + DVec2::Y * down;
            let (align, color) = (Align::Start, line.color);
            self.text(Text { text: run.text, position: at, align, size, color });
            position.x += width;
        }
    }
}

impl Run {
    fn width(&self, size: f64) -> f64 {
        let size = if self.mark.is_some() { SMALL * size } else { size };
        text_width(&self.text, size)
    }
}

/// Splits a line of text at its marks.
fn runs(text: &str) -> Vec<Run> {
    let mut runs = Vec::new();
    let mut plain = String::new();
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        let after = &rest[letter.len_utf8()..];
        let is_mark = matches!(letter, '_' | '^');
        if letter == '\\' && after.starts_with(['_', '^']) {
            plain.push_str(&after[..1]);
            rest = &after[1..];
            continue;
        }
        // There is nothing to lower or to raise beside a space.
        let has_base = match plain.chars().next_back() {
            Some(before) => before != ' ',
            None => !runs.is_empty(),
        };
        let found = if is_mark && has_base { marked(after) } else { None };
        let Some((marked, after)) = found else {
            plain.push(letter);
            rest = after;
            continue;
        };
        if !plain.is_empty() {
            runs.push(Run { text: std::mem::take(&mut plain), mark: None });
        }
        runs.push(Run { text: marked.replace('-', "\u{2212}"), mark: Some(letter) });
        rest = after;
    }
    if !plain.is_empty() {
        runs.push(Run { text: plain, mark: None });
    }
    runs
}

/// Splits a text after the part that a mark before it is for.
fn marked(text: &str) -> Option<(&str, &str)> {
    if let Some(inner) = text.strip_prefix('{') {
        return inner.split_once('}').filter(|(marked, _)| !marked.is_empty());
    }
    let number = text.strip_prefix(['-', '+']).unwrap_or(text);
    let digits = number.trim_start_matches(|letter: char| letter.is_ascii_digit());
    if digits.len() < number.len() {
        return Some(text.split_at(text.len() - digits.len()));
    }
    let others = text.trim_start_matches(char::is_alphabetic);
    (others.len() < text.len()).then(|| text.split_at(text.len() - others.len()))
}

/// Returns the raised or lowered form of a letter that Unicode has one for and fonts have.
fn small_letter(mark: char, letter: char) -> Option<char> {
    let letters = match mark {
        '^' => "⁰¹²³⁴⁵⁶⁷⁸⁹⁺⁻",
        _ => "₀₁₂₃₄₅₆₇₈₉₊₋ₓ",
    };
    let place = "0123456789+\u{2212}x".chars().position(|own| own == letter)?;
    letters.chars().nth(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Rgb;

    fn split(text: &str) -> Vec<String> {
        let shown = |run: Run| run.mark.map_or(String::new(), String::from) + &run.text;
        runs(text).into_iter().map(shown).collect()
    }

    #[test]
    fn numbers_words_and_braces_follow_marks() {
        for (text, expected) in [
            ("speed (m/s)", &["speed (m/s)"][..]),
            ("v_x", &["v", "_x"]),
            ("10^-3 m^2/s", &["10", "^\u{2212}3", " m", "^2", "/s"]),
            ("E_{pot, 1}/N", &["E", "_pot, 1", "/N"]),
            ("x_1^2", &["x", "_1", "^2"]),
            ("c\\_pe a\\b", &["c_pe a\\b"]),
            ("_x a _b", &["_x a _b"]),
            ("a_ b^", &["a_ b^"]),
            ("a_{b a^", &["a_{b a^"]),
            ("a^{}", &["a^{}"]),
            ("σ_αβ", &["σ", "_αβ"]),
            ("", &[]),
        ] {
            assert_eq!(split(text), expected, "{text}");
        }
    }

    #[test]
    fn texts_are_as_wide_as_their_letters() {
        let width = marked_width("v_x^2", 10.0);
        let expected = text_width("v", 10.0) + text_width("x", 7.0) + text_width("2", 7.0);
        assert!((width - expected).abs() < 1e-12);
        let mut drawing = Drawing::default();
        let (align, color) = (Align::End, Rgb::ZERO);
        let position = DVec2::new(50.0, 20.0);
        drawing.marked_text(&Text { text: "v_x".to_owned(), position, align, size: 10.0, color });
        let mut expected = Drawing::default();
        let start = 50.0 - marked_width("v_x", 10.0);
        for (text, x, y, size) in
            [("v", start, 20.0, 10.0), ("x", start + text_width("v", 10.0), 22.0, 7.0)]
        {
            let (position, align) = (DVec2::new(x, y), Align::Start);
            expected.text(Text { text: text.to_owned(), position, align, size, color });
        }
        assert_eq!(drawing, expected);
    }

    #[test]
    fn texts_without_marks_keep_their_meaning() {
        for (text, expected) in [
            ("v_x", "vₓ"),
            ("v_y", "v_y"),
            ("10^-3 m^2", "10⁻³ m²"),
            ("c\\_pe", "c_pe"),
            ("T_max", "T_max"),
        ] {
            assert_eq!(unmarked(text), expected);
        }
    }
}
