//! Single frames of a file that stays open.

use crate::place::FrameIndex;
use crate::reader::{Frames, read_frame};
use crate::{FileError, Format, FrameChoice, ParticleFrame, ReadOptions, memory};
use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::SystemTime;
use std::{process, thread};

/// Number of frames that are kept while the one after them is read ahead.
const KEPT: usize = 1;

/// Bytes per particle that must be left for a frame to be read ahead: those of the frame, and of what is made of the one before.
const AHEAD: u64 = 512;

/// Reads single frames of a file, which stays open. Where frames begin is remembered, so that any of them is found without passing
/// those before it again. From the second frame in order on, a thread reads up to two frames ahead, if memory is left.
#[derive(Default)]
pub struct OpenFile {
    open: Option<Open>,
    known: Option<Known>,
    ahead: Option<Ahead>,
}

/// Frames that a thread reads before they are asked for. It ends when this is dropped, or after an error.
struct Ahead {
    options: ReadOptions,
    /// Number of the next one.
    next: u64,
    /// The process that has the thread: a fork of it has none.
    process: u32,
    frames: Receiver<Result<ParticleFrame, FileError>>,
}

impl Ahead {
    /// Starts to read the frames after one of so many particles; `None` if there can be no thread.
    fn start(open: Open, next: u64, particles: usize) -> Option<Self> {
        let Open { mut frames, options } = open;
        let need = AHEAD.saturating_mul(particles as u64);
        let (sender, receiver) = sync_channel(KEPT);
        let read = move || {
            for number in next.. {
                if memory::check(need).is_err() {
                    break;
                }
                let frame = frames.read_at(number);
                let is_last = frame.is_err();
                if sender.send(frame).is_err() || is_last {
                    break;
                }
            }
        };
        thread::Builder::new().name("reader".to_owned()).spawn(read).ok()?;
        Some(Self { options, next, process: process::id(), frames: receiver })
    }

    /// Returns the next frame, or its error; `None` if the thread has ended.
    fn take(&mut self) -> Option<Result<ParticleFrame, FileError>> {
        self.next += 1;
        self.frames.recv().ok()
    }
}

/// An open file.
struct Open {
    frames: Frames,
    options: ReadOptions,
}

/// A file whose frames were passed, and where they begin.
struct Known {
    file: Identity,
    index: FrameIndex,
}

/// A file as it is now, and all that its frames begin by.
#[derive(Clone, PartialEq)]
struct Identity {
    path: PathBuf,
    format: Option<Format>,
    /// Time of the last change, and length in bytes.
    stamp: Option<(SystemTime, u64)>,
}

impl Identity {
    fn of(path: &Path, options: &ReadOptions) -> Self {
        let stamp = path.metadata().ok().and_then(|data| Some((data.modified().ok()?, data.len())));
        Self { path: path.to_owned(), format: options.format, stamp }
    }
}

impl OpenFile {
    /// Reads the frame that the options select, as [`read_frame`].
    ///
    /// # Errors
    ///
    /// Those of [`read_frame`].
    pub fn read(&mut self, path: &Path, options: &ReadOptions) -> Result<ParticleFrame, FileError> {
        let FrameChoice::Index(index) = options.frame else { return read_frame(path, options) };
        if !path.is_file() {
            return read_frame(path, options);
        }
        let places = self.index(path, options);
        let key = ReadOptions { frame: FrameChoice::default(), ..options.clone() };
        let is_next = |ahead: &Ahead| {
            ahead.options == key && ahead.next == index && ahead.process == process::id()
        };
        if let Some(mut ahead) = self.ahead.take().filter(is_next)
            && let Some(frame) = ahead.take()
        {
            self.ahead = Some(ahead).filter(|_| frame.is_ok());
            return frame;
        }
        let reaches = |open: &Open| open.options == key && open.frames.reaches(index);
        let open = self.open.take().filter(reaches);
        let follows = open.as_ref().is_some_and(|open| open.frames.passed() == index);
        let mut open = match open {
            Some(open) => open,
            None => Open { frames: Frames::open(path, options)?.with_index(&places), options: key },
        };
        let frame = open.frames.read_at(index)?;
        if follows {
            self.ahead = Ahead::start(open, index + 1, frame.len());
        } else {
            self.open = Some(open);
        }
        Ok(frame)
    }

