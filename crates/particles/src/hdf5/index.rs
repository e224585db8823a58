//! Indexes of chunks: where the chunks of a dataset are, by their places.
//!
//! Trees can list their chunks; in arrays, the entry of one chunk is at an offset that follows from its number.

use super::file::{Fields, File};
use super::tree::{self, Chunk};
use crate::FileError;

/// An index of chunks.
#[derive(Clone, Debug)]
pub(super) enum Index {
    /// Nothing was written yet.
    Empty,
    Tree(u64),
    NewTree(u64),
    /// One chunk: its address, and its length and mask if it is filtered.
    Single(u64, Option<(u64, u32)>),
    /// Chunks without filters one after another.
    Implicit(u64),
    FixedArray(u64),
    ExtensibleArray(u64),
}

/// The chunks of a dataset.
#[derive(Clone, Debug)]
pub(super) struct Chunks {
    pub(super) index: Index,
    /// Lengths of a chunk.
    pub(super) lengths: Vec<u64>,
    /// Number of chunks along each dimension that the dataset can grow to; none where it has no limit.
    pub(super) most: Vec<Option<u64>>,
    /// Bytes of a chunk before filters.
    pub(super) bytes: u64,
    pub(super) is_filtered: bool,
}

impl Chunks {
    /// Returns the chunks whose first value is in a block of chunks, `low` to `high` along each dimension, in
    /// any order; some of others may be among them.
    pub(super) fn find(
        &self,
        file: &mut File,
        low: &[u64],
        high: &[u64],
    ) -> Result<Vec<Chunk>, FileError> {
        let rows = [low[0] * self.lengths[0], high[0] * self.lengths[0]];
        match self.index {
            Index::Empty => Ok(Vec::new()),
            Index::Tree(at) => tree::chunks(file, at, self.lengths.len(), rows),
            Index::NewTree(at) => {
                let records = tree::records(file, at)?;
                let parse = |record: &Vec<u8>| self.record(&file.fields(record), record.len());
                let chunks = records.iter().map(parse).collect::<Option<Vec<Chunk>>>();
                chunks.ok_or_else(|| file.damaged("a tree of chunks"))
            }
            Index::Single(at, filtered) => {
                let (stored, mask) = filtered.unwrap_or((self.bytes, 0));
                Ok(vec![Chunk { offset: vec![0; low.len()], at, stored, mask }])
            }
            Index::Implicit(_) | Index::FixedArray(_) | Index::ExtensibleArray(_) => {
                self.of_array(file, low, high)
            }
        }
    }

    /// Parses a record of a tree of version 2; unfiltered chunks have no length.
    fn record(&self, fields: &Fields, length: usize) -> Option<Chunk> {
        let mut fields = fields.clone();
        let rank = self.lengths.len();
        let at = fields.address()??;
        let size = length.checked_sub(length - fields.rest.len() + 8 * rank)?;
        let (stored, mask) = match size.checked_sub(4) {
            Some(size) if self.is_filtered => (fields.number(size)?, fields.number(4)? as u32),
            _ => (self.bytes, 0),
        };
        let place = |length: &u64| fields.number(8)?.checked_mul(*length);
        let offset = self.lengths.iter().map(place).collect::<Option<_>>()?;
        Some(Chunk { offset, at, stored, mask })
    }

