//! Converts UTF-16, which spreadsheets and Windows write, to UTF-8.

use std::io::{self, Read};

/// Bytes per read.
const BLOCK: usize = 1 << 16;

/// Reader that converts UTF-16 to UTF-8, without the byte order mark. Unpaired surrogates become
/// replacement characters.
pub(crate) struct Utf16<R> {
    inner: R,
    unit: fn([u8; 2]) -> u16,
    /// Undecoded bytes: half a code unit, or the first half of a surrogate pair.
    rest: Vec<u8>,
    text: Vec<u8>,
    /// Number of bytes of `text` that were returned.
    given: usize,
    ended: bool,
}

/// Returns the conversion of bytes to code units for UTF-16 with a byte order mark.
pub(crate) fn mark(head: &[u8]) -> Option<fn([u8; 2]) -> u16> {
    match head {
        // UTF-32 has the same first bytes.
        [0xFF, 0xFE, 0, 0, ..] => None,
        [0xFF, 0xFE, ..] => Some(u16::from_le_bytes),
        [0xFE, 0xFF, ..] => Some(u16::from_be_bytes),
        _ => None,
    }
}

/// Returns the name of the encoding of a text that seems to be UTF-32, or UTF-16 without a byte order
/// mark.
pub(crate) fn unmarked(head: &[u8]) -> Option<&'static str> {
    if head.starts_with(&[0xFF, 0xFE, 0, 0]) || head.starts_with(&[0, 0, 0xFE, 0xFF]) {
        return Some("UTF-32");
    }
    let pairs = head.as_chunks::<2>().0;
    let is_text = |byte: u8| matches!(byte, b' '..=b'~' | b'\t' | b'\r' | b'\n');
    let mostly_ascii = |wide: fn(&[u8; 2]) -> (u8, u8)| {
        let text = pairs.iter().map(wide).filter(|&(low, high)| high == 0 && is_text(low));
        text.count() * 10 >= pairs.len() * 9 && pairs.len() > 2
    };
    if mostly_ascii(|&[low, high]| (low, high)) {
        return Some("UTF-16LE");
    }
    mostly_ascii(|&[high, low]| (low, high)).then_some("UTF-16BE")
}

impl<R: Read> Utf16<R> {
    /// Creates a reader of text with a byte order mark; `unit` converts bytes to code units.
    pub(crate) fn new(inner: R, unit: fn([u8; 2]) -> u16) -> Self {
        Self { inner, unit, rest: Vec::new(), text: Vec::new(), given: 0, ended: false }
    }

    /// Decodes the next characters.
    fn fill(&mut self) -> io::Result<()> {
        let mut bytes = std::mem::take(&mut self.rest);
        let before = bytes.len();
        self.ended = (&mut self.inner).take(BLOCK as u64).read_to_end(&mut bytes)? == 0;
        let (pairs, odd) = bytes.as_chunks::<2>();
        let mut units: Vec<u16> = pairs.iter().map(|&pair| (self.unit)(pair)).collect();
        let is_half = |unit: &u16| (0xD800..0xDC00).contains(unit);
        if !self.ended && before < bytes.len() {
            let kept = usize::from(units.last().is_some_and(is_half));
            units.truncate(units.len() - kept);
            self.rest = bytes[bytes.len() - odd.len() - 2 * kept..].to_vec();
        } else if !odd.is_empty() {
            units.push(u16::from(b'?'));
        }
        let letters =
            char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER));
        let text: String = letters.filter(|&letter| letter != '\u{FEFF}').collect();
        (self.text, self.given) = (text.into_bytes(), 0);
        Ok(())
    }
}

impl<R: Read> Read for Utf16<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.given == self.text.len() && !self.ended {
            self.fill()?;
        }
        let left = &self.text[self.given..];
        let length = left.len().min(buffer.len());
        buffer[..length].copy_from_slice(&left[..length]);
        self.given += length;
        Ok(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reader that returns a byte at a time.
    struct SmallReads<'b>(&'b [u8]);

    impl Read for SmallReads<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let length = buffer.len().min(1);
            self.0.read(&mut buffer[..length])
        }
    }

    #[test]
    fn both_byte_orders_are_read() {
        let text = "x;\u{3bc};\u{1F600}\n1,5;2\n".repeat(9000);
        for (bytes, big) in
            [(u16::to_le_bytes as fn(u16) -> [u8; 2], false), (u16::to_be_bytes, true)]
        {
            let file: Vec<u8> =
                ["\u{FEFF}", &text].concat().encode_utf16().flat_map(bytes).collect();
            let unit = mark(&file).expect("a mark");
            assert_eq!(unit([1, 0]), if big { 256 } else { 1 });
            let mut read = String::new();
            Utf16::new(&file[..], unit).read_to_string(&mut read).expect("text");
            assert!(read == text);
            read.clear();
            Utf16::new(SmallReads(&file[..999]), unit).read_to_string(&mut read).expect("text");
            assert!(text.starts_with(read.trim_end_matches(['?', '\u{FFFD}'])) && read.len() > 400);
            let name = if big { "UTF-16BE" } else { "UTF-16LE" };
            let plain: Vec<u8> = "1 2 3\n".repeat(9).encode_utf16().flat_map(bytes).collect();
            assert_eq!((unmarked(&plain), mark(&plain).is_none()), (Some(name), true));
        }
        assert_eq!(unmarked(&[0xFF, 0xFE, 0, 0, b'1', 0, 0, 0]), Some("UTF-32"));
        assert!(mark(b"1 2 3").is_none() && unmarked(b"1 2 3 4 5 6").is_none());
        assert!(unmarked(&[0; 64]).is_none());
    }

    #[test]
    fn surrogate_pairs_may_cross_blocks() {
        for before in (BLOCK / 2 - 3..BLOCK / 2 + 2).chain(BLOCK - 3..BLOCK + 2) {
            let text = format!("{}\u{1F600}\u{1F601}bc", "a".repeat(before));
            let mut file: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            let mut read = String::new();
            Utf16::new(&file[..], u16::from_le_bytes).read_to_string(&mut read).expect("text");
            assert!(read == text, "{before}");
            // A surplus byte is half a code unit.
            file.push(b'd');
            read.clear();
            Utf16::new(&file[..], u16::from_le_bytes).read_to_string(&mut read).expect("text");
            assert!(read == format!("{text}?"), "{before}");
        }
        assert!(mark(&[0xFF, 0xFE, 0, 0, b'1', 0, 0, 0]).is_none());
    }
}
