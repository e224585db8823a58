//! Metadata of image files: settings, seed, version.

use super::ImageError;
use std::fmt::Write as _;

/// Ordered pairs of key and value, as stored in PNG text chunks, PPM comments, EXR comments or XMP.
///
/// A key has 1 to 79 printable ASCII characters without a colon, and no leading, trailing or
/// consecutive spaces (the rule of PNG; the colon separates key and value elsewhere). A value is any
/// text without NUL.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    entries: Vec<(String, String)>,
}

impl Metadata {
    /// Returns empty metadata.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an entry at the end; it is checked when it is written.
    pub fn push(&mut self, key: impl Into<String>, value: impl Into<String>) {
        self.entries.push((key.into(), value.into()));
    }

    /// Returns keys and values in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }

    /// Returns the value of the first entry with this key.
    pub fn value(&self, key: &str) -> Option<&str> {
        self.iter().find(|entry| entry.0 == key).map(|entry| entry.1)
    }

    /// Returns whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Returns an error for entries that one of the formats cannot store.
    pub(super) fn check(&self) -> Result<(), ImageError> {
        let refuse = |key: &str, reason| Err(ImageError::Metadata { key: key.to_owned(), reason });
        for (key, value) in self.iter() {
            let plain = key.bytes().all(|byte| (b' '..=b'~').contains(&byte) && byte != b':');
            if !plain || key.is_empty() || key.len() > 79 {
                return refuse(
                    key,
                    "give a key of 1 to 79 printable ASCII characters without a colon",
                );
            }
            if key.trim() != key || key.contains("  ") {
                return refuse(key, "remove leading, trailing and double spaces from the key");
            }
            if value.contains('\0') {
                return refuse(key, "remove the NUL character from its value");
            }
        }
        Ok(())
    }

    /// Returns a line `key: value` per entry, each after `prefix`. Backslashes and line breaks are
    /// escaped.
    pub(super) fn to_lines(&self, prefix: &str) -> String {
        let mut lines = String::new();
        for (key, value) in self.iter() {
            let value = value.replace('\\', "\\\\").replace('\n', "\\n").replace('\r', "\\r");
            // Writing to a string cannot fail.
            let _ = writeln!(lines, "{prefix}{key}: {value}");
        }
        lines
    }

    /// Parses entries from lines without prefix; lines of another form (comments of other programs) are
    /// ignored.
    pub(super) fn from_lines<'a>(lines: impl Iterator<Item = &'a str>) -> Self {
        lines
            .filter_map(|line| line.split_once(": "))
            .map(|(key, value)| (key.to_owned(), unescape(value)))
            .collect()
    }
}

impl FromIterator<(String, String)> for Metadata {
    fn from_iter<I: IntoIterator<Item = (String, String)>>(entries: I) -> Self {
        Self { entries: entries.into_iter().collect() }
    }
}

/// Reverts the escapes of [`Metadata::to_lines`]; an unknown escape stands for its own character.
fn unescape(text: &str) -> String {
    let mut characters = text.chars();
    let next = || {
        let character = characters.next()?;
        if character != '\\' {
            return Some(character);
        }
        Some(match characters.next() {
            Some('n') => '\n',
            Some('r') => '\r',
            Some(other) => other,
            None => '\\',
        })
    };
    std::iter::from_fn(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Image, WriteOptions, read_metadata};

    fn entries(pairs: &[(&str, &str)]) -> Metadata {
        pairs.iter().map(|&(key, value)| (key.to_owned(), value.to_owned())).collect()
    }

    #[test]
    fn metadata_survives_in_order_in_all_formats_that_store_it() {
        let folder = tempfile::tempdir().unwrap();
        let latin = entries(&[("seed", "7"), ("a b", "caf\u{e9}"), ("Title", "two\nlines\r\\n")]);
        let unicode =
            entries(&[("z", "\u{3b1}\u{1f310}"), ("a", ""), ("seed", "x: y"), ("seed", "2")]);
        for metadata in [latin, unicode, Metadata::new()] {
            for name in ["a.png", "a.exr", "a.ppm", "a.jpg", "a.tiff", "a.webp"] {
                let path = folder.path().join(name);
                let options =
                    WriteOptions { metadata: metadata.clone(), ..WriteOptions::default() };
                Image::filled(2, 2, [0.5; 3]).unwrap().write(&path, &options).unwrap();
                assert_eq!(read_metadata(&path).unwrap(), metadata, "{name}");
                assert!(Image::read(&path).is_ok());
            }
        }
    }

    #[test]
    fn pfm_has_no_metadata() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pfm");
        let options =
            WriteOptions { metadata: entries(&[("seed", "7")]), ..WriteOptions::default() };
        Image::filled(1, 1, [0.5; 3]).unwrap().write(&path, &options).unwrap();
        assert!(read_metadata(&path).unwrap().is_empty());
    }

    #[test]
    fn entries_that_cannot_be_written_are_refused() {
        let long = "k".repeat(80);
        for key in ["", " a", "a ", "a  b", "a:b", "a\nb", "\u{e9}", &long] {
            assert!(entries(&[(key, "v")]).check().is_err(), "{key:?}");
        }
        assert!(entries(&[("k", "a\0b")]).check().is_err());
        assert!(entries(&[("a b", "v:\n")]).check().is_ok());
    }

    #[test]
    fn claimed_lengths_take_no_memory() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.webp");
        let metadata = entries(&[("seed", "7")]);
        let options = WriteOptions { metadata, ..WriteOptions::default() };
        Image::filled(2, 2, [0.5; 3]).unwrap().write(&path, &options).unwrap();
        let mut bytes = std::fs::read(&path).unwrap();
        let at = bytes.windows(4).position(|name| name == b"XMP ").unwrap();
        bytes[at + 4..at + 8].copy_from_slice(&[0, 0, 0, 0xF0]);
        bytes[4..8].copy_from_slice(&[0xFF; 4]);
        std::fs::write(&path, bytes).unwrap();
        assert!(read_metadata(&path).is_err());
    }

    #[test]
    fn values_are_found_by_key() {
        let metadata = entries(&[("a", "1"), ("b", "2"), ("a", "3")]);
        assert_eq!(metadata.value("a"), Some("1"));
        assert_eq!(metadata.value("c"), None);
    }

    #[test]
    fn escapes_are_reverted_and_other_lines_ignored() {
        assert_eq!(unescape(r"a\\n\nb\r\x\"), "a\\n\nb\rx\\");
        assert_eq!(Metadata::from_lines("by hand\nk: v".lines()), entries(&[("k", "v")]));
    }
}