    /// Returns the chunks of an array in a block.
    fn of_array(
        &self,
        file: &mut File,
        low: &[u64],
        high: &[u64],
    ) -> Result<Vec<Chunk>, FileError> {
        let array = match self.index {
            Index::FixedArray(at) => Some(Array::fixed(file, at)?),
            Index::ExtensibleArray(at) => Some(Array::extensible(file, at)?),
            _ => None,
        };
        if self.most.iter().skip(1).any(Option::is_none) {
            return Err(
                file.unsupported("a dataset that grows along another dimension than its first")
            );
        }
        let mut chunks = Vec::new();
        let mut place = low.to_vec();
        loop {
            let number = place.iter().zip(&self.most).try_fold(0_u64, |number, (place, most)| {
                number.checked_mul(most.unwrap_or(1))?.checked_add(*place)
            });
            let number = number.ok_or_else(|| file.damaged("the place of a chunk"))?;
            let offset = place.iter().zip(&self.lengths).map(|(place, length)| place * length);
            let offset = offset.collect();
            let found = match (&array, &self.index) {
                (Some(array), _) => array.entry(file, number, self.bytes)?,
                (None, Index::Implicit(at)) => {
                    let at = at.saturating_add(number.saturating_mul(self.bytes));
                    Some((at, self.bytes, 0))
                }
                _ => None,
            };
            let Some((at, stored, mask)) = found else { return Ok(chunks) };
            chunks.push(Chunk { offset, at, stored, mask });
            if chunks.len() as u64 > file.content.length() {
                return Err(file.damaged("the number of chunks"));
            }
            // The next place of the block, the last dimension first.
            let Some(axis) = (0..place.len()).rev().find(|&axis| place[axis] < high[axis]) else {
                return Ok(chunks);
            };
            place[axis] += 1;
            place[axis + 1..].copy_from_slice(&low[axis + 1..]);
        }
    }
}

/// An array of entries, in blocks that may be divided into pages.
struct Array {
    /// Bytes of an entry; more than an address if chunks are filtered.
    entry: u64,
    /// Most entries in a page.
    page: u64,
    parts: Parts,
}

enum Parts {
    /// The block of a fixed array, and the number of its entries.
    Fixed(u64, u64),
    Extensible(Extensible),
}

/// The blocks of an extensible array (H5EA of the HDF5 library): the first entries are in the index block,
/// others in data blocks that double in size, whose addresses are in the index block or in secondary blocks.
struct Extensible {
    block: u64,
    /// Number of entries in the index block, and in the smallest data block.
    first: u64,
    smallest: u64,
    /// Bytes of the offset in the head of a block.
    offset: u64,
    /// Number of groups of data blocks whose addresses are in the index block, and number of these addresses.
    direct: u64,
    addresses: u64,
}

impl Array {
    fn fixed(file: &mut File, at: u64) -> Result<Self, FileError> {
        let head = file.head(at, 64)?;
        let mut fields = file.fields(&head);
        let parsed = fields.signature(b"FAHD").and_then(|()| {
            fields.take(2)?;
            let (entry, bits) = (fields.byte()?, fields.byte()?);
            let (count, block) = (fields.length()?, fields.address()?);
            (bits < 32).then(|| Self {
                entry: entry.into(),
                page: 1 << bits,
                parts: Parts::Fixed(block.unwrap_or(0), if block.is_some() { count } else { 0 }),
            })
        });
        parsed.ok_or_else(|| file.damaged("an array of chunks"))
    }

    fn extensible(file: &mut File, at: u64) -> Result<Self, FileError> {
        let head = file.head(at, 128)?;
        let mut fields = file.fields(&head);
        let parsed = fields.signature(b"EAHD").and_then(|()| {
            fields.take(2)?;
            let (entry, bits) = (fields.byte()?, fields.byte()?);
            let (first, smallest) = (fields.byte()?, fields.byte()?);
            let (pointers, page) = (fields.byte()?, fields.byte()?);
            for _ in 0..6 {
                fields.length()?;
            }
            let block = fields.address()?.unwrap_or(u64::MAX);
            let is_sound =
                smallest.is_power_of_two() && pointers.is_power_of_two() && bits <= 64 && page < 32;
            is_sound.then(|| Self {
                entry: entry.into(),
                page: 1 << page,
                parts: Parts::Extensible(Extensible {
                    block,
                    first: first.into(),
                    smallest: smallest.into(),
                    offset: u64::from(bits).div_ceil(8),
                    direct: 2 * u64::from(pointers.ilog2()),
                    addresses: 2 * (u64::from(pointers) - 1),
                }),
            })
        });
        parsed.ok_or_else(|| file.damaged("an array of chunks"))
    }

