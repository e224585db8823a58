//! A file becomes an unfinished render.

use super::blocks::{PACKED, TILES, unpack};
use super::{FORMAT, MAGIC, Origin, PROGRAM};
use crate::memory::{self, Shortage};
use crate::render::{Outline, ResumableRender, Status};
use crate::sealed::SEAL;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Seek};
use std::path::{Path, PathBuf};

/// Why a file cannot be gone on from.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// It is not there, or the system does not let it be read.
    #[error("{}: cannot be read: {}", .0.display(), .1)]
    Read(PathBuf, io::Error),
    /// It is something else.
    #[error("{}: is no checkpoint of a render; name a file that a render kept", .0.display())]
    Foreign(PathBuf),
    /// Bytes are missing or others.
    #[error(
        "{}: is damaged: {}; go on from a copy of it, or render anew", .0.display(), .1
    )]
    Damaged(PathBuf, &'static str),
    /// Another format.
    #[error(
        "{}: has version {} of the format of checkpoints, and this program reads version {FORMAT}; go \
         on with the program that wrote it", .0.display(), .1
    )]
    Format(PathBuf, u32),
    /// Another program.
    #[error(
        "{}: was written by spherule {}, and this is {PROGRAM}, which may make another picture; go on \
         with that version", .0.display(), .1
    )]
    Program(PathBuf, String),
    /// There is not enough memory for what it holds.
    #[error("{}: needs {}", .0.display(), .1)]
    Memory(PathBuf, Shortage),
}

/// Reads what [`super::write()`] wrote.
///
/// # Errors
/// It cannot be read, is no checkpoint, or not one of this version of the program; a byte of it is
/// missing or not what was written; or there is not enough memory.
pub fn read(path: &Path) -> Result<(Origin, ResumableRender), CheckpointError> {
    let failed = |error| CheckpointError::Read(path.to_owned(), error);
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?;
    if !length.is_file() {
        return Err(CheckpointError::Foreign(path.to_owned()));
    }
    read_from(BufReader::new(file), length.len()).map_err(|fault| fault.of(path))
}

/// Reads how far a render is that [`super::write()`] wrote, without its sums.
///
/// # Errors
/// Those of [`read`], but for memory.
pub fn inspect(path: &Path) -> Result<(Origin, Status), CheckpointError> {
    let failed = |error| CheckpointError::Read(path.to_owned(), error);
    let file = File::open(path).map_err(failed)?;
    let length = file.metadata().map_err(failed)?;
    if !length.is_file() {
        return Err(CheckpointError::Foreign(path.to_owned()));
    }
    let read = |mut reader: BufReader<File>| {
        let sealed = check_seal(&mut reader, length.len())?;
        let (origin, outline) = head(&mut reader.take(sealed), sealed)?;
        Ok((origin, outline.status()))
    };
    read(BufReader::new(file)).map_err(|fault: Fault| fault.of(path))
}

/// Why bytes cannot be gone on from.
pub(super) enum Fault {
    Read(io::Error),
    Foreign,
    Damaged(&'static str),
    Format(u32),
    Program(String),
    Memory(Shortage),
}

impl Fault {
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

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        let short = error.kind() == ErrorKind::UnexpectedEof;
        if short { Self::Damaged("its end is missing") } else { Self::Read(error) }
    }
}

/// From a reader of so many bytes.
pub(super) fn read_from(
    mut reader: impl Read + Seek,
    length: u64,
) -> Result<(Origin, ResumableRender), Fault> {
    let sealed = check_seal(&mut reader, length)?;
    unpack_all(&mut reader.take(sealed), sealed)
}

/// Checks format and hash of a file of so many bytes, and returns to its head. The number of bytes from
/// there to the hash.
fn check_seal(reader: &mut (impl Read + Seek), length: u64) -> Result<u64, Fault> {
    let start = (MAGIC.len() + size_of_val(&FORMAT)) as u64;
    let mut magic = Vec::new();
    reader.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic)?;
    if magic != MAGIC {
        return Err(Fault::Foreign);
    }
    match u32::from_le_bytes(array(reader)?) {
        FORMAT => {}
        other => return Err(Fault::Format(other)),
    }
    let sealed = length.checked_sub(start + SEAL).ok_or(Fault::Damaged("its end is missing"))?;
    check_hash(reader, sealed)?;
    reader.seek(io::SeekFrom::Start(start))?;
    Ok(sealed)
}

/// Whether the hash is that of all that comes before it; `sealed` bytes of that are left.
fn check_hash(reader: &mut impl Read, sealed: u64) -> Result<(), Fault> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&MAGIC).update(&FORMAT.to_le_bytes());
    hasher.update_reader(reader.by_ref().take(sealed))?;
    let hash = blake3::Hash::from_bytes(array(reader)?);
    let same = hasher.finalize() == hash;
    if same { Ok(()) } else { Err(Fault::Damaged("its bytes are not those that were written")) }
}

/// Head and blocks; of what they say, only that has been checked that someone made a hash of it.
fn unpack_all(reader: &mut impl Read, length: u64) -> Result<(Origin, ResumableRender), Fault> {
    let (origin, outline) = head(reader, length)?;
    check_size(&outline, length)?;
    let mut render = outline.begin();
    for tiles in render.film_mut().tiles.chunks_mut(TILES) {
        let size = u32::from_le_bytes(array(reader)?);
        let block = bytes(reader, size.into(), length)?;
        unpack(&block, tiles).ok_or(Fault::Damaged("a block cannot be unpacked"))?;
    }
    let rest = io::copy(reader, &mut io::sink())?;
    if rest == 0 { Ok((origin, render)) } else { Err(Fault::Damaged("it is too long")) }
}

/// All but the sums.
fn head(reader: &mut impl Read, length: u64) -> Result<(Origin, Outline), Fault> {
    let size = u64::from_le_bytes(array(reader)?);
    let head = bytes(reader, size, length)?;
    let unread = |_| Fault::Damaged("its head cannot be read");
    let (program, head) = postcard::take_from_bytes::<String>(&head).map_err(unread)?;
    if program != PROGRAM {
        return Err(Fault::Program(program));
    }
    let (origin, outline): (Origin, Outline) = postcard::from_bytes(head).map_err(unread)?;
    outline.check().map_err(Fault::Damaged)?;
    Ok((origin, outline))
}

/// Whether so few bytes can hold the sums, and there is memory for them.
fn check_size(outline: &Outline, length: u64) -> Result<(), Fault> {
    let pixels = u64::from(outline.region.width) * u64::from(outline.region.height);
    let sums = pixels * size_of::<[f64; 3]>() as u64;
    if sums / PACKED > length {
        return Err(Fault::Damaged("it is too short for its picture"));
    }
    memory::check(outline.film_bytes()).map_err(Fault::Memory)
}

/// The next bytes, of which there are no more than `length`.
fn bytes(reader: &mut impl Read, count: u64, length: u64) -> Result<Vec<u8>, Fault> {
    if count > length {
        return Err(Fault::Damaged("its end is missing"));
    }
    let mut bytes = vec![0; count as usize];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}

fn array<const N: usize>(reader: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}
