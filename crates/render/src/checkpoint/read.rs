//! Reading of checkpoints.

use super::blocks::{MAX_RATIO, TILES, unpack};
use super::{FORMAT, MAGIC, Origin, PROGRAM};
use crate::memory::{self, Shortage};
use crate::render::{RenderHeader, ResumableRender, Status};
use crate::sealed::{HASH_BYTES, array};
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};

/// Reasons why a checkpoint cannot be resumed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file does not exist or cannot be read.
    #[error("{}: cannot be read: {}", .0.display(), .1)]
    Read(PathBuf, io::Error),
    /// The file is something else.
    #[error("{}: is not a checkpoint; name a file that a render saved", .0.display())]
    Foreign(PathBuf),
    /// Bytes are missing or changed.
    #[error(
        "{}: is damaged: {}; resume from a copy, or render again", .0.display(), .1
    )]
    Damaged(PathBuf, &'static str),
    /// The format has another version.
    #[error(
        "{}: has version {} of the checkpoint format, but this program reads version {FORMAT}; \
         resume it with the program that wrote it", .0.display(), .1
    )]
    Format(PathBuf, u32),
    /// Another version of the program wrote it.
    #[error(
        "{}: was written by spherule {}, but this is {PROGRAM}, whose pictures may differ; resume \
         it with that version", .0.display(), .1
    )]
    Program(PathBuf, String),
    /// There is not enough memory for its content.
    #[error("{}: needs {}", .0.display(), .1)]
    Memory(PathBuf, Shortage),
}

/// Reads a checkpoint of [`super::write()`].
///
/// # Errors
/// The file cannot be read, or is not a checkpoint of this version of the program; bytes are missing or
/// changed; or there is not enough memory.
pub fn read(path: &Path) -> Result<(Origin, ResumableRender), CheckpointError> {
    let (reader, length) = open(path)?;
    read_from(reader, length).map_err(|fault| fault.of(path))
}

/// Opens a file, and returns its length in bytes.
fn open(path: &Path) -> Result<(BufReader<File>, u64), CheckpointError> {
    let failed = |error| CheckpointError::Read(path.to_owned(), error);
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?;
    if !length.is_file() {
        return Err(CheckpointError::Foreign(path.to_owned()));
    }
    Ok((BufReader::new(file), length.len()))
}

/// Reads the progress of a checkpoint of [`super::write()`], without its sums.
///
/// # Errors
/// Those of [`read`], except for memory.
pub fn inspect(path: &Path) -> Result<(Origin, Status), CheckpointError> {
    let (mut reader, length) = open(path)?;
    let mut read = || {
        let content = verify(&mut reader, length)?;
        let (origin, header) = read_header(&mut reader.by_ref().take(content), content)?;
        Ok((origin, header.status()))
    };
    read().map_err(|fault: ReadError| fault.of(path))
}

/// Reasons why bytes are not a valid checkpoint.
pub(super) enum ReadError {
    Read(io::Error),
    Foreign,
    Damaged(&'static str),
    Format(u32),
    Program(String),
    Memory(Shortage),
}

impl ReadError {
    fn of(self, path: &Path) -> CheckpointError {
        let path = path.to_owned();
        match self {
            Self::Read(error) => CheckpointError::Read(path, error),
            Self::Foreign => CheckpointError::Foreign(path),
            Self::Damaged(what) => CheckpointError::Damaged(path, what),
            Self::Format(version) => CheckpointError::Format(path, version),
            Self::Program(version) => CheckpointError::Program(path, version),
            Self::Memory(shortage) => CheckpointError::Memory(path, shortage),
        }
    }
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        let short = error.kind() == ErrorKind::UnexpectedEof;
        if short { Self::Damaged("its end is missing") } else { Self::Read(error) }
    }
}

/// Reads a checkpoint of `length` bytes.
pub(super) fn read_from(
    mut reader: impl Read + Seek,
    length: u64,
) -> Result<(Origin, ResumableRender), ReadError> {
    let content = verify(&mut reader, length)?;
    unpack_all(&mut reader.take(content), content)
}

/// Checks format and hash of a file of `length` bytes, and seeks to its header. Returns the number of
/// bytes from there to the hash.
fn verify(reader: &mut (impl Read + Seek), length: u64) -> Result<u64, ReadError> {
    let start = (MAGIC.len() + size_of_val(&FORMAT)) as u64;
    let mut magic = Vec::new();
    reader.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic)?;
    if magic != MAGIC {
        return Err(ReadError::Foreign);
    }
    match u32::from_le_bytes(array(reader)?) {
        FORMAT => {}
        other => return Err(ReadError::Format(other)),
    }
    let content =
        length.checked_sub(start + HASH_BYTES).ok_or(ReadError::Damaged("its end is missing"))?;
    check_hash(reader, content)?;
    reader.seek(io::SeekFrom::Start(start))?;
    Ok(content)
}

/// Checks that the hash is that of all bytes before it, of which `content` remain.
fn check_hash(reader: &mut impl Read, content: u64) -> Result<(), ReadError> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&MAGIC).update(&FORMAT.to_le_bytes());
    hasher.update_reader(reader.by_ref().take(content))?;
    let hash = blake3::Hash::from_bytes(array(reader)?);
    let same = hasher.finalize() == hash;
    if same { Ok(()) } else { Err(ReadError::Damaged("its bytes were changed")) }
}

/// Reads header and blocks, whose content is untrusted beyond the hash.
fn unpack_all(reader: &mut impl Read, length: u64) -> Result<(Origin, ResumableRender), ReadError> {
    let (origin, header) = read_header(reader, length)?;
    check_size(&header, length)?;
    let mut render = header.begin();
    for tiles in render.film_mut().tiles.chunks_mut(TILES) {
        let size = u32::from_le_bytes(array(reader)?);
        let block = bytes(reader, size.into(), length)?;
        unpack(&block, tiles).ok_or(ReadError::Damaged("a block cannot be unpacked"))?;
    }
    let rest = io::copy(reader, &mut io::sink())?;
    if rest == 0 { Ok((origin, render)) } else { Err(ReadError::Damaged("it is too long")) }
}

/// Reads all except the sums.
fn read_header(reader: &mut impl Read, length: u64) -> Result<(Origin, RenderHeader), ReadError> {
    let size = u64::from_le_bytes(array(reader)?);
    let head = bytes(reader, size, length)?;
    let unread = |_| ReadError::Damaged("its header cannot be read");
    let (program, head) = postcard::take_from_bytes::<String>(&head).map_err(unread)?;
    if program != PROGRAM {
        return Err(ReadError::Program(program));
    }
    let (origin, header): (Origin, RenderHeader) = postcard::from_bytes(head).map_err(unread)?;
    header.check().map_err(ReadError::Damaged)?;
    Ok((origin, header))
}

/// Checks that the file is long enough for the sums, and that there is memory for them.
fn check_size(header: &RenderHeader, length: u64) -> Result<(), ReadError> {
    let sums = header.pixels() * size_of::<[f64; 3]>() as u64;
    if sums / MAX_RATIO > length {
        return Err(ReadError::Damaged("it is too short for its picture"));
    }
    memory::check(header.film_bytes()).map_err(ReadError::Memory)
}

/// Reads the next bytes, if they are at most `length`.
fn bytes(reader: &mut impl Read, count: u64, length: u64) -> Result<Vec<u8>, ReadError> {
    if count > length {
        return Err(ReadError::Damaged("its end is missing"));
    }
    let mut bytes = vec![0; count as usize];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}
