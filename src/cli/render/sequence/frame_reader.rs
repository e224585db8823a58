//! Sequential reading of trajectory frames, the next one while an image is rendered.

use crate::cli::failure::Failure;
use spherule_render::memory;
use spherule_render::scene::FileError;
use spherule_render::scene::particles::{Frames, ParticleFrame, ReadOptions};
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// Bytes per particle that must be left for the next frame to be read while an image is rendered.
const AHEAD: u64 = 512;

/// A trajectory that is read frame by frame.
pub(super) struct FrameReader {
    reader: Arc<Mutex<Reader>>,
    /// The thread that reads the next frame, if one does.
    thread: Option<JoinHandle<()>>,
    /// The last frame and its number, if it may be requested again.
    held: Option<(u64, ParticleFrame)>,
}

/// The position in the file.
struct Reader {
    frames: Frames,
    /// Number of frames that were read or skipped.
    passed: u64,
    /// Result of reading a frame before it was requested, and its number.
    ahead: Option<(u64, Outcome)>,
}

/// A frame, `None` after the last one, or why it cannot be read.
type Outcome = Result<Option<ParticleFrame>, FrameError>;

/// An error of a frame.
struct FrameError {
    error: FileError,
    /// Number of the frame.
    number: u64,
}

impl From<FrameError> for Failure {
    fn from(FrameError { error, number }: FrameError) -> Self {
        Self::from(error).of_frame(number)
    }
}

impl FrameReader {
    pub(super) fn open(path: &Path, options: &ReadOptions) -> Result<Self, Failure> {
        let reader = Reader { frames: Frames::open(path, options)?, passed: 0, ahead: None };
        Ok(Self { reader: Arc::new(Mutex::new(reader)), thread: None, held: None })
    }

    /// Returns the reader, once the thread has ended.
    fn reader(&mut self) -> MutexGuard<'_, Reader> {
        if let Some(Err(panic)) = self.thread.take().map(JoinHandle::join) {
            resume_unwind(panic);
        }
        lock(&self.reader)
    }

    /// Number of frames that were read or skipped.
    pub(super) fn passed(&mut self) -> u64 {
        self.reader().passed
    }

    /// Returns a frame that is not before the last one; `None` if there are fewer frames.
    pub(super) fn take(&mut self, number: u64) -> Result<Option<ParticleFrame>, Failure> {
        if let Some((_, frame)) = self.held.take_if(|(held, _)| *held == number) {
            return Ok(Some(frame));
        }
        self.held = None;
        Ok(self.reader().take(number)?)
    }

    /// Returns whether another frame seems to follow.
    pub(super) fn has_more(&mut self) -> Result<bool, Failure> {
        Ok(self.reader().frames.more()?)
    }

    /// Skips all frames up to this one; returns whether it exists.
    pub(super) fn pass(&mut self, number: u64) -> Result<bool, Failure> {
        Ok(self.reader().pass(number)?)
    }

    /// Returns a frame as [`Self::take`], and keeps it for another request.
    pub(super) fn look(&mut self, number: u64) -> Result<Option<ParticleFrame>, Failure> {
        let frame = self.take(number)?;
        self.held = frame.clone().map(|frame| (number, frame));
        Ok(frame)
    }

    /// Starts to read a frame that is requested next, in a thread of its own. Does nothing if memory is short:
    /// then it is read when it is requested. `particles` is the number of particles of the last frame.
    pub(super) fn read_ahead(&mut self, number: u64, particles: usize) {
        let need = AHEAD.saturating_mul(particles as u64);
        if self.thread.is_some() || memory::left().is_some_and(|left| left.bytes < need) {
            return;
        }
        let reader = self.reader.clone();
        let read = move || lock(&reader).read_ahead(number);
        // Without a thread, the frame is read when it is requested.
        self.thread = thread::Builder::new().name("reader".to_owned()).spawn(read).ok();
    }

    /// Returns the error after this many frames, unless the file simply ends.
    pub(super) fn rest(&mut self, count: u64) -> Option<FileError> {
        self.reader().rest(count)
    }
}

