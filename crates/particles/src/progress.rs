//! Progress of reading a file.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Number of bytes read from a file, visible to other threads. Clones share the count. All values
/// compare equal in [`ReadOptions`](super::ReadOptions), because they don't affect reading.
#[derive(Clone, Debug, Default)]
pub struct ReadProgress(Arc<Counts>);

#[derive(Debug, Default)]
struct Counts {
    read: AtomicU64,
    /// 0 if unknown.
    total: AtomicU64,
}

impl PartialEq for ReadProgress {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl ReadProgress {
    /// Returns the fraction of the file that was read, 0..=1; `None` if its length is unknown.
    pub fn fraction(&self) -> Option<f64> {
        let total = self.0.total.load(Ordering::Relaxed);
        let read = self.0.read.load(Ordering::Relaxed);
        (total > 0).then(|| (read as f64 / total as f64).min(1.0))
    }

    /// Resets the count for a file of `total` bytes.
    pub fn expect(&self, total: u64) {
        self.0.total.store(total, Ordering::Relaxed);
        self.0.read.store(0, Ordering::Relaxed);
    }

    /// Adds bytes to the count.
    pub fn add(&self, bytes: u64) {
        self.0.read.fetch_add(bytes, Ordering::Relaxed);
    }
}

/// A file that counts the bytes read from it.
pub(crate) struct CountedFile {
    file: File,
    progress: ReadProgress,
}

impl CountedFile {
    /// Creates a reader at the beginning of a file.
    pub(crate) fn new(file: File, progress: &ReadProgress) -> Self {
        let length = file.metadata().map_or(0, |data| if data.is_file() { data.len() } else { 0 });
        progress.expect(length);
        Self { file, progress: progress.clone() }
    }
}

impl Read for CountedFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.file.read(buffer)?;
        self.progress.add(read as u64);
        Ok(read)
    }
}

impl Seek for CountedFile {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.file.seek(place)
    }
}
