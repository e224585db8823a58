//! Frames of a file, one after another.

use super::frame::ParticleFrame;
use super::frame_reader::FrameReader;
use super::options::{Format, FrameChoice, ReadOptions};
use super::source::{Source, is_standard_input};
use super::{cif, csv, gro, gsd, lammps, numpy, pdb, ply, sniff, text, xyz};
use crate::FileError;
use std::path::Path;

/// The frames of a file of particles, read one at a time. After an error there are no more.
pub struct Frames {
    reader: Box<dyn FrameReader>,
    failed: bool,
}

impl Frames {
    /// Opens a file, or standard input for the path `-`, whatever frame the options choose.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or is in no format known here.
    pub fn open(path: &Path, options: &ReadOptions) -> Result<Self, FileError> {
        let source = Source::open(path, &options.progress)?;
        let format = sniff::format(&source, options)?;
        let reader: Box<dyn FrameReader> = match format {
            Format::Xyzr => Box::new(text::Rows::new(source, options)),
            Format::Csv => Box::new(csv::Csv::new(source, options)),
            Format::Xyz => Box::new(xyz::Xyz::new(source, options)),
            Format::LammpsDump => Box::new(lammps::Dump::new(source, options)),
            Format::LammpsData => Box::new(lammps::Data::new(source, options)),
            Format::Gro => Box::new(gro::Gro::new(source, options)),
            Format::Pdb => Box::new(pdb::Pdb::new(source, options)),
            Format::MmCif => Box::new(cif::MmCif::new(source, options)),
            Format::Cif => Box::new(cif::Crystal::new(source, options)),
            Format::Gsd => Box::new(gsd::Gsd::new(source, options)?),
            Format::Ply => Box::new(ply::Ply::new(source, options)),
            Format::Npy => Box::new(numpy::Npy::new(source, options)?),
            Format::Npz => Box::new(numpy::Npz::new(source, options)?),
        };
        Ok(Self { reader, failed: false })
    }

    /// Passes over the next frame, with as little work as the format allows; whether there was one.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or holds something that is not a particle, as far as it is looked at.
    pub fn skip_frame(&mut self) -> Result<bool, FileError> {
        let skipped = if self.failed { Ok(false) } else { self.reader.skip() };
        self.failed |= skipped.is_err();
        skipped
    }
}

impl Iterator for Frames {
    type Item = Result<ParticleFrame, FileError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let frame = next_frame(&mut *self.reader);
        self.failed = frame.is_err();
        frame.transpose()
    }
}

/// The next frame, with warnings of what is in its columns and not drawn.
fn next_frame(reader: &mut dyn FrameReader) -> Result<Option<ParticleFrame>, FileError> {
    let mut frame = reader.next()?;
    frame.iter_mut().for_each(ParticleFrame::add_undrawn_columns);
    Ok(frame)
}

/// Reads the frame that the options choose, as it is: nothing is scaled or dropped. Frames before
/// it are passed over with little work; for the last one, a file is gone through twice, and a frame
/// that is cut off is not counted.
///
/// # Errors
///
/// The file cannot be read, is cut off, has no such frame, or holds something that is not a
/// particle: the error names the line and the column.
pub fn read_frame(path: &Path, options: &ReadOptions) -> Result<ParticleFrame, FileError> {
    let index = match options.frame {
        FrameChoice::Index(index) => index,
        FrameChoice::Last if is_standard_input(path) => return last_of_stream(path, options),
        FrameChoice::Last => count_frames(path, options)?.saturating_sub(1),
    };
    let mut frames = Frames::open(path, options)?;
    for before in 0..index {
        if !frames.reader.skip()? {
            let message = format!("has no frame {index}, but {before}, and the first is 0");
            return Err(FileError::whole_file(path, message));
        }
    }
    let frame = next_frame(&mut *frames.reader)?;
    let mut frame = match (frame, index) {
        (Some(frame), _) => frame,
        (None, 0) => return Err(FileError::whole_file(path, "holds no particles")),
        (None, count) => {
            let message = format!("has no frame {index}, but {count}, and the first is 0");
            return Err(FileError::whole_file(path, message));
        }
    };
    if options.frame == FrameChoice::default() && frames.reader.more()? {
        frame
            .warnings
            .push("only the first of several frames is read; --frame chooses others".to_owned());
    }
    Ok(frame)
}

/// The last frame of what can be read but once.
fn last_of_stream(path: &Path, options: &ReadOptions) -> Result<ParticleFrame, FileError> {
    let mut last = None;
    for frame in Frames::open(path, options)? {
        last = Some(frame?);
    }
    last.ok_or_else(|| FileError::whole_file(path, "holds no particles"))
}

/// Frames of a file, counted with as little work as the format allows.
#[derive(Clone, Debug)]
pub struct FrameCount {
    /// Frames that are not cut off, as far as they were counted.
    pub whole: u64,
    /// Why nothing after them can be read, if that is not simply because the file ends there. A last
    /// frame that is cut off may be missing here too: reading it tells.
    pub rest: Option<FileError>,
}

impl FrameCount {
    /// Counts the frames of a file, up to `most` of them.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or is in no format known here.
    pub fn of(path: &Path, options: &ReadOptions, most: u64) -> Result<Self, FileError> {
        let mut frames = Frames::open(path, options)?;
        let mut whole = 0;
        while whole < most {
            match frames.skip_frame() {
                Ok(true) => whole += 1,
                Ok(false) => break,
                Err(error) => return Ok(Self { whole, rest: Some(error) }),
            }
        }
        Ok(Self { whole, rest: None })
    }
}

/// Number of complete frames in a file.
///
/// # Errors
///
/// The file cannot be read, or is in no format known here.
pub fn count_frames(path: &Path, options: &ReadOptions) -> Result<u64, FileError> {
    let mut frames = Frames::open(path, options)?;
    let mut count = 0;
    while frames.reader.skip()? {
        count += 1;
    }
    Ok(count)
}
