//! Sequential reading of trajectory frames.

use crate::cli::failure::Failure;
use spherule_render::scene::FileError;
use spherule_render::scene::particles::{Frames, ParticleFrame, ReadOptions};
use std::path::Path;

/// A trajectory that is read frame by frame.
pub(super) struct FrameReader {
    frames: Frames,
    /// Number of frames that were read or skipped.
    passed: u64,
    /// The last frame and its number, if it may be requested again.
    held: Option<(u64, ParticleFrame)>,
}

impl FrameReader {
    pub(super) fn open(path: &Path, options: &ReadOptions) -> Result<Self, Failure> {
        Ok(Self { frames: Frames::open(path, options)?, passed: 0, held: None })
    }

    /// Number of frames that were read or skipped.
    pub(super) fn passed(&self) -> u64 {
        self.passed
    }

    /// Returns a frame that is not before the last one; `None` if there are fewer frames.
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

    /// Skips all frames up to this one; returns whether it exists.
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

    /// Returns a frame as [`Self::take`], and keeps it for another request.
    pub(super) fn look(&mut self, number: u64) -> Result<Option<ParticleFrame>, Failure> {
        let frame = self.take(number)?;
        self.held = frame.clone().map(|frame| (number, frame));
        Ok(frame)
    }

    /// Returns the error after this many frames, unless the file simply ends.
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
