//! Datasets and attributes of an HDF5 file: their types, and rows of their values, decoded.

use super::file::{ATTRIBUTE, DATASPACE, DATATYPE, FILTERS, Fields, File, LAYOUT, Message};
use super::index::{Chunks, Index};
use super::tree::Chunk;
use crate::scalar::{Order, Scalar};
use crate::{FileError, memory};
use flate2::read::ZlibDecoder;
use std::collections::BTreeMap;
use std::io::Read;

/// Most dimensions of a dataset.
const MOST_DIMENSIONS: usize = 32;

/// Most bytes that a byte of deflate can hold.
const DEFLATE: u64 = 1032;

/// Most bytes of decoded chunks that are kept for the next rows.
const KEPT: u64 = 1 << 28;

/// The type of values.
#[derive(Clone, Debug)]
pub(super) enum Datatype {
    /// Numbers, and their names if they are an enumeration.
    Number {
        scalar: Scalar,
        order: Order,
        names: Vec<(i64, String)>,
    },
    /// Texts of this many bytes.
    Text(usize),
    /// Texts of variable length, as references to a heap.
    VariableText(usize),
    Other,
}

/// A dataset.
pub(super) struct Dataset {
    pub(super) shape: Vec<u64>,
    pub(super) datatype: Datatype,
    layout: Layout,
    filters: Vec<Filter>,
    attributes: Vec<(String, Values)>,
    /// Decoded chunks that hold more rows than the last one that was read.
    kept: BTreeMap<u64, Vec<u8>>,
}

/// Values of an attribute or of a small dataset.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

enum Layout {
    Compact(Vec<u8>),
    Contiguous(Option<u64>),
    Chunked(Chunks),
}

/// A filter of chunks, with the number of its first parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Filter {
    Deflate,
    Shuffle,
    Checksum,
    Lzf,
}

impl Datatype {
    /// Returns the bytes of a value.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Number { scalar, .. } => scalar.size(),
            Self::Text(size) | Self::VariableText(size) => *size,
            Self::Other => 1,
        }
    }

    fn parse(mut fields: Fields) -> Option<Self> {
        let class = fields.byte()?;
        let [first, ..] = *fields.take(3)? else { return None };
        let size = fields.number(4)? as usize;
        let order = if first & 1 == 0 { Order::Little } else { Order::Big };
        let scalar = match (class & 0xF, size, first & 8 != 0) {
            (0 | 4, 1, true) => Scalar::I8,
            (0 | 4, 1, false) => Scalar::U8,
            (0 | 4, 2, true) => Scalar::I16,
            (0 | 4, 2, false) => Scalar::U16,
            (0 | 4, 4, true) => Scalar::I32,
            (0 | 4, 4, false) => Scalar::U32,
            (0 | 4, 8, true) => Scalar::I64,
            (0 | 4, 8, false) => Scalar::U64,
            (1, 2, _) => Scalar::F16,
            (1, 4, _) => Scalar::F32,
            (1, 8, _) => Scalar::F64,
            (3, ..) => return (size > 0).then_some(Self::Text(size)),
            (8, ..) => return Self::enumeration(fields, class >> 4, first),
            (9, ..) if first & 0xF == 1 => return Some(Self::VariableText(size.max(1))),
            _ => return Some(Self::Other),
        };
        Some(Self::Number { scalar, order, names: Vec::new() })
    }

    /// Parses an enumeration: its base type, its names, and their values.
    fn enumeration(mut fields: Fields, version: u8, low: u8) -> Option<Self> {
        let base = fields.clone();
        // A whole number has 12 bytes.
        fields.take(12)?;
        let Self::Number { scalar, order, .. } = Self::parse(base)? else {
            return Some(Self::Other);
        };
        let mut texts = Vec::new();
        for _ in 0..low {
            let length = fields.rest.iter().position(|&byte| byte == 0)?;
            let padding = if version < 3 { 7 - length % 8 } else { 0 };
            let name = fields.take(length + 1)?;
            fields.take(padding)?;
            texts.push(String::from_utf8_lossy(&name[..length]).into_owned());
        }
        let mut names = Vec::new();
        for text in texts {
            names.push((scalar.read(fields.take(scalar.size())?, order) as i64, text));
        }
        Some(Self::Number { scalar, order, names })
    }

    /// Returns values of this type.
    fn values(&self, file: &mut File, bytes: &[u8]) -> Result<Option<Values>, FileError> {
        let each = bytes.chunks_exact(self.size());
        Ok(match self {
            Self::Number { scalar, order, .. } => {
                Some(Values::Numbers(each.map(|bytes| scalar.read(bytes, *order)).collect()))
            }
            Self::Text(_) => {
                let text = |bytes: &[u8]| {
                    let bytes = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
                    String::from_utf8_lossy(bytes).trim_end().to_owned()
                };
                Some(Values::Texts(each.map(text).collect()))
            }
            Self::VariableText(_) => {
                let texts = each.map(|reference| file.heap_text(reference));
                Some(Values::Texts(texts.collect::<Result<_, _>>()?))
            }
            Self::Other => None,
        })
    }
}

