//! Readers for files of particles.
//!
//! Every reader streams: it keeps columns, never the file, and believes no count that the file
//! claims. Rows whose numbers are not finite, or whose radius is not more than 0, are dropped and
//! counted in a warning; anything that is no number at all is an error with its line. A further
//! format is a [`Format`], a sign to tell it by in `sniff`, and a function from lines to `Sink`.

mod columns;
mod elements;
mod header;
mod lines;
mod sink;
mod sniff;
mod text;
mod xyz;

use self::lines::Lines;
use self::sink::Sink;
use super::{SceneError, Spheres};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// How a file of particles is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A row `x y z` or `x y z radius` for each particle, with blanks, commas or semicolons between
    /// the numbers; `#` begins a comment.
    Xyzr,
    /// A header that names columns, and a row for each particle; commas, semicolons or tabs between
    /// them.
    Csv,
    /// XYZ of chemistry: the number of atoms, a comment, and a row `symbol x y z` for each; the
    /// first frame.
    Xyz,
}

/// How to read a file of particles.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// `None`: told from the content.
    pub format: Option<Format>,
    /// Radius where the file has none, more than 0, not scaled. `None`: the element's for atoms, or
    /// else half of the mean spacing.
    pub radius: Option<f64>,
    /// Factor on the file's positions and radii, more than 0.
    pub scale: f64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { format: None, radius: None, scale: 1.0 }
    }
}

/// What a file of particles holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    /// The spheres, at least one; materials are rows of `material_names`.
    pub spheres: Spheres,
    /// The materials that the file speaks of; an empty name stands for none.
    pub material_names: Vec<String>,
    /// What was dropped or assumed.
    pub warnings: Vec<String>,
}

/// Reads the particles of a file.
///
/// # Errors
///
/// The file cannot be read, is cut off, or holds something that is not a particle.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Particles, SceneError> {
    let unreadable =
        |error: std::io::Error| SceneError::whole_file(path, format!("cannot be read: {error}"));
    let file = File::open(path).map_err(unreadable)?;
    let mut reader = BufReader::with_capacity(sniff::HEAD, file);
    let format = sniff::format(path, &mut reader, options.format)?;
    let mut sink = Sink::new(path, options);
    match format {
        Format::Xyzr => text::read(&mut Lines::new(path, reader), &mut sink)?,
        Format::Csv => columns::read(path, reader, &mut sink)?,
        Format::Xyz => xyz::read(&mut Lines::new(path, reader), &mut sink)?,
    }
    sink.finish()
}

#[cfg(test)]
mod tests;
