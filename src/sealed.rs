//! Streams that end with the BLAKE3 hash of all that comes before, so that no damaged byte is believed.

use std::io::{self, Read, Write};

/// Bytes of the hash at the end.
pub(crate) const SEAL: u64 = 32;

/// Most bytes that are hashed at a time: few enough to be in a cache still.
const CHUNK: usize = 1 << 17;

/// Hashes what is written.
pub(crate) struct Sealing<'a> {
    writer: &'a mut dyn Write,
    hasher: blake3::Hasher,
}

impl<'a> Sealing<'a> {
    pub(crate) fn new(writer: &'a mut dyn Write) -> Self {
        Self { writer, hasher: blake3::Hasher::new() }
    }

    /// Writes the hash.
    pub(crate) fn seal(self) -> io::Result<()> {
        self.writer.write_all(self.hasher.finalize().as_bytes())
    }
}

impl Write for Sealing<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.writer.write(&bytes[..bytes.len().min(CHUNK)])?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// Hashes what is read.
pub(crate) struct Unsealing<R> {
    reader: R,
    hasher: blake3::Hasher,
}

impl<R: Read> Unsealing<R> {
    pub(crate) fn new(reader: R) -> Self {
        Self { reader, hasher: blake3::Hasher::new() }
    }

    /// Whether the hash that follows is that of all that was read.
    pub(crate) fn verify(mut self) -> io::Result<bool> {
        let mut hash = [0; SEAL as usize];
        self.reader.read_exact(&mut hash)?;
        Ok(self.hasher.finalize() == blake3::Hash::from_bytes(hash))
    }
}

impl<R: Read> Read for Unsealing<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let most = bytes.len().min(CHUNK);
        let count = self.reader.read(&mut bytes[..most])?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }
}