    /// Returns the address, the stored length and the mask of a chunk; `None` if it was not written.
    fn entry(
        &self,
        file: &mut File,
        number: u64,
        bytes: u64,
    ) -> Result<Option<(u64, u64, u32)>, FileError> {
        let address = file.sizes.address as u64;
        let at = match &self.parts {
            Parts::Fixed(_, count) if number >= *count => None,
            Parts::Fixed(block, count) => {
                let pages = count.div_ceil(self.page);
                let bitmap = if *count > self.page { pages.div_ceil(8) } else { 0 };
                let prefix = block.saturating_add(6 + address + bitmap);
                Some(self.within(prefix, number, *count))
            }
            Parts::Extensible(array) => self.extensible_entry(file, array, number)?,
        };
        let Some(at) = at else { return Ok(None) };
        let entry = file.bytes(at, self.entry)?;
        let mut fields = file.fields(&entry);
        let at = fields.address().flatten();
        let size = self.entry.checked_sub(address + 4).filter(|&size| size > 0);
        let filtered =
            size.and_then(|size| Some((fields.number(size as usize)?, fields.number(4)?)));
        let (stored, mask) = filtered.unwrap_or((bytes, 0));
        Ok(at.map(|at| (at, stored, mask as u32)))
    }

    /// Returns the offset of an entry of a block with `count` entries that begin at `at` if it has no pages.
    fn within(&self, at: u64, number: u64, count: u64) -> u64 {
        let entries = number.saturating_mul(self.entry);
        if count <= self.page {
            return at.saturating_add(entries);
        }
        // A checksum ends the head, and each page.
        at.saturating_add(4 + 4 * (number / self.page)).saturating_add(entries)
    }

    fn extensible_entry(
        &self,
        file: &mut File,
        array: &Extensible,
        number: u64,
    ) -> Result<Option<u64>, FileError> {
        if array.block == u64::MAX {
            return Ok(None);
        }
        let address = file.sizes.address as u64;
        let head = 6 + address;
        let index = array.block.saturating_add(head);
        if number < array.first {
            return Ok(Some(index.saturating_add(number.saturating_mul(self.entry))));
        }
        let number = number - array.first;
        let pointers = index.saturating_add(array.first * self.entry);
        let group = u64::from((number / array.smallest).saturating_add(1).ilog2());
        let (blocks, entries) = (1_u64 << (group / 2), array.smallest << group.div_ceil(2));
        let within = number - ((1 << group) - 1) * array.smallest;
        let block = within / entries;
        let pointer = if group < array.direct {
            // Data blocks of all smaller groups come first.
            let before: u64 = (0..group).map(|group| 1 << (group / 2)).sum();
            pointers.saturating_add((before + block) * address)
        } else {
            let pointer = array.addresses + group - array.direct;
            let Some(at) = pointed(file, pointers.saturating_add(pointer * address))? else {
                return Ok(None);
            };
            let pages = if entries > self.page { (entries / self.page).div_ceil(8) } else { 0 };
            let bitmaps = blocks.saturating_mul(pages);
            at.saturating_add(head + array.offset + block * address).saturating_add(bitmaps)
        };
        let Some(at) = pointed(file, pointer)? else { return Ok(None) };
        let at = at.saturating_add(head + array.offset);
        Ok(Some(self.within(at, within % entries, entries)))
    }
}

/// Returns the address at an offset of the file; `None` if it is undefined.
fn pointed(file: &mut File, at: u64) -> Result<Option<u64>, FileError> {
    let bytes = file.bytes(at, file.sizes.address as u64)?;
    Ok(file.fields(&bytes).address().flatten())
}
