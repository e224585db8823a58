//! The textual header of PPM and PFM: words separated by white space and comments.

/// The words of a header, after the magic number.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Words<'a> {
    /// Starts after the two bytes of the magic number.
    pub(super) fn after_magic(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 2.min(bytes.len()) }
    }

    /// Returns the next word; `None` at the end of the file. `#` starts a comment up to the end of the
    /// line.
    pub(super) fn word(&mut self) -> Option<&'a [u8]> {
        self.skip_space();
        let rest = &self.bytes[self.position..];
        let ends = |byte: &u8| byte.is_ascii_whitespace() || *byte == b'#';
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        self.position += length;
        if length == 0 { None } else { Some(&rest[..length]) }
    }

    /// Returns the next word as a decimal number of at most `maximum`; `what` is its name in errors.
    pub(super) fn number(&mut self, what: &str, maximum: u32) -> Result<u32, String> {
        let word = self.word().ok_or_else(|| format!("it ends before {what}; save it again"))?;
        let start = self.position - word.len();
        parse_decimal(word).filter(|&number| number <= maximum).ok_or_else(|| {
            let found = String::from_utf8_lossy(&word[..word.len().min(20)]);
            format!("at byte {start}, {what} is {found:?}; give an integer of at most {maximum}")
        })
    }

    /// Returns the data after the single white-space byte that ends the header.
    pub(super) fn raster(&self) -> &'a [u8] {
        self.bytes.get(self.position + 1..).unwrap_or_default()
    }

    /// Returns the number of bytes that have not been read.
    pub(super) fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    fn skip_space(&mut self) {
        let mut in_comment = false;
        let skipped = |&&byte: &&u8| {
            in_comment = (in_comment && byte != b'\n') || byte == b'#';
            in_comment || byte.is_ascii_whitespace()
        };
        self.position += self.bytes[self.position..].iter().take_while(skipped).count();
    }
}

fn parse_decimal(word: &[u8]) -> Option<u32> {
    word.iter().try_fold(0_u32, |number, &byte| {
        let digit = byte.is_ascii_digit().then(|| u32::from(byte - b'0'))?;
        number.checked_mul(10)?.checked_add(digit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_between_space_and_comments() {
        let mut words = Words::after_magic(b"P6 # one # two\n#three\n\t12#x\n 7\n\nrest");
        assert_eq!(words.number("the width", 12), Ok(12));
        assert_eq!(words.word(), Some(&b"7"[..]));
        assert_eq!(words.raster(), b"\nrest");
        assert_eq!(words.remaining(), 6);
    }

    #[test]
    fn invalid_numbers_are_reported_with_their_position() {
        for text in ["-1", "1.5", "99999999999999999999", "256", "x"] {
            let bytes = format!("P6 {text} ");
            let message = Words::after_magic(bytes.as_bytes()).number("maxval", 255).unwrap_err();
            assert!(message.contains("byte 3") && message.contains("maxval"), "{message}");
        }
        assert!(Words::after_magic(b"P6 #").number("maxval", 1).is_err());
        assert_eq!(Words::after_magic(b"P").raster(), b"");
    }
}
