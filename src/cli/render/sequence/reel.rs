//! Frames of a file, forward and one at a time.

use crate::cli::failure::Failure;
use spherule::scene::FileError;
use spherule::scene::particles::{Frames, ParticleFrame, ReadOptions};
use std::path::Path;

/// A file that is read frame by frame.
pub(super) struct Reel {
    frames: Frames,
    /// Frames that were read or passed over.
    passed: u64,
    /// The last one, and its number, if it may be asked for again.
    held: Option<(u64, ParticleFrame)>,
}

impl Reel {
    pub(super) fn open(path: &Path, options: &ReadOptions) -> Result<Self, Failure> {
        Ok(Self { frames: Frames::open(path, options)?, passed: 0, held: None })
    }

    /// Frames that were read or passed over.
    pub(super) fn passed(&self) -> u64 {
        self.passed
    }

    /// A frame that is not before the last one; `None` if there are fewer.
    pub(super) fn take(&mut self, number: u64) -> Result<Option<ParticleFrame>, Failure> {
        if let Some((_, frame)) = self.held.take_if(|(held, _)| *held == number) {
            return Ok(Some(frame));
        }
        self.held = None;
        if number > 0 && !self.pass(number - 1)? {
            return Ok(None);
        }
        let failure = |error| Failure::from(error).of_frame(number);
        let frame = self.frames.next().transpose().map_err(failure)?;
        self.passed += u64::from(frame.is_some());
        Ok(frame)
    }

    /// Passes over all frames up to this one; whether there are so many.
    pub(super) fn pass(&mut self, number: u64) -> Result<bool, Failure> {
        while self.passed <= number {
            let failure = |error| Failure::from(error).of_frame(self.passed);
            if !self.frames.skip_frame().map_err(failure)? {
                return Ok(false);
            }
            self.passed += 1;
        }
        Ok(true)
    }

    /// The same as [`Self::take`], of a frame that will be asked for once more.
    pub(super) fn look(&mut self, number: u64) -> Result<Option<ParticleFrame>, Failure> {
        let frame = self.take(number)?;
        self.held = frame.clone().map(|frame| (number, frame));
        Ok(frame)
    }

    /// Why nothing can be read after so many frames, if that is not simply because the file ends.
    pub(super) fn rest(&mut self, count: u64) -> Option<FileError> {
        while self.passed < count {
            if !self.frames.skip_frame().ok()? {
                return None;
            }
            self.passed += 1;
        }
        self.frames.next()?.err()
    }
}
