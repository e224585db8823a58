//! Images as sixels: bands of six rows, color by color.
//!
//! Digital Equipment Corporation, "VT330/VT340 Programmer Reference Manual", volume 2, chapter 14.

use super::codes::Codes;
use std::fmt::Write;

/// Levels of red, green and blue in the palette: 252 colors, of the 256 that terminals have.
const LEVELS: [u32; 3] = [6, 7, 6];

/// Bayer's matrix, for ordered dithering.
const BAYER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Rows of a band.
const BAND: usize = 6;

/// Returns the escape sequence that draws an image at the cursor.
pub(super) fn text(codes: &Codes) -> Vec<u8> {
    let width = codes.width as usize;
    let mut text = format!("\x1bP0;1q\"1;1;{};{}", codes.width, codes.height);
    for (number, color) in palette().enumerate() {
        let [red, green, blue] = color.map(|level| level * 100 / 255);
        // Writing into a string does not fail.
        let _ = write!(text, "#{number};2;{red};{green};{blue}");
    }
    let chosen: Vec<u8> = (0..codes.pixels.len())
        .map(|place| number(codes.pixels[place], place % width, place / width))
        .collect();
    for band in chosen.chunks(BAND * width) {
        let mut used = [false; 256];
        for &number in band {
            used[usize::from(number)] = true;
        }
        for number in (0..=u8::MAX).filter(|number| used[usize::from(*number)]) {
            let _ = write!(text, "#{number}");
            let bits = |column: usize| {
                let rows = band.chunks(width).map(move |row| row[column] == number);
                rows.enumerate().map(|(row, own)| u8::from(own) << row).sum::<u8>()
            };
            row(&mut text, (0..width).map(bits));
            text.push('$');
        }
        text.push('-');
    }
    text += "\x1b\\";
    text.into_bytes()
}

/// Writes sixels, with run-length encoding for more than three equal ones.
fn row(text: &mut String, sixels: impl Iterator<Item = u8>) {
    let mut sixels = sixels.peekable();
    while let Some(bits) = sixels.next() {
        let mut count = 1;
        while sixels.next_if_eq(&bits).is_some() {
            count += 1;
        }
        let sixel = char::from(63 + bits);
        if count > 3 {
            let _ = write!(text, "!{count}{sixel}");
        } else {
            (0..count).for_each(|_| text.push(sixel));
        }
    }
}

/// Returns the colors of the palette.
fn palette() -> impl Iterator<Item = [u32; 3]> {
    let [reds, greens, blues] = LEVELS;
    let level = |at: u32, levels: u32| at % levels * 255 / (levels - 1);
    (0..reds * greens * blues)
        .map(move |i| [level(i / blues / greens, reds), level(i / blues, greens), level(i, blues)])
}

/// Returns the color of the palette for a pixel at a place.
fn number(code: [u8; 3], x: usize, y: usize) -> u8 {
    // 1/32 to 31/32 of a step.
    let threshold = 2 * BAYER[y % 4][x % 4] + 1;
    let level = |channel: usize| {
        let steps = LEVELS[channel] - 1;
        (u32::from(code[channel]) * steps * 32 + threshold * 255) / (255 * 32)
    };
    let [_, greens, blues] = LEVELS;
    ((level(0) * greens + level(1)) * blues + level(2)) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws sixels as a terminal does.
    fn drawn(text: &str, width: usize, height: usize) -> Vec<[u32; 3]> {
        let body = text.strip_prefix("\x1bP0;1q").and_then(|text| text.strip_suffix("\x1b\\"));
        let body = body.expect("a sequence of sixels");
        let size = format!("\"1;1;{width};{height}");
        let mut rest = body.strip_prefix(&size).expect("the size").chars().peekable();
        let mut pixels = vec![[999; 3]; width * height];
        let mut colors = vec![[0; 3]; 256];
        let (mut x, mut band, mut color) = (0, 0, 0);
        while let Some(sign) = rest.next() {
            let mut number = || {
                let mut value = 0;
                while let Some(digit) = rest.peek().and_then(|c| c.to_digit(10)) {
                    value = 10 * value + digit;
                    rest.next();
                }
                value
            };
            let mut count = 1;
            let mut sixel = sign;
            match sign {
                '#' => {
                    color = number() as usize;
                    if rest.next_if_eq(&';').is_some() {
                        let mut values = [0; 4];
                        for value in &mut values {
                            while let Some(digit) = rest.peek().and_then(|c| c.to_digit(10)) {
                                *value = 10 * *value + digit;
                                rest.next();
                            }
                            rest.next_if_eq(&';');
                        }
                        colors[color] = [values[1], values[2], values[3]];
                    }
                    continue;
                }
                '$' => {
                    x = 0;
                    continue;
                }
                '-' => {
                    (x, band) = (0, band + 1);
                    continue;
                }
                '!' => {
                    count = number();
                    sixel = rest.next().expect("a sixel");
                }
                _ => (),
            }
            let bits = sixel as u32 - 63;
            for _ in 0..count {
                for row in (0..6).filter(|row| bits >> row & 1 == 1) {
                    pixels[(6 * band + row) * width + x] = colors[color];
                }
                x += 1;
            }
        }
        pixels
    }

    #[test]
    fn sixels_draw_the_picture() {
        let (width, height) = (37, 20);
        let code = |i: usize| [(i * 3) as u8, (i * 11) as u8, (255 - i % 256) as u8];
        let pixels: Vec<[u8; 3]> = (0..width * height).map(code).collect();
        let codes = Codes { width: width as u32, height: height as u32, pixels };
        let text = String::from_utf8(text(&codes)).expect("text");
        for (pixel, code) in drawn(&text, width, height).iter().zip(&codes.pixels) {
            for channel in 0..3 {
                // A step of the palette, in hundredths.
                let expected = u32::from(code[channel]) * 100 / 255;
                assert!(pixel[channel].abs_diff(expected) <= 21, "{pixel:?} {code:?}");
            }
        }
    }

    #[test]
    fn plain_colors_are_not_dithered_and_grays_are_on_average() {
        for (code, expected) in [([0; 3], [0; 3]), ([255; 3], [100; 3]), ([255, 0, 0], [100, 0, 0])]
        {
            let codes = Codes { width: 8, height: 8, pixels: vec![code; 64] };
            let text = String::from_utf8(text(&codes)).expect("text");
            assert!(drawn(&text, 8, 8).iter().all(|pixel| *pixel == expected), "{code:?}");
        }
        let codes = Codes { width: 8, height: 8, pixels: vec![[140; 3]; 64] };
        let text = String::from_utf8(text(&codes)).expect("text");
        let sum: u32 = drawn(&text, 8, 8).iter().map(|pixel| pixel[1]).sum();
        assert!((53..=56).contains(&(sum / 64)), "{}", sum / 64);
    }
}