impl Values {
    /// Returns the only number.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Numbers(numbers) if numbers.len() == 1 => Some(numbers[0]),
            _ => None,
        }
    }

    /// Returns the first text.
    pub(super) fn text(&self) -> Option<&str> {
        match self {
            Self::Texts(texts) => texts.first().map(String::as_str),
            Self::Numbers(_) => None,
        }
    }
}

impl Filter {
    fn of(number: u64) -> Option<Self> {
        Some(match number {
            1 => Self::Deflate,
            2 => Self::Shuffle,
            3 => Self::Checksum,
            32_000 => Self::Lzf,
            _ => return None,
        })
    }
}

impl File {
    /// Returns an object's dataset; `None` if it is a group.
    pub(super) fn dataset(&mut self, at: u64) -> Result<Option<Dataset>, FileError> {
        let messages = self.messages(at)?;
        let find = |kind: u16| messages.iter().find(|message| message.kind == kind);
        let (Some(space), Some(datatype), Some(layout)) =
            (find(DATASPACE), find(DATATYPE), find(LAYOUT))
        else {
            return Ok(None);
        };
        let space = dataspace(self.fields(&space.data));
        let (shape, most) = space.ok_or_else(|| self.damaged("the shape of a dataset"))?;
        let datatype = Datatype::parse(self.fields(&datatype.data));
        let datatype = datatype.ok_or_else(|| self.damaged("the type of a dataset"))?;
        let mut filters = Vec::new();
        if let Some(message) = find(FILTERS) {
            let numbers = filter_numbers(self.fields(&message.data));
            for number in numbers.ok_or_else(|| self.damaged("the filters of a dataset"))? {
                let filter = Filter::of(number);
                let name = || format!("data that are compressed by filter {number}");
                filters.push(filter.ok_or_else(|| self.unsupported(&name()))?);
            }
        }
        let (size, is_filtered) = (datatype.size(), !filters.is_empty());
        let layout = self.layout(&layout.data, &shape, &most, size, is_filtered)?;
        let attributes = self.attributes(&messages);
        let kept = BTreeMap::new();
        Ok(Some(Dataset { shape, datatype, layout, filters, attributes, kept }))
    }

    /// Returns the attributes of an object.
    pub(super) fn attributes_of(&mut self, at: u64) -> Result<Vec<(String, Values)>, FileError> {
        let messages = self.messages(at)?;
        Ok(self.attributes(&messages))
    }

    fn attributes(&mut self, messages: &[Message]) -> Vec<(String, Values)> {
        let mut attributes = Vec::new();
        for message in messages.iter().filter(|message| message.kind == ATTRIBUTE) {
            let Some((name, datatype, bytes)) = attribute(self.fields(&message.data)) else {
                continue;
            };
            // Attributes are hints: those that cannot be read are left out.
            if let Ok(Some(values)) = datatype.values(self, bytes) {
                attributes.push((name, values));
            }
        }
        attributes
    }