/// Locks a reader; after a panic of its thread, the panic goes on where that is joined.
fn lock(reader: &Mutex<Reader>) -> MutexGuard<'_, Reader> {
    reader.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Reader {
    fn take(&mut self, number: u64) -> Outcome {
        if let Some((_, outcome)) = self.ahead.take_if(|(ahead, _)| *ahead == number) {
            return outcome;
        }
        if number > 0 && !self.pass(number - 1)? {
            return Ok(None);
        }
        let frame = self.frames.next().transpose();
        let frame = frame.map_err(|error| FrameError { error, number })?;
        self.passed += u64::from(frame.is_some());
        Ok(frame)
    }

    fn read_ahead(&mut self, number: u64) {
        if self.passed <= number {
            self.ahead = Some((number, self.take(number)));
        }
    }

    fn pass(&mut self, number: u64) -> Result<bool, FrameError> {
        // An error of a later frame is that of the request for it.
        let is_before =
            |outcome: &Outcome| outcome.as_ref().is_err_and(|error| error.number <= number);
        if let Some((_, Err(error))) = self.ahead.take_if(|(_, outcome)| is_before(outcome)) {
            return Err(error);
        }
        while self.passed <= number {
            let skipped = self.frames.skip_frame();
            if !skipped.map_err(|error| FrameError { error, number: self.passed })? {
                return Ok(false);
            }
            self.passed += 1;
        }
        Ok(true)
    }

    fn rest(&mut self, count: u64) -> Option<FileError> {
        while self.passed < count {
            if !self.frames.skip_frame().ok()? {
                return None;
            }
            self.passed += 1;
        }
        self.frames.next()?.err()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Requests frames of a text in XYZ, and returns their first coordinates, or the message of the error that ends
    /// them; and the number of frames that were passed.
    fn requested(text: &str, numbers: &[u64], is_ahead: bool) -> (Vec<Result<f64, String>>, u64) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.xyz");
        std::fs::write(&path, text).expect("a file");
        let mut reader = FrameReader::open(&path, &ReadOptions::default()).expect("frames");
        let mut found = Vec::new();
        for (at, &number) in numbers.iter().enumerate() {
            match reader.take(number) {
                Ok(Some(frame)) => found.push(Ok(frame.x[0])),
                Ok(None) => break,
                Err(error) => {
                    found.push(Err(error.to_string()));
                    break;
                }
            }
            if let Some(&next) = numbers.get(at + 1).filter(|_| is_ahead) {
                reader.read_ahead(next, 1);
            }
            // The frames between are passed one by one where the input can be read only once.
            if let Some(&next) = numbers.get(at + 1).filter(|&&next| next > number + 1)
                && let Err(error) = reader.pass(next - 1)
            {
                found.push(Err(error.to_string()));
                break;
            }
        }
        (found, reader.passed())
    }

    #[test]
    fn frames_that_are_read_ahead_are_those_of_the_file() {
        let frame = |x: u64| format!("1\n\nC {x} 0 0\n");
        let all: String = (0..6).map(frame).collect();
        let damaged = all.replace("C 4", "C four");
        for numbers in [&[0, 1, 2, 3, 4, 5][..], &[0, 2, 4], &[1, 5], &[3, 7], &[5, 6, 7]] {
            for text in [&all, &damaged] {
                let read = requested(text, numbers, true);
                assert_eq!(read, requested(text, numbers, false), "{numbers:?}");
            }
        }
        let (found, passed) = requested(&all, &[0, 1, 2, 3, 4, 5], true);
        let expected = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(Ok);
        assert_eq!((&found[..], passed), (&expected[..], 6));
        let (found, _) = requested(&damaged, &[3, 4, 5], true);
        assert!(
            found.len() == 2 && found[1].as_ref().is_err_and(|text| text.contains("four")),
            "{found:?}"
        );
    }

    #[test]
    fn frames_are_read_ahead_where_there_is_memory() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.xyz");
        std::fs::write(&path, "1\n\nC 0 0 0\n1\n\nC 1 0 0\n").expect("a file");
        let mut reader = FrameReader::open(&path, &ReadOptions::default()).expect("frames");
        reader.read_ahead(0, usize::MAX);
        assert!(reader.thread.is_none() || memory::left().is_none());
        reader.read_ahead(0, 1);
        assert!(reader.thread.is_some());
        assert!(reader.reader().ahead.as_ref().is_some_and(|(number, _)| *number == 0));
    }
}
