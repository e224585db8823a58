//! Warnings and notes of many pictures, each told once.

use crate::cli::output;
use std::collections::BTreeMap;
use std::path::Path;

/// Most runs of numbers that a message lists.
const LISTED: usize = 8;

/// Messages about the pictures so far.
#[derive(Debug, Default)]
pub(super) struct Told {
    /// The picture that is spoken of: its frame, or its number.
    picture: u64,
    pictures: u64,
    /// Warnings by their words, without numbers: as they were told first, and the pictures that have
    /// them.
    warnings: BTreeMap<String, (String, Vec<u64>)>,
    notes: Vec<String>,
    /// Pictures that show no sphere.
    empty: Vec<u64>,
    /// Pictures whose spheres are partly beyond their edges.
    cropped: Vec<u64>,
    /// Number of pictures that existed and were kept.
    kept: u64,
}

impl Told {
    /// Speaks of another picture from here on.
    pub(super) fn begin(&mut self, picture: u64) {
        self.picture = picture;
        self.pictures += 1;
    }

    /// Warns, unless an earlier picture had the same warning, whatever its numbers.
    pub(super) fn warn(&mut self, text: &str) {
        let words = text.chars().filter(|c| !c.is_ascii_digit()).collect();
        let (_, pictures) = self.warnings.entry(words).or_insert_with(|| {
            output::warn(text);
            (text.to_owned(), Vec::new())
        });
        if pictures.last() != Some(&self.picture) {
            pictures.push(self.picture);
        }
    }

    /// Notes something, once.
    pub(super) fn note(&mut self, text: &str) {
        if self.notes.iter().all(|told| told != text) {
            output::note(text);
            self.notes.push(text.to_owned());
        }
    }

    /// Counts a picture that exists and is kept, and says so if it is asked to.
    pub(super) fn keep(&mut self, output: &Path, tell: bool) {
        self.kept += 1;
        if tell {
            output::note(format_args!("{}: exists and is kept", output.display()));
        }
    }

    /// Returns the number of pictures so far.
    pub(super) fn pictures(&self) -> u64 {
        self.pictures
    }

    /// Returns the number of pictures that existed and were kept.
    pub(super) fn kept(&self) -> u64 {
        self.kept
    }

    /// Remembers that the picture shows no sphere.
    pub(super) fn see_no_sphere(&mut self) {
        self.empty.push(self.picture);
    }

    /// Remembers that spheres of the picture are beyond its edges.
    pub(super) fn see_cropped(&mut self) {
        self.cropped.push(self.picture);
    }

    /// Tells what is known at the end of a sequence of pictures, which are called by a noun.
    pub(super) fn finish(&self, noun: &str) {
        let pictures = self.pictures;
        if !self.empty.is_empty() {
            let (count, list) = (self.empty.len(), runs(&self.empty));
            output::warn(format_args!(
                "no sphere is visible in {count} of {pictures} pictures: {noun} {list}"
            ));
        }
        if !self.cropped.is_empty() {
            let (count, list) = (self.cropped.len(), runs(&self.cropped));
            output::warn(format_args!(
                "spheres lie outside of {count} of {pictures} pictures, whose camera frames the first \
                 one alone: {noun} {list}; write the input to a file to frame all of them"
            ));
        }
        // What holds for all of them needs no list.
        let some = |list: &[u64]| list.len() > 1 && (list.len() as u64) < pictures;
        for (text, list) in self.warnings.values().filter(|(_, list)| some(list)) {
            let (count, list) = (list.len(), runs(list));
            output::warn(format_args!(
                "in {count} of {pictures} pictures, {noun} {list}, as said of the first: {text}"
            ));
        }
    }
}

/// Numbers in ascending order as a list: `3, 5-9`.
fn runs(numbers: &[u64]) -> String {
    let mut runs: Vec<[u64; 2]> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some([_, last]) if *last + 1 >= number => *last = number,
            _ => runs.push([number; 2]),
        }
    }
    let text = |[first, last]: &[u64; 2]| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    let more = if runs.len() > LISTED { ", ..." } else { "" };
    runs.iter().take(LISTED).map(text).collect::<Vec<_>>().join(", ") + more
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_a_row_are_runs() {
        assert_eq!(runs(&[3, 5, 6, 7, 9]), "3, 5-7, 9");
        assert_eq!(runs(&[4]), "4");
        let odd: Vec<u64> = (0..20).map(|i| 2 * i).collect();
        assert_eq!(runs(&odd), "0, 2, 4, 6, 8, 10, 12, 14, ...");
    }

    #[test]
    fn warnings_that_differ_in_numbers_are_one() {
        let mut told = Told::default();
        for (picture, text) in
            [(0, "1 of 9 rows"), (1, "2 of 9 rows"), (1, "other"), (2, "3 of 9 rows")]
        {
            told.begin(picture);
            told.warn(text);
        }
        let lists: Vec<_> = told.warnings.values().cloned().collect();
        assert_eq!(
            lists,
            [("1 of 9 rows".to_owned(), vec![0, 1, 2]), ("other".to_owned(), vec![1])]
        );
    }
}
