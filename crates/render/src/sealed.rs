//! Streams that end with the BLAKE3 hash of their content, so that damage is detected.

use std::io::{self, Read, Write};

/// Bytes of the hash at the end.
pub(crate) const HASH_BYTES: u64 = 32;

/// Reads the next `N` bytes.
pub(crate) fn array<const N: usize>(reader: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}

/// Maximum number of bytes that are hashed at a time, so that they are still in a cache.
const CHUNK: usize = 1 << 17;

/// A writer that hashes its data.
pub(crate) struct HashingWriter<'a> {
    writer: &'a mut dyn Write,
    hasher: blake3::Hasher,
}

impl<'a> HashingWriter<'a> {
    /// Begins a file: writes its magic number, the version of its format, and its header after the
    /// header's length.
    pub(crate) fn begin(
        writer: &'a mut dyn Write,
        magic: &[u8],
        format: u32,
        header: &[u8],
    ) -> io::Result<Self> {
        let mut file = Self { writer, hasher: blake3::Hasher::new() };
        file.write_all(magic)?;
        file.write_all(&format.to_le_bytes())?;
        file.write_all(&(header.len() as u64).to_le_bytes())?;
        file.write_all(header)?;
        Ok(file)
    }

    /// Writes the hash.
    pub(crate) fn finish(self) -> io::Result<()> {
        self.writer.write_all(self.hasher.finalize().as_bytes())
    }
}

impl Write for HashingWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.writer.write(&bytes[..bytes.len().min(CHUNK)])?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// A reader that hashes its data.
pub(crate) struct HashingReader<R> {
    reader: R,
    hasher: blake3::Hasher,
}

impl<R: Read> HashingReader<R> {
    pub(crate) fn new(reader: R) -> Self {
        Self { reader, hasher: blake3::Hasher::new() }
    }

    /// Reads the hash, and returns whether it is that of all data before it.
    pub(crate) fn verify(mut self) -> io::Result<bool> {
        let mut hash = [0; HASH_BYTES as usize];
        self.reader.read_exact(&mut hash)?;
        Ok(self.hasher.finalize() == blake3::Hash::from_bytes(hash))
    }
}

impl<R: Read> Read for HashingReader<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let most = bytes.len().min(CHUNK);
        let count = self.reader.read(&mut bytes[..most])?;
        self.hasher.update(&bytes[..count]);
        Ok(count)
    }
}
