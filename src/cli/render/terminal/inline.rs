//! Inline PNG images, for Kitty and iTerm.

use super::codes::Codes;
use spherule_render::graphics::base64;
use spherule_render::image::{Compression, encode_codes};

/// Maximum number of bytes of an escape sequence of Kitty; a multiple of 4.
const CHUNK: usize = 4096;

/// Identifier of the image, which the next one replaces.
const NUMBER: u32 = 31;

/// Encodes an image for the Kitty graphics protocol, in `columns` x `rows` cells. The terminal does not
/// answer, and does not move the cursor.
///
/// <https://sw.kovidgoyal.net/kitty/graphics-protocol/>
pub(super) fn kitty(codes: &Codes, [columns, rows]: [u32; 2]) -> Vec<u8> {
    let data = base64(&png(codes));
    let mut text = Vec::new();
    let mut chunks = data.as_bytes().chunks(CHUNK).peekable();
    let first = format!("a=T,f=100,i={NUMBER},q=2,C=1,c={columns},r={rows},");
    let mut head = first.as_str();
    while let Some(chunk) = chunks.next() {
        let more = u8::from(chunks.peek().is_some());
        text.extend(format!("\x1b_G{head}m={more};").bytes());
        text.extend(chunk);
        text.extend(b"\x1b\\");
        head = "q=2,";
    }
    text
}

/// Encodes an image for iTerm's inline images, in `columns` x `rows` cells.
///
/// <https://iterm2.com/documentation-images.html>
pub(super) fn iterm(codes: &Codes, [columns, rows]: [u32; 2]) -> Vec<u8> {
    let png = png(codes);
    let size = png.len();
    let data = base64(&png);
    format!(
        "\x1b]1337;File=inline=1;size={size};width={columns};height={rows};\
         preserveAspectRatio=1:{data}\x07"
    )
    .into_bytes()
}

/// Encodes the image as PNG; empty if it has no pixels.
fn png(codes: &Codes) -> Vec<u8> {
    let size = (codes.width, codes.height);
    encode_codes(codes.pixels.as_flattened(), size, Compression::Fast).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn codes(width: u32, height: u32) -> Codes {
        let value = |i: u32| [(i * 7) as u8, (i * 31) as u8, (i * i) as u8];
        Codes { width, height, pixels: (0..width * height).map(value).collect() }
    }

    fn decoded(text: &str) -> Vec<u8> {
        let value = |c: u8| match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            _ => 63,
        };
        let digits = text.trim_end_matches('=');
        let mut bytes = Vec::new();
        for group in digits.as_bytes().chunks(4) {
            let word = group.iter().fold(0, |word, &c| word << 6 | u32::from(value(c)));
            let word = word << (6 * (4 - group.len()));
            bytes.extend(&word.to_be_bytes()[1..group.len()]);
        }
        bytes
    }

    fn pixels(file: &[u8]) -> Vec<u8> {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        reader.next_frame(&mut pixels).expect("pixels");
        pixels
    }

    #[test]
    fn kitty_gets_a_file_in_chunks() {
        let codes = codes(97, 61);
        let text = String::from_utf8(kitty(&codes, [49, 16])).expect("text");
        let parts: Vec<&str> = text.split_terminator("\x1b\\").collect();
        assert!(parts.len() > 1 && text.ends_with("\x1b\\"));
        let mut data = String::new();
        for (place, part) in parts.iter().enumerate() {
            let (head, chunk) = part.strip_prefix("\x1b_G").unwrap().split_once(';').unwrap();
            let more = u8::from(place + 1 < parts.len());
            let keys = "a=T,f=100,i=31,q=2,C=1,c=49,r=16,";
            let expected = if place == 0 { keys } else { "q=2," };
            assert_eq!(head, format!("{expected}m={more}"));
            assert!(chunk.len() <= 4096 && (more == 0 || chunk.len() % 4 == 0));
            data += chunk;
        }
        assert_eq!(pixels(&decoded(&data)), codes.pixels.as_flattened());
    }

    #[test]
    fn iterm_gets_a_file_and_its_size() {
        let codes = codes(5, 3);
        let text = String::from_utf8(iterm(&codes, [5, 2])).expect("text");
        let (head, data) = text.strip_suffix('\x07').unwrap().split_once(':').unwrap();
        let file = decoded(data);
        let size = file.len();
        let expected =
            format!("\x1b]1337;File=inline=1;size={size};width=5;height=2;preserveAspectRatio=1");
        assert_eq!(head, expected);
        assert_eq!(pixels(&file), codes.pixels.as_flattened());
    }
}
