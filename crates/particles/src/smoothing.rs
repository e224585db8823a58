//! Smoothing of trajectories: the mean of the positions in frames around each one.

use crate::{FileError, ParticleFrame, bonds::nearest_image, frame_reader::FrameReader, ids};
use glam::DVec3;
use std::collections::VecDeque;
use std::path::Path;

/// Frames around the next one.
pub(crate) struct Window {
    /// Number of frames before and after each one.
    half: usize,
    frames: VecDeque<ParticleFrame>,
    /// Index of the next frame in `frames`.
    center: usize,
    ended: bool,
    /// Error after the last frame.
    error: Option<FileError>,
}

impl Window {
    pub(crate) fn new(half: u32) -> Self {
        let frames = VecDeque::new();
        Self { half: half as usize, frames, center: 0, ended: false, error: None }
    }

    /// Returns the next frame as it is in the file; [`Window::smooth`] returns its mean positions.
    pub(crate) fn next(
        &mut self,
        reader: &mut dyn FrameReader,
    ) -> Result<Option<ParticleFrame>, FileError> {
        while !self.ended && self.frames.len() <= self.center + self.half {
            match reader.next() {
                Ok(Some(mut frame)) => {
                    ids::sort(&mut frame);
                    self.frames.push_back(frame);
                }
                Ok(None) => self.ended = true,
                Err(error) => (self.ended, self.error) = (true, Some(error)),
            }
        }
        match (self.frames.get(self.center), self.error.take()) {
            (Some(frame), error) => {
                self.error = error;
                Ok(Some(frame.clone()))
            }
            (None, Some(error)) => Err(error),
            (None, None) => Ok(None),
        }
    }

    /// Returns whether the next frame is known to exist.
    pub(crate) fn has_next(&self) -> bool {
        self.frames.len() > self.center
    }

    /// Replaces the positions of a frame that was just returned by the means of the frames around it. Each
    /// particle is followed from frame to frame by its nearest periodic image.
    pub(crate) fn smooth(&self, path: &Path, frame: &mut ParticleFrame) -> Result<(), FileError> {
        let first = self.center.saturating_sub(self.half);
        let last = (self.center + self.half).min(self.frames.len() - 1);
        let count = frame.len();
        if let Some(other) = self.frames.range(first..=last).find(|other| other.len() != count) {
            let message = format!(
                "cannot be smoothed: one frame has {count} particles, and the next {}",
                other.len()
            );
            let help = "smoothing needs the same particles in all frames";
            return Err(FileError::whole_file(path, message).with_help(help));
        }
        let frames = (last - first + 1) as f64;
        let cell = frame.cell;
        for row in 0..count {
            let own = frame.position(row);
            let mut sum = DVec3::ZERO;
            let backward: Vec<usize> = (first..self.center).rev().collect();
            let forward: Vec<usize> = (self.center + 1..=last).collect();
            for side in [backward, forward] {
                let mut place = own;
                for other in side {
                    let away = self.frames[other].position(row) - place;
                    place += nearest_image(away, cell.as_ref());
                    sum += place - own;
                }
            }
            [frame.x[row], frame.y[row], frame.z[row]] = (own + sum / frames).to_array();
        }
        Ok(())
    }

    /// Moves on to the next frame.
    pub(crate) fn advance(&mut self) {
        self.center += 1;
        if self.center > self.half {
            self.frames.pop_front();
            self.center -= 1;
        }
    }
}
