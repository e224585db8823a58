//! Warnings and notes about the images of a run, each printed once.

use crate::cli::output;
use crate::cli::ranges::ranges;
use std::collections::BTreeMap;
use std::path::Path;

/// Maximum number of ranges in a message.
const LISTED: usize = 8;

/// Messages about the images so far.
#[derive(Debug, Default)]
pub(super) struct Notices {
    /// Number of the current image: its frame, or its place in the turntable.
    picture: u64,
    pictures: u64,
    /// Warnings by their text without numbers: the printed text, and the images that it applies to.
    warnings: BTreeMap<String, (String, Vec<u64>)>,
    notes: Vec<String>,
    /// Images that show no sphere.
    empty: Vec<u64>,
    /// Images whose spheres are partly beyond their edges.
    cropped: Vec<u64>,
    /// Number of images that existed and were kept.
    kept: u64,
}

impl Notices {
    /// Starts the messages about an image.
    pub(super) fn start_picture(&mut self, picture: u64) {
        self.picture = picture;
        self.pictures += 1;
    }

    /// Prints a warning, unless an earlier image had the same one but for its numbers.
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

    /// Prints a note, unless it was printed before.
    pub(super) fn note(&mut self, text: &str) {
        if self.notes.iter().all(|printed| printed != text) {
            output::note(text);
            self.notes.push(text.to_owned());
        }
    }

    /// Counts an image that exists and is kept; prints a note about it if `print` is true.
    pub(super) fn count_kept(&mut self, output: &Path, print: bool) {
        self.kept += 1;
        if print {
            output::note(format_args!("{}: already exists, skipped", output.display()));
        }
    }

    /// Returns the number of images so far.
    pub(super) fn pictures(&self) -> u64 {
        self.pictures
    }

    /// Returns the number of images that existed and were kept.
    pub(super) fn kept(&self) -> u64 {
        self.kept
    }

    /// Counts the current image among those that show no sphere.
    pub(super) fn count_empty(&mut self) {
        self.empty.push(self.picture);
    }

    /// Counts the current image among those with spheres beyond their edges.
    pub(super) fn count_cropped(&mut self) {
        self.cropped.push(self.picture);
    }

    /// Prints the warnings that count images, at the end of a sequence; `noun` names their numbers.
    pub(super) fn summarize(&self, noun: &str) {
        let pictures = self.pictures;
        if !self.empty.is_empty() {
            let (count, list) = (self.empty.len(), ranges(&self.empty, LISTED));
            output::warn(format_args!(
                "no sphere is visible in {count} of {pictures} images: {noun} {list}"
            ));
        }
        if !self.cropped.is_empty() {
            let (count, list) = (self.cropped.len(), ranges(&self.cropped, LISTED));
            output::warn(format_args!(
                "spheres are outside the view in {count} of {pictures} images: {noun} {list}; the camera is \
                 placed for the first one; write the input to a file to place it for all"
            ));
        }
        // A warning about all images needs no list.
        let some = |list: &[u64]| list.len() > 1 && (list.len() as u64) < pictures;
        for (text, list) in self.warnings.values().filter(|(_, list)| some(list)) {
            let (count, list) = (list.len(), ranges(list, LISTED));
            output::warn(format_args!(
                "in {count} of {pictures} images, {noun} {list}, as in the first: {text}"
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_that_differ_in_numbers_are_merged() {
        let mut notices = Notices::default();
        for (picture, text) in
            [(0, "1 of 9 rows"), (1, "2 of 9 rows"), (1, "other"), (2, "3 of 9 rows")]
        {
            notices.start_picture(picture);
            notices.warn(text);
        }
        let lists: Vec<_> = notices.warnings.values().cloned().collect();
        assert_eq!(
            lists,
            [("1 of 9 rows".to_owned(), vec![0, 1, 2]), ("other".to_owned(), vec![1])]
        );
    }
}
