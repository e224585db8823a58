//! First frames: the choices that all frames of a file have in common.
//!
//! The guess of radii, the direction that is up and the sizes of arrows follow from the particles of a frame. Made for each
//! frame, they would jump from frame to frame, and a single frame would not look as in its movie. So they are those of
//! the first frame of the file that has particles, whichever frames are drawn, and before any are selected.

use super::{
    ArrowStyle, FirstFrame, Frames, OpenFile, Orientation, ParticleFrame, Particles, ReadOptions,
    SharedNames, of_frame, of_frame_in, read_frame_after,
};
use crate::scene::FileError;
use std::path::Path;

impl FirstFrame {
    /// Finds the choices by the particles of the first frame that has some, before any are selected; `arrows` are those
    /// that are asked for.
    pub fn of(path: &Path, first: &Particles, arrows: Option<&ArrowStyle>) -> Self {
        // A column that is missing is an error of each frame.
        let sizes = arrows.and_then(|arrows| arrows.sizes(path, first).ok().flatten());
        Self {
            orientation: Orientation::of(first),
            guessed_radius: first.guessed_radius,
            spheres: first.spheres.len(),
            arrow_sizes: sizes.map(|sizes| sizes.0),
            arrow_limit: sizes.map(|sizes| sizes.1),
        }
    }

    /// Finds the choices by a frame as [`FirstFrame::of`]; `None` if it has no particles.
    ///
    /// # Errors
    ///
    /// Those of [`of_frame`].
    pub fn of_frame(
        path: &Path,
        first: ParticleFrame,
        options: &ReadOptions,
        arrows: Option<&ArrowStyle>,
    ) -> Result<Option<Self>, FileError> {
        let options = ReadOptions { allow_empty: true, ..options.clone() };
        let particles = of_frame(path, first, &options)?;
        Ok((!particles.spheres.is_empty()).then(|| Self::of(path, &particles, arrows)))
    }
}

/// Reads single frames of a file with the choices that they have in common, and remembers these.
#[derive(Clone, Debug, Default)]
pub struct TrajectoryReader {
    /// Types and texts, in the order in which frames have them.
    names: SharedNames,
    first_frame: Option<FirstFrame>,
    file: OpenFile,
}

impl TrajectoryReader {
    /// Creates a reader of frames that have these choices in common.
    pub fn of_first(first_frame: Option<FirstFrame>) -> Self {
        Self { first_frame, ..Self::default() }
    }

    /// Returns the choices that the frames have in common, once they are known.
    pub fn first_frame(&self) -> Option<&FirstFrame> {
        self.first_frame.as_ref()
    }

    /// Reads the spheres of the frame that the options select; `arrows` are those that are asked for.
    ///
    /// # Errors
    ///
    /// Those of [`read`](super::read).
    pub fn read(
        &mut self,
        path: &Path,
        options: &ReadOptions,
        arrows: Option<&ArrowStyle>,
    ) -> Result<Particles, FileError> {
        let (frame, has_several) = self.frame(path, options, arrows)?;
        let mut particles = of_frame_in(path, frame, options, self.first_frame.clone())?;
        if has_several && self.first_frame.is_none() && !particles.spheres.is_empty() {
            self.first_frame = Some(FirstFrame::of(path, &particles, arrows));
            particles.first_frame.clone_from(&self.first_frame);
        }
        Ok(particles)
    }

    /// Reads the frame that the options select, and the choices by the first one, if there are several.
    ///
    /// # Errors
    ///
    /// Those of [`read_frame`](super::read_frame).
    pub fn read_frame(
        &mut self,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<(ParticleFrame, Option<FirstFrame>), FileError> {
        let (frame, has_several) = self.frame(path, options, None)?;
        if has_several && self.first_frame.is_none() {
            self.first_frame = FirstFrame::of_frame(path, frame.clone(), options, None)?;
        }
        Ok((frame, self.first_frame.clone()))
    }

    /// Reads a frame as [`Self::read_frame`], with types and texts in the order that it would have if no other frame than the
    /// first one had been read.
    ///
    /// # Errors
    ///
    /// Those of [`read_frame`](super::read_frame).
    pub fn read_alone(
        &mut self,
        path: &Path,
        options: &ReadOptions,
    ) -> Result<(ParticleFrame, Option<FirstFrame>), FileError> {
        let names = self.first_frame.is_some().then(|| self.names.clone());
        let read = self.read_frame(path, options);
        if let Some(names) = names {
            self.names = names;
        }
        read
    }

    /// Returns what counts the complete frames of a file, and finds where they begin, as [`OpenFile::counter`].
    pub fn counter(
        &mut self,
        path: &Path,
        options: &ReadOptions,
    ) -> impl FnOnce() -> Result<u64, FileError> + Send + use<> {
        self.file.counter(path, options)
    }

    /// Finds the choices of a file that can be read again, and the names of its first frame. What cannot be read is an error
    /// of whoever needs it.
    pub fn of_file(path: &Path, options: &ReadOptions, arrows: Option<&ArrowStyle>) -> Self {
        let mut found = Self::default();
        let Ok(mut frames) = Frames::open(path, options) else { return found };
        let mut is_single = true;
        while let Some(Ok(frame)) = frames.next() {
            found.add_first(path, frame, options, arrows);
            is_single &= !frames.more().unwrap_or(false);
            if is_single || found.first_frame.is_some() {
                break;
            }
        }
        found.first_frame = found.first_frame.filter(|_| !is_single);
        found
    }

    /// Takes the choices of the first frame that has particles.
    pub fn add_first(
        &mut self,
        path: &Path,
        mut frame: ParticleFrame,
        options: &ReadOptions,
        arrows: Option<&ArrowStyle>,
    ) {
        self.names.intern(&mut frame);
        if self.first_frame.is_none() {
            self.first_frame = FirstFrame::of_frame(path, frame, options, arrows).ok().flatten();
        }
    }

    /// Converts a frame to spheres, with types and texts in the common order.
    ///
    /// # Errors
    ///
    /// Those of [`of_frame`].
    pub fn particles(
        &mut self,
        path: &Path,
        mut frame: ParticleFrame,
        options: &ReadOptions,
    ) -> Result<Particles, FileError> {
        self.names.intern(&mut frame);
        of_frame_in(path, frame, options, self.first_frame.clone())
    }

    /// Returns the types and texts of the frames so far.
    pub fn names(&self) -> &SharedNames {
        &self.names
    }

    fn frame(
        &mut self,
        path: &Path,
        options: &ReadOptions,
        arrows: Option<&ArrowStyle>,
    ) -> Result<(ParticleFrame, bool), FileError> {
        let Self { names, first_frame, file } = self;
        let (mut frame, has_several) = if first_frame.is_some() {
            (file.read(path, options)?, true)
        } else {
            let mut look = |mut first: ParticleFrame| {
                names.intern(&mut first);
                // What is wrong with another frame is no fault of this one.
                let found = FirstFrame::of_frame(path, first, options, arrows);
                let is_done = !matches!(found, Ok(None));
                *first_frame = found.ok().flatten();
                Ok(is_done)
            };
            read_frame_after(path, options, &mut look)?
        };
        if has_several {
            names.intern(&mut frame);
        }
        Ok((frame, has_several))
    }
}
