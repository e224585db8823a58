//! The GSD container: named chunks of numbers with an index (gsd.readthedocs.io, "File layer").

use crate::scalar::{Order, Scalar};
use crate::{FileError, binary::BinaryFile};
use std::collections::{BTreeMap, HashMap};

/// Magic number of a file.
pub(in super::super) const MAGIC: [u8; 8] = 0x65DF_65DF_65DF_65DF_u64.to_le_bytes();

/// Bytes of the header; bytes of an index entry follow.
const HEADER: u64 = 256;
const ENTRY: u64 = 32;

/// Maximum number of bytes for the names of a file.
const NAMES: u64 = 1 << 24;

/// An open file.
pub(super) struct File {
    content: BinaryFile,
    names: HashMap<String, u16>,
    /// Chunks by frame and name.
    chunks: BTreeMap<(u64, u16), Chunk>,
}

/// Offset and shape of a chunk.
#[derive(Clone, Copy)]
struct Chunk {
    rows: u64,
    width: u64,
    location: u64,
    kind: u8,
}

/// Number of rows per read.
const ROWS: u64 = 1 << 14;

fn word(bytes: &[u8], at: usize) -> u64 {
    bytes.get(at..at + 8).and_then(|word| word.try_into().ok()).map_or(0, u64::from_le_bytes)
}

impl File {
    pub(super) fn open(content: BinaryFile) -> Result<Self, FileError> {
        let (names, chunks) = (HashMap::new(), BTreeMap::new());
        let mut file = Self { content, names, chunks };
        let header = file.content.bytes(0, HEADER)?;
        let version = word(&header, 44) >> 16 & 0xFFFF;
        if !(1..=2).contains(&version) {
            let message = format!("is GSD of version {version}, but 1 and 2 are read");
            return Err(file.content.fault(message).with_help("upgrade it to version 2"));
        }
        let schema: Vec<u8> =
            header[112..176].iter().copied().take_while(|&byte| byte > 0).collect();
        if schema != b"hoomd" {
            let message = format!("holds `{}`, not particles", String::from_utf8_lossy(&schema));
            let error = file.content.fault(message);
            return Err(error.with_help("only the schema hoomd is supported"));
        }
        file.read_names(word(&header, 24), word(&header, 32), version)?;
        file.read_index(word(&header, 8), word(&header, 16))?;
        Ok(file)
    }

    /// Reads the names, which are in fields of 64 bytes or, since version 2, null-terminated.
    fn read_names(&mut self, location: u64, fields: u64, version: u64) -> Result<(), FileError> {
        let length = fields.saturating_mul(64).min(NAMES);
        let bytes = self.content.bytes(location, length)?;
        let name = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let names: Vec<String> = if version == 1 {
            let fields = bytes.chunks(64);
            let fields = fields.map(|field| field.split(|&byte| byte == 0).next().unwrap_or(field));
            fields.take_while(|field| !field.is_empty()).map(name).collect()
        } else {
            let fields = bytes.split(|&byte| byte == 0);
            fields.take_while(|field| !field.is_empty()).map(name).collect()
        };
        self.names = names.into_iter().zip(0..=u16::MAX).collect();
        Ok(())
    }

    fn read_index(&mut self, location: u64, entries: u64) -> Result<(), FileError> {
        let bytes = self.content.bytes(location, entries.saturating_mul(ENTRY))?;
        for entry in bytes.chunks_exact(ENTRY as usize) {
            let last = word(entry, 24);
            let (frame, location) = (word(entry, 0), word(entry, 16));
            // Unused entries are zero.
            if location > 0 {
                let chunk = Chunk {
                    rows: word(entry, 8),
                    width: last & 0xFFFF_FFFF,
                    location,
                    kind: (last >> 48) as u8,
                };
                self.chunks.insert((frame, (last >> 32) as u16), chunk);
            }
        }
        // Every frame has at least one chunk: its step.
        let (frames, chunks) = (self.frames(), self.chunks.len() as u64);
        if frames > chunks {
            let message = format!("has an index of {frames} frames, but of {chunks} chunks");
            let error = self.content.fault(message);
            return Err(error.with_help("the index is damaged: copy the file again"));
        }
        Ok(())
    }

    /// Returns the number of frames.
    pub(super) fn frames(&self) -> u64 {
        self.chunks.last_key_value().map_or(0, |(&(frame, _), _)| frame.saturating_add(1))
    }

