//! Figures: pages of HTML with an image, or with several that are turned or played, and texts of what they show. They need no
//! server and no other file.

use super::svg::{base64, escaped};
use crate::image::Format;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::Write;

/// The page, with names in braces for what is put in.
const PAGE: &str = include_str!("figure.html");

/// Largest number of bytes of a text's number.
const BYTES: usize = 4;

/// A page of images.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    title: String,
    /// True if the last image precedes the first one, as in a turn.
    is_turn: bool,
    /// Width and height of the images in pixels.
    size: (u32, u32),
    images: Vec<Shown>,
    /// The texts in the order of their numbers, from 1.
    texts: Vec<String>,
    numbers: HashMap<String, u32>,
}

/// An image.
#[derive(Clone, Debug)]
struct Shown {
    format: Format,
    file: Vec<u8>,
    /// The text of each pixel, compressed.
    numbers: Vec<u8>,
}

impl Figure {
    /// Creates a page without images; in a turn, the last image precedes the first one.
    pub fn new(title: &str, is_turn: bool) -> Self {
        Self { title: title.to_owned(), is_turn, ..Self::default() }
    }

    /// Returns the number of a text, from 1.
    pub fn number(&mut self, text: &str) -> u32 {
        if let Some(&number) = self.numbers.get(text) {
            return number;
        }
        self.texts.push(text.replace('\n', " "));
        let number = self.texts.len() as u32;
        self.numbers.insert(text.to_owned(), number);
        number
    }

    /// Adds an image file of this size; `numbers` are those of the text of each pixel, row by row from the top left, and 0
    /// where there is none.
    ///
    /// # Panics
    /// `numbers` has another length.
    pub fn add(&mut self, format: Format, file: Vec<u8>, size: (u32, u32), numbers: &[u32]) {
        assert_eq!(
            numbers.len() as u64,
            u64::from(size.0) * u64::from(size.1),
            "a text for each pixel"
        );
        self.size = size;
        let numbers = compressed(&planes(numbers, size.0 as usize));
        self.images.push(Shown { format, file, numbers });
    }

    /// Returns the number of images.
    pub fn len(&self) -> usize {
        self.images.len()
    }

    /// Returns whether there are no images.
    pub fn is_empty(&self) -> bool {
        self.images.is_empty()
    }

    /// Returns the content of the file.
    pub fn file(&self) -> String {
        let title = escaped(&self.title);
        let (width, height) = self.size;
        let several = self.images.len() > 1;
        let mut images = String::new();
        for (index, Shown { format, file, numbers }) in self.images.iter().enumerate() {
            let kind = if *format == Format::Jpeg { "jpeg" } else { "png" };
            let alt = match index {
                _ if !several => title.clone(),
                0 => format!("{title}, image 1 of {}", self.images.len()),
                // The first stands for all.
                _ => String::new(),
            };
            let hidden = if index > 0 { " hidden" } else { "" };
            // Writing to a string does not fail.
            let _ = writeln!(
                images,
                "<img{hidden} width=\"{width}\" height=\"{height}\" alt=\"{alt}\" draggable=\"false\" data-numbers=\"{}\" \
                 src=\"data:image/{kind};base64,{}\">",
                base64(numbers),
                base64(file)
            );
        }
        let texts = base64(&compressed(self.texts.join("\n").as_bytes()));
        let last = self.images.len().saturating_sub(1).to_string();
        let (hidden, turns) = (if several { "" } else { " hidden" }, self.is_turn.to_string());
        let what = if self.is_turn { "Turn" } else { "Frame" };
        let help = match (several, self.texts.is_empty()) {
            (true, _) if self.is_turn => "Drag, or use the arrow keys, to turn. ",
            (true, _) => "Drag, or use the arrow keys, to go through the frames. ",
            (false, _) => "",
        };
        let names = if self.texts.is_empty() { "" } else { "Point at a particle for its name." };
        filled(&[
            ("{title}", title.as_str()),
            ("{width}", &width.to_string()),
            ("{height}", &height.to_string()),
            ("{last}", &last),
            ("{hidden}", hidden),
            ("{turns}", &turns),
            ("{what}", what),
            ("{help}", &format!("{help}{names}")),
            ("{texts}", &texts),
            ("{images}", &images),
        ])
    }
}

/// Returns the page with values in place of names.
fn filled(values: &[(&str, &str)]) -> String {
    let (mut page, mut rest) = (String::new(), PAGE);
    while let Some(at) = rest.find('{') {
        page += &rest[..at];
        rest = &rest[at..];
        let found = values.iter().find(|(name, _)| rest.starts_with(name));
        let (name, value) = *found.unwrap_or(&("{", "{"));
        page += value;
        rest = &rest[name.len()..];
    }
    page + rest
}

/// Returns numbers as planes of their bytes, lowest first; each byte without what the pixel above has in common, so that spheres
/// compress well.
fn planes(numbers: &[u32], width: usize) -> Vec<u8> {
    let most = numbers.iter().copied().max().unwrap_or(0);
    let used = (BYTES - most.leading_zeros() as usize / 8).max(1);
    let above = |at: usize| at.checked_sub(width).map_or(0, |above| numbers[above]);
    let plane = |byte: usize| {
        let changed = numbers.iter().enumerate().map(move |(at, number)| number ^ above(at));
        changed.map(move |bits| bits.to_le_bytes()[byte])
    };
    (0..used).flat_map(plane).collect()
}

fn compressed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // Writing to memory does not fail.
    let _ = encoder.write_all(bytes);
    encoder.finish().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn numbers_come_back() {
        let (width, height) = (7, 5);
        let numbers: Vec<u32> = (0..width * height).map(|at| at / 3 * 300).collect();
        let mut bytes = Vec::new();
        let file = compressed(&planes(&numbers, width as usize));
        ZlibDecoder::new(&file[..]).read_to_end(&mut bytes).expect("bytes");
        assert_eq!(bytes.len(), 2 * numbers.len());
        let mut found = vec![0; numbers.len()];
        for at in 0..numbers.len() {
            let bits = u32::from(bytes[at]) | u32::from(bytes[numbers.len() + at]) << 8;
            found[at] = bits ^ if at < width as usize { 0 } else { found[at - width as usize] };
        }
        assert_eq!(found, numbers);
    }

    #[test]
    fn pages_hold_their_images_and_escape_their_title() {
        let mut figure = Figure::new("a <b> {images}", true);
        assert_eq!(["x", "y", "x"].map(|text| figure.number(text)), [1, 2, 1]);
        figure.add(Format::Png, b"one".to_vec(), (2, 1), &[0, 1]);
        assert!(figure.file().contains("aria-label=\"Turn\" hidden"));
        figure.add(Format::Jpeg, b"two".to_vec(), (2, 1), &[2, 1]);
        let page = figure.file();
        assert!(page.contains("<title>a &lt;b&gt;"), "{page}");
        assert_eq!(["<img ", "<img hidden"].map(|tag| page.matches(tag).count()), [2, 1]);
        assert!(page.contains("alt=\"a &lt;b&gt; {images}, image 1 of 2\""), "{page}");
        assert!(page.contains("image/png;base64,b25l") && page.contains("image/jpeg;base64,dHdv"));
        assert!(page.contains("max=\"1\"") && !page.contains("http"), "{page}");
    }
}
