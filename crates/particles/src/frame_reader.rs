//! The trait of readers: they return the frames of a file one after another.

use crate::{FileError, ParticleFrame, place::Place};

/// Reader of a file's frames.
pub(crate) trait FrameReader: Send {
    /// Returns the next frame, if there is one.
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError>;

    /// Skips the next frame with as little work as the format allows. Returns whether there was a
    /// complete one.
    fn skip(&mut self) -> Result<bool, FileError> {
        Ok(self.next()?.is_some())
    }

    /// Returns whether another frame seems to follow.
    fn more(&mut self) -> Result<bool, FileError> {
        Ok(false)
    }

    /// Returns where the next frame begins; `None` if readers of the file cannot start there.
    fn place(&self) -> Option<Place> {
        None
    }

    /// Starts at a place that a reader of the same file returned, if this one can. Returns whether it did.
    fn start_at(&mut self, _place: &Place) -> Result<bool, FileError> {
        Ok(false)
    }
}
