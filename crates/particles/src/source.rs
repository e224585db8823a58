//! Source of bytes: a file or standard input, decompressed, and converted from UTF-16 to UTF-8 if
//! needed.
//!
//! The compression format is detected by magic number; the file name is ignored. All decoders are
//! written in Rust, so the program needs no system library.

use crate::utf16::{self, Utf16};
use crate::{FileError, ReadProgress, line, progress::CountedFile};
use flate2::read::MultiGzDecoder;
use lzma_rust2::XzReader;
use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Chain, Cursor, Read, Write};
use std::path::Path;
use std::sync::Arc;

/// Number of bytes at the beginning of a file from which its format is detected.
pub(crate) const HEAD: usize = 1 << 16;

/// Maximum length of leading comments that are read to find the first data.
const PREAMBLE: usize = 1 << 24;

/// Maximum memory for decoding an xz file, in KiB: four times that of `xz -9`.
const XZ_MEMORY: u32 = 1 << 18;

/// Magic numbers of compressed files.
const MAGICS: [(&[u8], Compression); 4] = [
    (&[0x1F, 0x8B], Compression::Gzip),
    (b"BZh", Compression::Bzip2),
    (&[0x28, 0xB5, 0x2F, 0xFD], Compression::Zstd),
    (&[0xFD, b'7', b'z', b'X', b'Z', 0], Compression::Xz),
];

/// A compression format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Compression {
    Gzip,
    Bzip2,
    Xz,
    Zstd,
}

/// An open file: its beginning, and a reader of the rest.
pub(crate) struct Source {
    pub(crate) path: Arc<Path>,
    /// The first [`HEAD`] bytes, or all if there are fewer; more after a long preamble.
    pub(crate) head: Vec<u8>,
    /// Reader of the bytes after the head.
    pub(crate) reader: Bytes,
    pub(crate) progress: ReadProgress,
}

/// Bytes of a file.
pub(crate) enum Bytes {
    /// As they are in the file, in which a reader can start anywhere.
    File(CountedFile),
    /// Decoded, or of a pipe.
    Stream(Box<dyn Read + Send>),
}

impl Bytes {
    /// Creates a reader of bytes that can be read only once.
    pub(crate) fn stream(reader: impl Read + Send + 'static) -> Self {
        Self::Stream(Box::new(reader))
    }
}

impl Read for Bytes {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Stream(stream) => stream.read(buffer),
        }
    }
}

/// Returns whether this path means standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == "-"
}

impl Source {
    /// Opens a file, or standard input for `-`.
    pub(crate) fn open(path: &Path, progress: &ReadProgress) -> Result<Self, FileError> {
        let path: Arc<Path> = path.into();
        let fault = |error: &io::Error| FileError::unreadable(&path, error);
        let mut raw = if is_standard_input(&path) {
            Bytes::stream(io::stdin())
        } else {
            let file = File::open(&path).map_err(|error| fault(&error))?;
            let regular = file.metadata().is_ok_and(|data| data.is_file());
            let file = CountedFile::new(file, progress);
            if regular { Bytes::File(file) } else { Bytes::stream(file) }
        };
        let head = head(&mut raw).map_err(|error| fault(&error))?;
        let mut source = Self { path: path.clone(), head, reader: raw, progress: progress.clone() };
        if let Some(compression) = Compression::of(&source.head) {
            source = source
                .decoded(|compressed| Bytes::Stream(compression.decoder(compressed)))
                .map_err(|error| fault(&error))?;
            if let Some(inner) = Compression::of(&source.head) {
                let message =
                    format!("is compressed twice ({}, then {})", inner.name(), compression.name());
                return Err(FileError::whole_file(&path, message).with_help("decompress it once"));
            }
        }
        if let Some(unit) = utf16::mark(&source.head) {
            let decode = |units| Bytes::stream(Utf16::new(units, unit));
            source = source.decoded(decode).map_err(|error| fault(&error))?;
        }
        source.read_preamble().map_err(|error| fault(&error))?;
        Ok(source)
    }

    /// Returns the source of the decoded bytes.
    fn decoded(
        self,
        decode: impl FnOnce(Chain<Cursor<Vec<u8>>, Bytes>) -> Bytes,
    ) -> io::Result<Self> {
        let mut reader = decode(Cursor::new(self.head).chain(self.reader));
        Ok(Self { path: self.path, head: head(&mut reader)?, reader, progress: self.progress })
    }

    /// Extends a head that is mostly comments until it contains data.
    fn read_preamble(&mut self) -> io::Result<()> {
        let mut length = HEAD;
        while self.head.len() >= length
            && length < PREAMBLE
            && length - comments(&self.head) < HEAD / 2
        {
            self.reader.by_ref().take(length as u64).read_to_end(&mut self.head)?;
            length *= 2;
        }
        Ok(())
    }

    /// Extends a head of [`HEAD`] bytes that does not tell the format. Returns whether there were more bytes.
    pub(crate) fn extend(&mut self) -> io::Result<bool> {
        if self.head.len() != HEAD {
            return Ok(false);
        }
        let settled = self.head.iter().rposition(|&byte| byte != b'\r').map_or(0, |at| at + 1);
        self.reader.by_ref().take(HEAD as u64).read_to_end(&mut self.head)?;
        line::end_lines(&mut self.head[settled..]);
        Ok(self.head.len() > HEAD)
    }