    /// Returns what counts the complete frames of a file, and finds on its way where they begin, for frames that are read
    /// meanwhile and later.
    pub fn counter(
        &mut self,
        path: &Path,
        options: &ReadOptions,
    ) -> impl FnOnce() -> Result<u64, FileError> + Send + use<> {
        let (path, options) = (path.to_owned(), options.clone());
        let places = self.index(&path, &options);
        let before = Identity::of(&path, &options);
        move || {
            let frames = Frames::open(&path, &options)?;
            let is_same = path.is_file() && Identity::of(&path, &options) == before;
            let places = if is_same { places } else { FrameIndex::default() };
            frames.with_index(&places).pass_all()
        }
    }

    /// Returns where frames of a file begin, as far as that is known. What is known of another file, or of this one before it
    /// changed, is forgotten.
    fn index(&mut self, path: &Path, options: &ReadOptions) -> FrameIndex {
        let file = Identity::of(path, options);
        let known = self.known.take().filter(|known| known.file == file);
        if known.is_none() {
            (self.open, self.ahead) = (None, None);
        }
        let known = known.unwrap_or_else(|| Known { file, index: FrameIndex::default() });
        self.known.insert(known).index.clone()
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
        let path = self.known.as_ref().map(|known| &known.file.path);
        formatter.debug_tuple("OpenFile").field(&path).finish()
    }
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
            let passed = file.open.as_ref().map(|open| open.frames.passed());
            let passed = passed.or(file.ahead.as_ref().map(|ahead| ahead.next));
            let anew = read_frame(&path, &options).map(|frame| frame.x[0]);
            assert_eq!(found, anew.map_err(|error| error.to_string()), "{index}");
            passed
        };
        for index in [3, 4, 5, 12, 2, 2, 0, 19] {
            assert_eq!(read(index), Some(index + 1));
        }
        assert_eq!(read(20), None);
        assert_eq!(read(1), Some(2));
        // More frames than before.
        std::fs::write(&path, format!("{text}{}", frame(20))).expect("a file");
        assert_eq!(read(20), Some(21));
        assert_eq!(read(21), None);
        // Another file in its place.
        std::fs::write(&path, text.replace("C 3 ", "C 333 ")).expect("a file");
        assert_eq!(read(3), Some(4));
    }

    #[test]
    fn at_most_two_frames_are_read_ahead() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.xyz");
        // Each is longer than a block of lines.
        let (frames, atoms) = (40, 20_000);
        let frame = |x: u32| {
            format!("{atoms}\n\n{}", format!("C {x} 0.00000000 0.00000000\n").repeat(atoms))
        };
        std::fs::write(&path, (0..frames).map(frame).collect::<String>()).expect("a file");
        let mut file = OpenFile::default();
        let progress = crate::ReadProgress::default();
        for index in 0..10 {
            let options = ReadOptions { progress: progress.clone(), ..options(index) };
            assert_eq!(file.read(&path, &options).expect("a frame").x[0], index as f64);
        }
        let read = || progress.fraction().expect("a file") * f64::from(frames);
        // Those that are ahead have been read, and no other follows.
        let start = std::time::Instant::now();
        while read() < 11.5 {
            assert!(start.elapsed().as_secs() < 60, "{}", read());
            thread::sleep(std::time::Duration::from_millis(5));
        }
        thread::sleep(std::time::Duration::from_millis(200));
        assert!(read() < 13.0, "{}", read());
        let jumped = file.read(&path, &options(30)).expect("a frame");
        assert!(jumped.x[0] == 30.0 && file.ahead.is_none());
    }

    /// Number of damaged files for each one.
    const CASES: usize = 3;

    /// Numbers in random order, the same in each run (Knuth's MMIX).
    struct Random(u64);

    impl Random {
        fn below(&mut self, count: usize) -> usize {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 33) as usize % count
        }
    }

    /// The frame as text, or the error.
    fn outcome(frame: Result<ParticleFrame, FileError>) -> String {
        frame.map_or_else(|error| error.to_string(), |frame| format!("{frame:?}"))
    }

    fn options(index: u64) -> ReadOptions {
        ReadOptions { frame: FrameChoice::Index(index), ..ReadOptions::default() }
    }

    /// A reader that notes where each frame begins, after it has counted the frames.
    fn counted(path: &Path) -> (OpenFile, Result<u64, String>) {
        let known = Known { file: Identity::of(path, &options(0)), index: FrameIndex::spaced(0) };
        let mut file = OpenFile { known: Some(known), ..OpenFile::default() };
        let counted = file.counter(path, &options(0))().map_err(|error| error.to_string());
        (file, counted)
    }

    /// Checks that frames in random order, and one after another, are those of the file when it is opened anew. Returns their
    /// number.
    fn check(path: &Path, random: &mut Random) -> u64 {
        let (mut file, counted) = counted(path);
        let anew = Frames::open(path, &options(0)).and_then(|mut frames| frames.pass_all());
        assert_eq!(counted, anew.map_err(|error| error.to_string()), "{}", path.display());
        let count = counted.unwrap_or(4);
        let expected: Vec<String> =
            (0..=count).map(|index| outcome(read_frame_at(path, index))).collect();
        for _ in 0..3 * expected.len() {
            let first = random.below(expected.len());
            let some = random.below(6);
            for (index, expected) in expected.iter().enumerate().skip(first).take(some) {
                let found = outcome(file.read(path, &options(index as u64)));
                assert_eq!(found, *expected, "{} {index}", path.display());
            }
        }
        count
    }

    /// Reads a frame as all do that have not passed those before it.
    fn read_frame_at(path: &Path, index: u64) -> Result<ParticleFrame, FileError> {
        Frames::open(path, &options(index))?.read_at(index)
    }

    /// The files of the tests, without folders.
    fn files() -> Vec<PathBuf> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/particles");
        let entries =
            folder.read_dir().expect("a folder").map(|entry| entry.expect("a file").path());
        let mut files: Vec<PathBuf> = entries.filter(|path| path.is_file()).collect();
        files.sort();
        files
    }

    #[test]
    fn frames_of_all_formats_are_found_where_they_begin() {
        let mut random = Random(3);
        let (mut several, mut unmarked) = (0, Vec::new());
        for path in files() {
            let count = check(&path, &mut random);
            if count < 2 {
                continue;
            }
            several += 1;
            let places = counted(&path).0.index(&path, &options(0));
            let last = places.before(count - 1).map(|mark| mark.frame);
            // Formats that find each frame by its number need the first mark alone.
            let by_number = ["dcd", "gsd", "h5", "h5md", "nc", "ncdf", "npz", "traj"];
            let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
            let is_marked =
                last == Some(count - 1) || last == Some(0) && by_number.contains(&ending);
            if !is_marked {
                unmarked.push(path.file_name().expect("a name").to_owned());
            }
        }
        // Arrays of NumPy are read as streams; the others are no trajectories.
        assert_eq!(unmarked, ["answers.toml", "frames.npy", "space_groups.csv"]);
        assert!(several > 30, "{several}");
    }

    #[test]
    fn damaged_frames_are_the_errors_that_they_were() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut random = Random(4);
        let mut below = |count: usize| random.below(count);
        let mut cases = Vec::new();
        for path in files() {
            let bytes = std::fs::read(&path).expect("a file");
            if bytes.len() > 100_000 || check(&path, &mut Random(1)) < 2 {
                continue;
            }
            for case in 0..CASES + 2 {
                let mut damaged = bytes.clone();
                match if case < CASES { below(3) } else { case } {
                    // Ends of lines of other systems, and a mark of the encoding: no damage.
                    CASES => {
                        let lines = damaged.iter_mut().filter(|byte| **byte == b'\n');
                        lines.for_each(|byte| *byte = b'\r');
                    }
                    byte_order if byte_order > CASES => {
                        damaged.splice(0..0, *b"\xEF\xBB\xBF");
                    }
                    0 => damaged.truncate(below(bytes.len())),
                    1 => damaged[below(bytes.len())] = b"x 7\n"[below(4)],
                    _ => {
                        let start = below(bytes.len());
                        damaged.drain(start..bytes.len().min(start + 1 + below(200)));
                    }
                }
                let name = path.file_name().expect("a name").to_string_lossy().into_owned();
                let path = folder.path().join(format!("{case}{name}"));
                std::fs::write(&path, damaged).expect("a file");
                cases.push(path);
            }
        }
        assert!(cases.len() > 30 * CASES, "{}", cases.len());
        let mut random = Random(5);
        for path in &cases {
            check(path, &mut random);
        }
    }
}