    fn layout(
        &mut self,
        message: &[u8],
        shape: &[u64],
        most: &[Option<u64>],
        size: usize,
        is_filtered: bool,
    ) -> Result<Layout, FileError> {
        let mut fields = self.fields(message);
        let (version, class) = (fields.byte().unwrap_or(0), fields.byte().unwrap_or(9));
        let parsed = match (version, class) {
            (3..=5, 0) => fields
                .number(2)
                .and_then(|length| Some(Layout::Compact(fields.take(length as usize)?.to_vec()))),
            (3..=5, 1) => fields.address().map(Layout::Contiguous),
            (3, 2) => old_chunks(&mut fields, shape.len()),
            (4 | 5, 2) => new_chunks(&mut fields, shape.len(), is_filtered),
            (1 | 2, _) => return Err(self.unsupported("a layout of HDF5 1.6 and older")),
            (3..=5, 3) => return Err(self.unsupported("a virtual dataset")),
            _ => None,
        };
        let mut layout = parsed.ok_or_else(|| self.damaged("the layout of a dataset"))?;
        if let Layout::Chunked(chunks) = &mut layout {
            let bytes = chunks.lengths.iter().try_fold(size as u64, |bytes, &length| {
                bytes.checked_mul(length).filter(|_| length > 0)
            });
            chunks.bytes = bytes.ok_or_else(|| self.damaged("the chunks of a dataset"))?;
            chunks.is_filtered = is_filtered;
            let count =
                |(most, length): (&Option<u64>, &u64)| most.map(|most| most.div_ceil(*length));
            chunks.most = most.iter().zip(&chunks.lengths).map(count).collect();
        }
        Ok(layout)
    }
}

impl Dataset {
    /// Returns the value of an attribute.
    pub(super) fn attribute(&self, name: &str) -> Option<&Values> {
        self.attributes.iter().find(|(own, _)| own == name).map(|(_, values)| values)
    }

    /// Returns all values of a small dataset; `None` if their type is not supported.
    pub(super) fn all(&mut self, file: &mut File) -> Result<Option<Values>, FileError> {
        let datatype = self.datatype.clone();
        let bytes = self.rows(file, None)?;
        datatype.values(file, &bytes)
    }

    /// Returns the bytes of a row of the first dimension, or of everything.
    pub(super) fn rows(&mut self, file: &mut File, row: Option<u64>) -> Result<Vec<u8>, FileError> {
        let (mut start, mut count) = (vec![0; self.shape.len()], self.shape.clone());
        if let (Some(row), Some(rows)) = (row, self.shape.first()) {
            if row >= *rows {
                return Err(file.damaged("a row of a dataset"));
            }
            (start[0], count[0]) = (row, 1);
        }
        let size = self.datatype.size() as u64;
        let product = |lengths: &[u64]| {
            lengths.iter().try_fold(size, |product, &length| product.checked_mul(length))
        };
        let bytes = product(&count).ok_or_else(|| file.damaged("the shape of a dataset"))?;
        if bytes == 0 {
            return Ok(Vec::new());
        }
        let skipped = start.first().unwrap_or(&0).checked_mul(bytes);
        let skipped = skipped.ok_or_else(|| file.damaged("the shape of a dataset"))?;
        match &self.layout {
            Layout::Compact(values) => {
                let found = usize::try_from(skipped).ok().and_then(|at| values.get(at..));
                let found = found.and_then(|values| values.get(..usize::try_from(bytes).ok()?));
                Ok(found.ok_or_else(|| file.damaged("a dataset"))?.to_vec())
            }
            Layout::Contiguous(Some(at)) => file.values(at.saturating_add(skipped), bytes),
            Layout::Contiguous(None) => Err(not_written(file)),
            Layout::Chunked(chunks) => {
                if bytes > file.content.length().saturating_mul(DEFLATE) {
                    return Err(not_written(file));
                }
                memory::check(bytes).map_err(|shortage| {
                    file.content
                        .fault(format!("has {bytes} bytes per frame, which need {shortage}"))
                })?;
                let chunks = chunks.clone();
                self.chunked(file, &chunks, &Block { start, count }, bytes)
            }
        }
    }