    /// Returns a seekable file: the file itself, or a temporary copy if it was compressed or a pipe.
    pub(crate) fn into_file(mut self) -> Result<CountedFile, FileError> {
        let fault = |error: io::Error| {
            FileError::whole_file(&self.path, format!("cannot be read: {error}"))
        };
        let plain = File::open(&self.path).ok().filter(|_| !is_standard_input(&self.path));
        if let Some(mut file) = plain {
            let mut again = vec![0; self.head.len()];
            let regular = file.metadata().is_ok_and(|metadata| metadata.is_file());
            if regular && file.read_exact(&mut again).is_ok() && again == self.head {
                return Ok(CountedFile::new(file, &self.progress));
            }
        }
        let mut file = tempfile::tempfile().map_err(fault)?;
        file.write_all(&self.head).map_err(fault)?;
        io::copy(&mut self.reader, &mut file).map_err(fault)?;
        Ok(CountedFile::new(file, &self.progress))
    }
}

/// Returns the length of leading comments and blank lines in bytes.
fn comments(text: &[u8]) -> usize {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let lines = text.split_inclusive(|byte| b"\r\n".contains(byte));
    let is_comment = |line: &&[u8]| {
        let line = line.trim_ascii_start();
        line.is_empty() || line::is_comment(line)
    };
    lines.take_while(is_comment).map(<[u8]>::len).sum()
}

/// Reads the head of a file.
pub(crate) fn head(reader: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    reader.take(HEAD as u64).read_to_end(&mut head)?;
    Ok(head)
}

impl Compression {
    fn of(head: &[u8]) -> Option<Self> {
        MAGICS
            .iter()
            .find(|(magic, _)| head.starts_with(magic))
            .map(|&(_, compression)| compression)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Gzip => "gzip",
            Self::Bzip2 => "bzip2",
            Self::Xz => "xz",
            Self::Zstd => "zstd",
        }
    }

    fn decoder(self, compressed: impl Read + Send + 'static) -> Box<dyn Read + Send> {
        let compressed = BufReader::with_capacity(HEAD, compressed);
        let reader: Box<dyn Read + Send> = match self {
            Self::Gzip => Box::new(MultiGzDecoder::new(compressed)),
            Self::Bzip2 => Box::new(bzip2::read::MultiBzDecoder::new(compressed)),
            Self::Xz => Box::new(XzReader::new_mem_limit(compressed, true, XZ_MEMORY)),
            Self::Zstd => {
                Box::new(Zstd { compressed, decoder: FrameDecoder::new(), inside: false })
            }
        };
        Box::new(Decompressed { reader, compression: self })
    }
}

/// A decoder whose errors name the compression format.
struct Decompressed {
    reader: Box<dyn Read + Send>,
    compression: Compression,
}

impl Read for Decompressed {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.reader.read(buffer).map_err(|error| match error.kind() {
            io::ErrorKind::Interrupted => error,
            kind => {
                let name = self.compression.name();
                io::Error::new(kind, format!("the {name} data is damaged or cut off ({error})"))
            }
        })
    }
}

/// Decoder of all frames of a zstd file; `FrameDecoder` reads only one.
struct Zstd<R: BufRead> {
    compressed: R,
    decoder: FrameDecoder,
    /// True if the decoder is within a frame.
    inside: bool,
}

impl<R: BufRead> Zstd<R> {
    /// Starts the next frame. Returns whether there is one.
    fn start_frame(&mut self) -> io::Result<bool> {
        while !self.compressed.fill_buf()?.is_empty() {
            match self.decoder.init(&mut self.compressed) {
                Ok(()) => {
                    self.inside = true;
                    return Ok(true);
                }
                Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame {
                    length,
                    ..
                })) => {
                    let mut skipped = self.compressed.by_ref().take(u64::from(length));
                    io::copy(&mut skipped, &mut io::sink())?;
                }
                Err(error) => return Err(io::Error::new(io::ErrorKind::InvalidData, error)),
            }
        }
        Ok(false)
    }
}

impl<R: BufRead> Read for Zstd<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            while self.inside && self.decoder.can_collect() == 0 && !self.decoder.is_finished() {
                let one = BlockDecodingStrategy::UptoBlocks(1);
                self.decoder.decode_blocks(&mut self.compressed, one).map_err(io::Error::other)?;
            }
            if self.inside && self.decoder.can_collect() > 0 {
                return self.decoder.read(buffer);
            }
            if !self.start_frame()? {
                return Ok(0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the length of the head after its extension past comments.
    fn head_of(content: impl Read + Send + 'static) -> usize {
        let mut reader = Bytes::stream(content);
        let head = head(&mut reader).expect("memory");
        let (path, progress) = (Path::new("p").into(), ReadProgress::default());
        let mut source = Source { path, head, reader, progress };
        source.read_preamble().expect("memory");
        source.head.len()
    }

    #[test]
    fn heads_extend_until_half_of_the_last_block_is_no_comment() {
        for (comments, rows, expected) in [
            (100, 0, 100),
            (50_000, 0, 50_000),
            (0, 200_000, HEAD),
            (HEAD / 2, 200_000, HEAD),
            (HEAD / 2 + 1, 200_000, 2 * HEAD),
            (HEAD * 3 / 2, 300_000, 2 * HEAD),
            (HEAD * 3 / 2 + 1, 300_000, 4 * HEAD),
            (100_000, 10_000, 110_000),
        ] {
            let mut text = vec![b'#'; comments];
            if let Some(last) = text.last_mut() {
                *last = b'\n';
            }
            text.extend(b"1 2 3\n".iter().cycle().take(rows));
            let returns = text.iter().map(|&byte| if byte == b'\n' { b'\r' } else { byte });
            assert_eq!(head_of(Cursor::new(returns.collect::<Vec<u8>>())), expected, "{comments}");
            assert_eq!(head_of(Cursor::new(text)), expected, "{comments} {rows}");
        }
        assert_eq!(head_of(io::repeat(b'#')), PREAMBLE);
    }
}
