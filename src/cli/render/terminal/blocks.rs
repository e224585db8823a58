//! Images in half blocks: the upper pixel is a character's foreground color, the lower one its background
//! color.

use super::codes::Codes;

/// Levels of each channel in the cube of 256 colors (xterm's).
const LEVELS: [u8; 6] = [0, 95, 135, 175, 215, 255];

/// Returns the lines of an image.
pub(super) fn text(codes: &Codes, true_color: bool) -> Vec<u8> {
    let mut text = String::new();
    let width = codes.width as usize;
    for pair in codes.pixels.chunks(2 * width) {
        let (upper, lower) = pair.split_at(width);
        let mut last = None;
        for (column, &above) in upper.iter().enumerate() {
            let below = lower.get(column).copied();
            if last != Some((above, below)) {
                text += &color(38, above, true_color);
                text += &below.map_or("\x1b[49m".to_owned(), |code| color(48, code, true_color));
                last = Some((above, below));
            }
            text.push('▀');
        }
        text += "\x1b[0m\r\n";
    }
    text.into_bytes()
}

/// Returns the escape sequence that sets the foreground (38) or background (48) color.
fn color(which: u8, [red, green, blue]: [u8; 3], true_color: bool) -> String {
    if true_color {
        format!("\x1b[{which};2;{red};{green};{blue}m")
    } else {
        format!("\x1b[{which};5;{}m", nearest([red, green, blue]))
    }
}

/// Returns the nearest of xterm's 256 colors, without the 16 user-defined ones: a color of the cube or one of
/// 24 grays.
fn nearest(code: [u8; 3]) -> u8 {
    let level = |value: u8| {
        let distance = |level: &usize| LEVELS[*level].abs_diff(value);
        (0..LEVELS.len()).min_by_key(distance).unwrap_or(0)
    };
    let levels = code.map(level);
    let cube = levels.map(|level| LEVELS[level]);
    let mean = code.iter().map(|&value| u32::from(value)).sum::<u32>() / 3;
    let step = (mean.saturating_sub(3) / 10).min(23) as u8;
    let gray = [8 + 10 * step; 3];
    let distance = |other: [u8; 3]| -> u32 {
        code.iter().zip(other).map(|(&a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    if distance(gray) < distance(cube) {
        232 + step
    } else {
        let [red, green, blue] = levels.map(|level| level as u8);
        16 + 36 * red + 6 * green + blue
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_rows_are_one_line() {
        let (red, blue, gray) = ([255, 0, 0], [0, 0, 255], [7, 8, 9]);
        let codes = Codes { width: 2, height: 3, pixels: vec![red, red, blue, blue, gray, red] };
        let expected = "\x1b[38;2;255;0;0m\x1b[48;2;0;0;255m▀▀\x1b[0m\r\n\
                        \x1b[38;2;7;8;9m\x1b[49m▀\x1b[38;2;255;0;0m\x1b[49m▀\x1b[0m\r\n";
        assert_eq!(String::from_utf8(text(&codes, true)).expect("text"), expected);
        let codes = Codes { width: 1, height: 2, pixels: vec![red, blue] };
        let few = String::from_utf8(text(&codes, false)).expect("text");
        assert_eq!(few, "\x1b[38;5;196m\x1b[48;5;21m▀\x1b[0m\r\n");
    }

    #[test]
    fn colors_are_the_nearest_of_256() {
        for (code, expected) in [
            ([0, 0, 0], 16),
            ([255, 255, 255], 231),
            ([95, 135, 175], 67),
            ([128, 128, 128], 244),
            ([8, 8, 8], 232),
            ([238, 238, 238], 255),
            ([250, 10, 10], 196),
        ] {
            assert_eq!(nearest(code), expected, "{code:?}");
        }
    }
}