    /// Reads a block of a chunked dataset.
    fn chunked(
        &mut self,
        file: &mut File,
        chunks: &Chunks,
        block: &Block,
        bytes: u64,
    ) -> Result<Vec<u8>, FileError> {
        let axes = || block.start.iter().zip(&block.count).zip(&chunks.lengths);
        let low: Vec<u64> = axes().map(|((start, _), length)| start / length).collect();
        let high: Vec<u64> =
            axes().map(|((start, count), length)| (start + count - 1) / length).collect();
        let mut needed: BTreeMap<Vec<u64>, Chunk> = BTreeMap::new();
        let is_near = |chunk: &Chunk| {
            let mut places = chunk.offset.iter().zip(&chunks.lengths).zip(low.iter().zip(&high));
            places.all(|((offset, length), (low, high))| {
                offset % length == 0 && (*low..=*high).contains(&(offset / length))
            })
        };
        for chunk in chunks.find(file, &low, &high)?.into_iter().filter(is_near) {
            needed.insert(chunk.offset.clone(), chunk);
        }
        let all = low
            .iter()
            .zip(&high)
            .try_fold(1_u64, |all, (low, high)| all.checked_mul(high - low + 1));
        if all != Some(needed.len() as u64) {
            return Err(not_written(file));
        }
        // Chunks do not overlap: together they are no longer than the file, and do not expand more than that.
        let stored = needed.values().fold(0, |sum: u64, chunk| sum.saturating_add(chunk.stored));
        if stored > file.content.length() {
            return Err(file.damaged("a chunk"));
        }
        let is_divided = chunks.lengths[0] > block.count[0];
        let mut kept = BTreeMap::new();
        let mut values = vec![0; bytes as usize];
        let size = self.datatype.size();
        for chunk in needed.values() {
            let decoded = match self.kept.remove(&chunk.at) {
                Some(decoded) => decoded,
                None => self.decoded(file, chunk, chunks.bytes)?,
            };
            block.copy(&mut values, &decoded, &chunk.offset, &chunks.lengths, size);
            let held = (kept.len() as u64 + 1).saturating_mul(chunks.bytes);
            if is_divided && held <= KEPT {
                kept.insert(chunk.at, decoded);
            }
        }
        self.kept = kept;
        Ok(values)
    }

    /// Returns the values of a chunk, of which `bytes` are expected.
    fn decoded(&self, file: &mut File, chunk: &Chunk, bytes: u64) -> Result<Vec<u8>, FileError> {
        let most = file.content.length().saturating_mul(DEFLATE);
        if bytes > most || chunk.stored > bytes.saturating_mul(2).saturating_add(1 << 10) {
            return Err(file.damaged("a chunk"));
        }
        memory::check(bytes).map_err(|shortage| {
            file.content.fault(format!("has chunks of {bytes} bytes, which need {shortage}"))
        })?;
        let mut values = file.values(chunk.at, chunk.stored)?;
        for (place, filter) in self.filters.iter().enumerate().rev() {
            if chunk.mask >> place & 1 == 1 {
                continue;
            }
            let decoded = match filter {
                Filter::Deflate => inflated(&values, bytes + 4),
                Filter::Shuffle => Some(unshuffled(&values, self.datatype.size())),
                Filter::Checksum => values.split_last_chunk::<4>().map(|(rest, _)| rest.to_vec()),
                Filter::Lzf => unpacked(&values, bytes + 4),
            };
            values = decoded.ok_or_else(|| file.damaged("a chunk"))?;
        }
        if values.len() as u64 == bytes { Ok(values) } else { Err(file.damaged("a chunk")) }
    }
}

/// A block of a dataset.
struct Block {
    start: Vec<u64>,
    count: Vec<u64>,
}

