//! Single frames of a file that stays open.

use crate::reader::{Frames, read_frame};
use crate::{FileError, FrameChoice, ParticleFrame, ReadOptions};
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Reads single frames of a file, which stays open: a later frame is found without passing those before the last one again.
#[derive(Default)]
pub struct OpenFile(Option<Open>);

/// An open file.
struct Open {
    frames: Frames,
    path: PathBuf,
    options: ReadOptions,
    stamp: Stamp,
}

/// Time of the last change of a file, and its length.
type Stamp = Option<(SystemTime, u64)>;

impl OpenFile {
    /// Reads the frame that the options select, as [`read_frame`].
    ///
    /// # Errors
    ///
    /// Those of [`read_frame`].
    pub fn read(&mut self, path: &Path, options: &ReadOptions) -> Result<ParticleFrame, FileError> {
        let alone =
            options.smooth == 0 && options.trail == 0 && options.align.is_none() && path.is_file();
        let (FrameChoice::Index(index), true) = (options.frame, alone) else {
            return read_frame(path, options);
        };
        let (stamp, key) =
            (stamp(path), ReadOptions { frame: FrameChoice::default(), ..options.clone() });
        let same = |open: &Open| {
            open.path == path
                && open.stamp == stamp
                && open.options == key
                && open.frames.passed() <= index
        };
        let mut open = match self.0.take().filter(same) {
            Some(open) => open,
            None => Open {
                frames: Frames::open(path, options)?,
                path: path.to_owned(),
                options: key,
                stamp,
            },
        };
        let missing = |count: u64| {
            let message = format!("has no frame {index}, only {count} (the first is 0)");
            FileError::whole_file(path, message)
        };
        while open.frames.passed() < index {
            if !open.frames.skip_frame()? {
                return Err(missing(open.frames.passed()));
            }
        }
        let frame = open.frames.next().transpose()?.ok_or_else(|| missing(index))?;
        self.0 = Some(open);
        Ok(frame)
    }
}

/// A copy opens the file itself.
impl Clone for OpenFile {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl fmt::Debug for OpenFile {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.debug_tuple("OpenFile").field(&self.0.as_ref().map(|open| &open.path)).finish()
    }
}

fn stamp(path: &Path) -> Stamp {
    let data = path.metadata().ok()?;
    Some((data.modified().ok()?, data.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_those_of_files_that_are_opened_anew() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.xyz");
        let frame = |x: u32| format!("1\n\nC {x} 0 0\n");
        let text: String = (0..20).map(frame).collect();
        std::fs::write(&path, &text).expect("a file");
        let mut file = OpenFile::default();
        let mut read = |index: u64| {
            let options =
                ReadOptions { frame: FrameChoice::Index(index), ..ReadOptions::default() };
            let found = file
                .read(&path, &options)
                .map(|frame| frame.x[0])
                .map_err(|error| error.to_string());
            let passed = file.0.as_ref().map(|open| open.frames.passed());
            let anew = read_frame(&path, &options).map(|frame| frame.x[0]);
            assert_eq!(found, anew.map_err(|error| error.to_string()), "{index}");
            passed
        };
        for index in [3, 4, 5, 12, 2, 2, 0, 19] {
            assert_eq!(read(index), Some(index + 1));
        }
        assert_eq!(read(20), None);
        assert_eq!(read(1), Some(2));
        // Another file in its place.
        std::fs::write(&path, text.replace("C 3 ", "C 333 ")).expect("a file");
        assert_eq!(read(3), Some(4));
    }
}
