//! The interface of readers: frames of a file, one after another.

use super::frame::ParticleFrame;
use crate::FileError;

/// A file that is being read, frame by frame.
pub(crate) trait FrameReader {
    /// The next frame, if there is one.
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError>;

    /// Passes over the next frame, with as little work as the format allows; whether there was
    /// one, all of it.
    fn skip(&mut self) -> Result<bool, FileError> {
        Ok(self.next()?.is_some())
    }

    /// Whether more seems to follow.
    fn more(&mut self) -> Result<bool, FileError> {
        Ok(false)
    }
}
