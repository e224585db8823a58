//! Splits lines into fields.

/// Set of separator bytes.
type Separators = [bool; 256];

const BLANKS: Separators = set(b" \t\r\x0B\x0C");
const MARKS: Separators = set(b" \t\r\x0B\x0C,;");

const LISTS: Separators = set(b" \t\r[],'\"");

const fn set(bytes: &[u8]) -> Separators {
    let mut table = [false; 256];
    let mut at = 0;
    while at < bytes.len() {
        table[bytes[at] as usize] = true;
        at += 1;
    }
    table
}

/// Returns the bytes of a line in fixed columns, counted from 0, clamped to its length and trimmed.
pub(crate) fn fixed(line: &[u8], start: usize, end: usize) -> &[u8] {
    line.get(start..end.min(line.len())).unwrap_or_default().trim_ascii()
}

/// Iterator over the non-empty fields of a line.
#[derive(Clone)]
pub(crate) struct Fields<'l> {
    rest: &'l [u8],
    separators: &'static Separators,
}

impl<'l> Fields<'l> {
    /// Returns the blank-separated fields.
    #[inline]
    pub(crate) fn blanks(line: &'l [u8]) -> Self {
        Self { rest: line, separators: &BLANKS }
    }

    /// Returns the items of a list in brackets, after the dash of a list of lists.
    pub(crate) fn list(line: &'l [u8]) -> Self {
        let line = line.trim_ascii_start();
        Self { rest: line.strip_prefix(b"- ").unwrap_or(line), separators: &LISTS }
    }

    /// Returns the fields separated by blanks, commas or semicolons, up to a `#`.
    #[inline]
    pub(crate) fn marks(line: &'l [u8]) -> Self {
        let end = memchr::memchr(b'#', line).unwrap_or(line.len());
        Self { rest: &line[..end], separators: &MARKS }
    }
}

impl<'l> Iterator for Fields<'l> {
    type Item = &'l [u8];

    #[inline]
    fn next(&mut self) -> Option<&'l [u8]> {
        let is_between = |byte: &u8| self.separators[*byte as usize];
        let start = self.rest.iter().position(|byte| !is_between(byte))?;
        let rest = &self.rest[start..];
        let end = rest.iter().position(is_between).unwrap_or(rest.len());
        self.rest = &rest[end..];
        Some(&rest[..end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(fields: Fields) -> Vec<String> {
        fields.map(|field| String::from_utf8_lossy(field).into_owned()).collect()
    }

    #[test]
    fn fields_are_never_empty() {
        assert_eq!(texts(Fields::blanks(b" a\t b,c  ")), ["a", "b,c"]);
        assert_eq!(texts(Fields::marks(b",1;;2 # 3")), ["1", "2"]);
        assert_eq!(texts(Fields::list(b"  - [ -1, 'b', ]")), ["-1", "b"]);
        assert!(texts(Fields::blanks(b" \t ")).is_empty());
        assert!(texts(Fields::marks(b"")).is_empty());
    }
}