impl Block {
    /// Copies what a chunk has of a block. Offsets within both fit in memory.
    fn copy(&self, values: &mut [u8], chunk: &[u8], offset: &[u64], lengths: &[u64], size: usize) {
        let rank = self.start.len();
        let ends = |start: &[u64], count: &[u64]| -> Vec<u64> {
            start.iter().zip(count).map(|(start, count)| start.saturating_add(*count)).collect()
        };
        let low: Vec<u64> = self.start.iter().zip(offset).map(|(a, b)| *a.max(b)).collect();
        let own = ends(&self.start, &self.count);
        let high: Vec<u64> =
            own.iter().zip(ends(offset, lengths)).map(|(a, b)| (*a).min(b)).collect();
        if low.iter().zip(&high).any(|(low, high)| low >= high) {
            return;
        }
        let index = |place: &[u64], start: &[u64], lengths: &[u64]| {
            let axes = place.iter().zip(start).zip(lengths);
            axes.fold(0, |index, ((place, start), length)| index * length + place - start) as usize
        };
        // Dimensions that are copied as one run: the last one, and those before it if they are whole.
        let is_whole = |axis: usize| {
            low[axis] == self.start[axis]
                && high[axis] == own[axis]
                && low[axis] == offset[axis]
                && self.count[axis] == lengths[axis]
        };
        let mut outer = rank - 1;
        while outer > 0 && is_whole(outer) {
            outer -= 1;
        }
        let run = (outer..rank).map(|axis| high[axis] - low[axis]).product::<u64>() as usize * size;
        let mut place = low.clone();
        loop {
            let to = index(&place, &self.start, &self.count) * size;
            let from = index(&place, offset, lengths) * size;
            values[to..to + run].copy_from_slice(&chunk[from..from + run]);
            let next = (0..outer).rev().find(|&axis| place[axis] + 1 < high[axis]);
            let Some(axis) = next else { break };
            place[axis] += 1;
            place[axis + 1..outer].copy_from_slice(&low[axis + 1..outer]);
        }
    }
}

/// Returns an error about values that are not in the file.
fn not_written(file: &File) -> FileError {
    let error = file.content.fault("has a dataset whose values were not all written");
    let error =
        error.with_help("copy it again, after the simulation has ended; --frame chooses a frame");
    FileError { cut_off: true, ..error }
}

/// Returns the lengths of dimensions, and those that they can grow to.
fn dataspace(mut fields: Fields) -> Option<(Vec<u64>, Vec<Option<u64>>)> {
    let version = fields.byte()?;
    let (rank, flags) = (usize::from(fields.byte()?), fields.byte()?);
    fields.take(if version == 1 { 5 } else { 1 })?;
    if rank > MOST_DIMENSIONS || !matches!(version, 1 | 2) {
        return None;
    }
    let shape = (0..rank).map(|_| fields.length()).collect::<Option<Vec<u64>>>()?;
    if flags & 1 == 0 {
        let most = shape.iter().copied().map(Some).collect();
        return Some((shape, most));
    }
    let most = (0..rank).map(|_| fields.length().map(|most| (most != u64::MAX).then_some(most)));
    let most = most.collect::<Option<_>>()?;
    Some((shape, most))
}

/// Returns the numbers of filters in the order in which they were applied.
fn filter_numbers(mut fields: Fields) -> Option<Vec<u64>> {
    let version = fields.byte()?;
    let count = fields.byte()?;
    fields.take(if version == 1 { 6 } else { 0 })?;
    let mut numbers = Vec::new();
    for _ in 0..count {
        let number = fields.number(2)?;
        let is_named = version == 1 || number >= 256;
        let name = if is_named { fields.number(2)? as usize } else { 0 };
        fields.take(2)?;
        let parameters = fields.number(2)? as usize;
        fields.take(if version == 1 { name.next_multiple_of(8) } else { name })?;
        fields.take(4 * parameters)?;
        fields.take(if version == 1 && parameters % 2 == 1 { 4 } else { 0 })?;
        numbers.push(number);
    }
    Some(numbers)
}

/// Returns the chunks of a layout of version 3; the last length is that of a value.
fn old_chunks(fields: &mut Fields, rank: usize) -> Option<Layout> {
    let dimensions = usize::from(fields.byte()?);
    let index = fields.address()?.map_or(Index::Empty, Index::Tree);
    let lengths = (0..rank).map(|_| fields.number(4)).collect::<Option<Vec<u64>>>()?;
    chunks(Chunks { index, lengths, is_filtered: false, most: Vec::new(), bytes: 0 }, dimensions)
}

