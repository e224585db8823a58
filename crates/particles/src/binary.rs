//! Byte ranges of a binary file, and the numbers in them.

use crate::scalar::{Order, Scalar};
use crate::{FileError, progress::CountedFile, source::Source};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// A binary file that is read by ranges, in any order.
pub(crate) struct BinaryFile {
    path: Arc<Path>,
    content: CountedFile,
    length: u64,
}

impl BinaryFile {
    /// Opens a source, whose bytes are copied to a temporary file if it is a pipe or compressed.
    pub(crate) fn open(source: Source) -> Result<Self, FileError> {
        let path = source.path.clone();
        let mut content = source.into_file()?;
        let length = content.seek(SeekFrom::End(0)).map_err(|error| unreadable(&path, &error))?;
        Ok(Self { path, content, length })
    }

    pub(crate) fn path(&self) -> &Arc<Path> {
        &self.path
    }

    /// Returns the length of the file in bytes.
    pub(crate) fn length(&self) -> u64 {
        self.length
    }

    /// Returns whether a range is within the file.
    pub(crate) fn has_range(&self, location: u64, length: u64) -> bool {
        location.checked_add(length).is_some_and(|end| end <= self.length)
    }

    /// Returns an error if a range is not within the file.
    pub(crate) fn check_range(&self, location: u64, length: u64) -> Result<(), FileError> {
        if self.has_range(location, length) {
            return Ok(());
        }
        let message = format!("is cut off: {length} bytes from {location} on are not there");
        let error = FileError { cut_off: true, ..FileError::whole_file(&self.path, message) };
        Err(error.with_help("copy it again, after the simulation has ended"))
    }

    /// Reads bytes of the file; checks that they exist before allocating memory.
    pub(crate) fn bytes(&mut self, location: u64, length: u64) -> Result<Vec<u8>, FileError> {
        self.check_range(location, length)?;
        let mut bytes = vec![0; length as usize];
        let seek = self.content.seek(SeekFrom::Start(location));
        seek.and_then(|_| self.content.read_exact(&mut bytes))
            .map_err(|error| unreadable(&self.path, &error))?;
        Ok(bytes)
    }

    /// Returns an error that concerns the whole file.
    pub(crate) fn fault(&self, message: impl Into<String>) -> FileError {
        FileError::whole_file(&self.path, message)
    }

    /// Returns an error about a frame that cannot be what the simulation wrote.
    pub(crate) fn damaged(&self, frame: u64, what: &str) -> FileError {
        let error = self.fault(format!("frame {frame} is damaged: {what}"));
        error.with_help("copy the file again; --frame chooses another frame")
    }
}

fn unreadable(path: &Path, error: &io::Error) -> FileError {
    FileError::whole_file(path, format!("cannot be read: {error}"))
}

/// Reader of the numbers in a block of bytes, one after another. Beyond the block they are missing.
pub(crate) struct Numbers<'b> {
    rest: &'b [u8],
    order: Order,
}

impl<'b> Numbers<'b> {
    pub(crate) fn new(bytes: &'b [u8], order: Order) -> Self {
        Self { rest: bytes, order }
    }

    /// Returns the next bytes.
    pub(crate) fn take(&mut self, length: usize) -> Option<&'b [u8]> {
        let (bytes, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(bytes)
    }

    /// Returns the next number of this type.
    pub(crate) fn scalar(&mut self, scalar: Scalar) -> Option<f64> {
        Some(scalar.read(self.take(scalar.size())?, self.order))
    }

    pub(crate) fn i32(&mut self) -> Option<i32> {
        self.scalar(Scalar::I32).map(|value| value as i32)
    }

    /// Returns the next 32-bit whole number, if it is not negative.
    pub(crate) fn count(&mut self) -> Option<u64> {
        u64::try_from(self.i32()?).ok()
    }

    /// Returns the next numbers of this type.
    pub(crate) fn array<const COUNT: usize>(&mut self, scalar: Scalar) -> Option<[f64; COUNT]> {
        let bytes = self.take(COUNT * scalar.size())?;
        Some(std::array::from_fn(|at| scalar.read(&bytes[at * scalar.size()..], self.order)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_end_with_their_block() {
        let bytes = [0, 0, 0, 7, 0xFF, 0xFF, 0xFF, 0xFE, 0x3F, 0x80, 0, 0];
        let mut numbers = Numbers::new(&bytes, Order::Big);
        assert_eq!((numbers.count(), numbers.count()), (Some(7), None));
        assert_eq!(numbers.array::<1>(Scalar::F32), Some([1.0]));
        assert_eq!((numbers.i32(), numbers.take(0)), (None, Some(&[][..])));
    }
}