    /// Returns the names of all chunks.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.names.keys().map(String::as_str)
    }

    /// Returns the numbers of a chunk, row by row, if the frame has it.
    pub(super) fn numbers(
        &mut self,
        frame: u64,
        name: &str,
    ) -> Result<Option<Vec<f64>>, FileError> {
        let Some(chunk) = self.chunk(frame, name) else { return Ok(None) };
        let scalar = self.scalar(chunk, frame, name)?;
        let mut values = Vec::new();
        self.each_block(chunk, scalar.size(), |bytes| {
            let numbers = bytes.chunks_exact(scalar.size());
            values.extend(numbers.map(|bytes| scalar.read(bytes, Order::Little)));
        })?;
        Ok(Some(values))
    }

    /// Returns columns of a chunk, selected by index, if the frame has it. Makes no other copy of the
    /// numbers.
    pub(super) fn columns(
        &mut self,
        frame: u64,
        name: &str,
        places: &[usize],
    ) -> Result<Option<Vec<Vec<f64>>>, FileError> {
        let Some(chunk) = self.chunk(frame, name) else { return Ok(None) };
        let scalar = self.scalar(chunk, frame, name)?;
        let size = scalar.size();
        let row = chunk.width.saturating_mul(size as u64);
        self.content.check_range(chunk.location, chunk.rows.saturating_mul(row))?;
        let rows = if row == 0 { 0 } else { chunk.rows };
        let column = |_| Vec::with_capacity(rows as usize);
        let mut columns: Vec<Vec<f64>> = places.iter().map(column).collect();
        self.each_block(chunk, size, |bytes| {
            for row in bytes.chunks_exact(size.saturating_mul(chunk.width as usize).max(1)) {
                for (column, place) in columns.iter_mut().zip(places) {
                    let number = row.get(place * size..(place + 1) * size);
                    column.extend(number.map(|bytes| scalar.read(bytes, Order::Little)));
                }
            }
        })?;
        Ok(Some(columns))
    }

    /// Calls a function with the bytes of a chunk, in blocks of whole rows.
    fn each_block(
        &mut self,
        chunk: Chunk,
        size: usize,
        mut each: impl FnMut(&[u8]),
    ) -> Result<(), FileError> {
        let row = chunk.width.saturating_mul(size as u64);
        self.content.check_range(chunk.location, chunk.rows.saturating_mul(row))?;
        // Empty rows have no block.
        let rows = if row == 0 { 0 } else { chunk.rows };
        for first in (0..rows).step_by(ROWS as usize) {
            let count = ROWS.min(rows - first);
            each(&self.content.bytes(chunk.location + first * row, count * row)?);
        }
        Ok(())
    }

    /// Returns the type of a chunk's numbers.
    fn scalar(&self, chunk: Chunk, frame: u64, name: &str) -> Result<Scalar, FileError> {
        Ok(match chunk.kind {
            1 => Scalar::U8,
            2 => Scalar::U16,
            3 => Scalar::U32,
            4 => Scalar::U64,
            5 => Scalar::I8,
            6 => Scalar::I16,
            7 => Scalar::I32,
            8 => Scalar::I64,
            9 => Scalar::F32,
            10 => Scalar::F64,
            kind => {
                let message = format!("{name} of frame {frame} is of the unknown type {kind}");
                return Err(self.content.fault(message));
            }
        })
    }

    /// Returns the texts of a chunk, one per row, if the frame has it.
    pub(super) fn texts(
        &mut self,
        frame: u64,
        name: &str,
    ) -> Result<Option<Vec<String>>, FileError> {
        let Some(chunk) = self.chunk(frame, name) else { return Ok(None) };
        let bytes = self.content.bytes(chunk.location, chunk.rows.saturating_mul(chunk.width))?;
        let rows = bytes.chunks((chunk.width as usize).max(1));
        let text = |row: &[u8]| {
            let end = row.iter().position(|&byte| byte == 0).unwrap_or(row.len());
            String::from_utf8_lossy(&row[..end]).into_owned()
        };
        Ok(Some(rows.map(text).collect()))
    }

    /// Returns the number of rows of a chunk and of numbers per row, if the frame has it.
    pub(super) fn size(&self, frame: u64, name: &str) -> Option<(u64, u64)> {
        self.chunk(frame, name).map(|chunk| (chunk.rows, chunk.width))
    }

    /// Returns a chunk of numbers, if the frame has it.
    pub(super) fn shape(&self, frame: u64, name: &str) -> Option<(u64, u64)> {
        let chunk = self.chunk(frame, name).filter(|chunk| (1..=10).contains(&chunk.kind))?;
        Some((chunk.rows, chunk.width))
    }

    fn chunk(&self, frame: u64, name: &str) -> Option<Chunk> {
        let id = *self.names.get(name)?;
        self.chunks.get(&(frame, id)).copied()
    }
}