/// Returns the chunks of a layout of version 4 or 5.
fn new_chunks(fields: &mut Fields, rank: usize, is_filtered: bool) -> Option<Layout> {
    let flags = fields.byte()?;
    let (dimensions, size) = (usize::from(fields.byte()?), usize::from(fields.byte()?));
    let lengths = (0..rank).map(|_| fields.number(size)).collect::<Option<Vec<u64>>>()?;
    fields.number(size)?;
    let kind = fields.byte()?;
    let mut filtered = None;
    match kind {
        1 if flags & 2 != 0 && is_filtered => {
            filtered = Some((fields.length()?, fields.number(4)? as u32));
        }
        3 => fields.take(1).map(|_| ())?,
        4 => fields.take(5).map(|_| ())?,
        5 => fields.take(6).map(|_| ())?,
        _ => (),
    }
    let at = fields.address()?;
    let index = match (kind, at) {
        (1..=5, None) => Index::Empty,
        (1, Some(at)) => Index::Single(at, filtered),
        (2, Some(at)) => Index::Implicit(at),
        (3, Some(at)) => Index::FixedArray(at),
        (4, Some(at)) => Index::ExtensibleArray(at),
        (5, Some(at)) => Index::NewTree(at),
        _ => return None,
    };
    chunks(Chunks { index, lengths, is_filtered, most: Vec::new(), bytes: 0 }, dimensions)
}

/// Returns a layout of chunks, if it has one more dimension than they have lengths: that of a value.
fn chunks(chunks: Chunks, dimensions: usize) -> Option<Layout> {
    let rank = chunks.lengths.len();
    (rank > 0 && dimensions == rank + 1).then_some(Layout::Chunked(chunks))
}

/// Returns the name, the type and the bytes of an attribute.
fn attribute(mut fields: Fields<'_>) -> Option<(String, Datatype, &[u8])> {
    let version = fields.byte()?;
    fields.take(1)?;
    let sizes = [fields.number(2)?, fields.number(2)?, fields.number(2)?].map(|size| size as usize);
    fields.take(usize::from(version == 3))?;
    let mut part = |size: usize| {
        let bytes = fields.take(if version == 1 { size.next_multiple_of(8) } else { size })?;
        Some(Fields { rest: &bytes[..size], sizes: fields.sizes })
    };
    let (name, datatype, space) = (part(sizes[0])?, part(sizes[1])?, part(sizes[2])?);
    let name = name.rest.split(|&byte| byte == 0).next()?;
    let datatype = Datatype::parse(datatype)?;
    let (shape, _) = dataspace(space)?;
    let count = shape.iter().try_fold(1, |count: u64, &length| count.checked_mul(length))?;
    let bytes = count.checked_mul(datatype.size() as u64)?;
    let bytes = fields.take(usize::try_from(bytes).ok()?)?;
    Some((String::from_utf8_lossy(name).into_owned(), datatype, bytes))
}

/// Decodes deflate to at most this many bytes.
fn inflated(bytes: &[u8], most: u64) -> Option<Vec<u8>> {
    let mut values = Vec::new();
    ZlibDecoder::new(bytes).take(most + 1).read_to_end(&mut values).ok()?;
    (values.len() as u64 <= most).then_some(values)
}

/// Puts the bytes of each value together, of which first all first ones come, then all second ones.
fn unshuffled(bytes: &[u8], size: usize) -> Vec<u8> {
    let count = bytes.len() / size.max(1);
    let mut values = bytes.to_vec();
    for (place, column) in bytes.chunks_exact(count.max(1)).take(size).enumerate() {
        for (value, &byte) in column.iter().enumerate() {
            values[value * size + place] = byte;
        }
    }
    values
}

/// Decodes LZF, which h5py writes, to at most this many bytes: runs of bytes, and copies of earlier ones.
fn unpacked(bytes: &[u8], most: u64) -> Option<Vec<u8>> {
    let mut values: Vec<u8> = Vec::new();
    let mut bytes = bytes.iter().copied();
    while let Some(control) = bytes.next() {
        let control = usize::from(control);
        if control < 32 {
            for _ in 0..=control {
                values.push(bytes.next()?);
            }
        } else {
            let mut length = control >> 5;
            if length == 7 {
                length += usize::from(bytes.next()?);
            }
            let back = (control & 0x1F) << 8 | usize::from(bytes.next()?);
            let from = values.len().checked_sub(back + 1)?;
            for at in from..from + length + 2 {
                values.push(values[at]);
            }
        }
        if values.len() as u64 > most {
            return None;
        }
    }
    Some(values)
}
