//! Structures of an HDF5 file (version 3 of its specification): superblock, object headers, groups, and heaps.
//!
//! Every structure is read as a range that is checked to be within the file, and all structures together
//! take no more bytes than a multiple of the file: loops of references end there.

use super::tree;
use crate::{FileError, binary::BinaryFile};
use std::collections::VecDeque;

/// Beginning of a file.
pub(crate) const MAGIC: &[u8] = b"\x89HDF\r\n\x1A\n";

/// Bytes of structures that may be read per byte of the file, and in any file.
const STRUCTURES: (u64, u64) = (4, 1 << 16);

/// The most soft links that are followed one after another.
const MOST_SOFT_LINKS: usize = 16;

/// Kinds of link messages.
const HARD: u8 = 0;
const SOFT: u8 = 1;

/// The kind of an entry of a symbol table that is a soft link.
const SOFT_ENTRY: u64 = 2;

/// Longest name of a link in bytes.
const LONGEST_NAME: u64 = 1 << 12;

/// An open file.
pub(crate) struct File {
    pub(super) content: BinaryFile,
    pub(super) sizes: Sizes,
    base: u64,
    /// Address of the root group's object header.
    pub(super) root: u64,
    /// Number of bytes of structures that may still be read.
    left: u64,
}

/// Sizes of addresses and of lengths in bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sizes {
    pub(super) address: usize,
    pub(super) length: usize,
}

/// What a link leads to.
enum Target {
    /// The address of an object.
    Object(u64),
    /// A path from the group of the link, or from the root if it begins with a slash.
    Path(String),
}

/// Reader of the fields of a structure, one after another; all are little-endian.
#[derive(Clone)]
pub(super) struct Fields<'b> {
    pub(super) rest: &'b [u8],
    pub(super) sizes: Sizes,
}

/// A message of an object header.
pub(super) struct Message {
    pub(super) kind: u16,
    pub(super) data: Vec<u8>,
}

/// Kinds of messages.
pub(super) const DATASPACE: u16 = 0x01;
const LINK_INFO: u16 = 0x02;
pub(super) const DATATYPE: u16 = 0x03;
const LINK: u16 = 0x06;
pub(super) const LAYOUT: u16 = 0x08;
pub(super) const FILTERS: u16 = 0x0B;
pub(super) const ATTRIBUTE: u16 = 0x0C;
const CONTINUATION: u16 = 0x10;
const SYMBOL_TABLE: u16 = 0x11;

/// Blocks of a header that remain to be read.
struct Block {
    at: u64,
    length: u64,
    /// True in headers of version 2.
    is_new: bool,
    /// True if messages have a creation order.
    is_ordered: bool,
}

impl<'b> Fields<'b> {
    pub(super) fn take(&mut self, length: usize) -> Option<&'b [u8]> {
        let (bytes, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(bytes)
    }

    /// Returns the next number of `size` bytes; none of more than eight.
    pub(super) fn number(&mut self, size: usize) -> Option<u64> {
        let bytes = self.take(size)?;
        let mut word = [0; 8];
        word.get_mut(..size)?.copy_from_slice(bytes);
        Some(u64::from_le_bytes(word))
    }

    pub(super) fn byte(&mut self) -> Option<u8> {
        self.number(1).map(|byte| byte as u8)
    }

    pub(super) fn length(&mut self) -> Option<u64> {
        self.number(self.sizes.length)
    }

    /// Returns the next address, and `Some(None)` if it is undefined.
    #[expect(clippy::option_option, reason = "a structure may end before it")]
    pub(super) fn address(&mut self) -> Option<Option<u64>> {
        let size = self.sizes.address;
        let address = self.number(size)?;
        let undefined = if size == 8 { u64::MAX } else { (1 << (8 * size)) - 1 };
        Some((address != undefined).then_some(address))
    }

    /// Skips a signature.
    pub(super) fn signature(&mut self, signature: &[u8]) -> Option<()> {
        (self.take(signature.len())? == signature).then_some(())
    }
}

impl File {
    pub(super) fn open(content: BinaryFile) -> Result<Self, FileError> {
        let sizes = Sizes { address: 8, length: 8 };
        let mut opened = Self { content, sizes, base: 0, root: 0, left: 0 };
        opened.start();
        let head = opened.bytes(0, opened.content.length().min(128))?;
        let superblock = superblock(&head).ok_or_else(|| opened.damaged("its superblock"))?;
        (opened.sizes, opened.base, opened.root) =
            (superblock.sizes, superblock.base, superblock.root);
        opened.content.check_range(0, superblock.end)?;
        Ok(opened)
    }

    /// Begins an operation, which may read as many bytes of structures as a file can need.
    pub(super) fn start(&mut self) {
        let (per_byte, any) = STRUCTURES;
        self.left = self.content.length().saturating_mul(per_byte).saturating_add(any);
    }

    /// Returns an error about a structure.
    pub(super) fn damaged(&self, what: &str) -> FileError {
        let error = self.content.fault(format!("is damaged: {what} cannot be read"));
        error.with_help("copy the file again; h5dump -H FILE checks it")
    }

    /// Returns an error about something that is valid but not supported.
    pub(super) fn unsupported(&self, what: &str) -> FileError {
        let error = self.content.fault(format!("has {what}, which is not supported"));
        error.with_help("rewrite it: h5repack -f GZIP=4 FILE NEW")
    }

    pub(super) fn fields<'b>(&self, bytes: &'b [u8]) -> Fields<'b> {
        Fields { rest: bytes, sizes: self.sizes }
    }

    /// Reads values at an address.
    pub(super) fn values(&mut self, at: u64, length: u64) -> Result<Vec<u8>, FileError> {
        let at = self.base.checked_add(at).ok_or_else(|| self.damaged("an address"))?;
        self.content.bytes(at, length)
    }

    /// Reads a structure at an address.
    pub(super) fn bytes(&mut self, at: u64, length: u64) -> Result<Vec<u8>, FileError> {
        self.left = self
            .left
            .checked_sub(length.max(8))
            .ok_or_else(|| self.damaged("a structure that refers to itself"))?;
        self.values(at, length)
    }

    /// Reads a structure at an address, and returns what `parse` makes of its fields; an error about `what` if it is not sound.
    pub(super) fn parse<T>(
        &mut self,
        at: u64,
        length: u64,
        what: &str,
        parse: impl FnOnce(&mut Fields) -> Option<T>,
    ) -> Result<T, FileError> {
        let bytes = self.bytes(at, length)?;
        parse(&mut self.fields(&bytes)).ok_or_else(|| self.damaged(what))
    }

    /// Reads up to this many bytes of a structure whose length its beginning tells.
    pub(super) fn head(&mut self, at: u64, length: u64) -> Result<Vec<u8>, FileError> {
        let end = self.content.length().saturating_sub(self.base);
        self.bytes(at, end.saturating_sub(at).min(length))
    }

    /// Returns the messages of an object's header.
    pub(super) fn messages(&mut self, at: u64) -> Result<Vec<Message>, FileError> {
        let head = self.head(at, 40)?;
        let first = self.first_block(at, &head).ok_or_else(|| self.damaged("an object header"))?;
        let mut blocks = VecDeque::from([first]);
        let mut messages = Vec::new();
        while let Some(block) = blocks.pop_front() {
            let bytes = self.bytes(block.at, block.length)?;
            let mut fields = self.fields(&bytes);
            while let Some((kind, flags, data)) = next_message(&mut fields, &block) {
                if kind == CONTINUATION {
                    let mut fields = self.fields(data);
                    let place = fields.address().flatten().zip(fields.length());
                    let (at, length) = place.ok_or_else(|| self.damaged("an object header"))?;
                    let next = continuation(at, length, &block);
                    blocks.push_back(next.ok_or_else(|| self.damaged("an object header"))?);
                    continue;
                }
                let is_shared = flags & 2 != 0;
                let data = if is_shared { self.shared(kind, data)? } else { Some(data.to_vec()) };
                messages.extend(data.map(|data| Message { kind, data }));
            }
        }
        Ok(messages)
    }

    /// Returns a message that another object has: a named datatype.
    fn shared(&mut self, kind: u16, data: &[u8]) -> Result<Option<Vec<u8>>, FileError> {
        let mut fields = self.fields(data);
        let is_old = fields.byte() == Some(1);
        fields.take(if is_old { 7 } else { 1 });
        let Some(at) = fields.address().flatten().filter(|_| kind == DATATYPE) else {
            return Ok(None);
        };
        let found = self.messages(at)?.into_iter().find(|message| message.kind == kind);
        Ok(found.map(|message| message.data))
    }

    fn first_block(&self, at: u64, head: &[u8]) -> Option<Block> {
        let mut fields = self.fields(head);
        if !head.starts_with(b"OHDR") {
            let version = fields.byte()?;
            fields.take(7)?;
            let length = fields.number(4)?;
            let at = at.checked_add(16)?;
            let block = Block { at, length, is_new: false, is_ordered: false };
            return (version == 1).then_some(block);
        }
        fields.take(4)?;
        let version = fields.byte()?;
        let flags = fields.byte()?;
        fields.take(if flags & 0x20 != 0 { 16 } else { 0 })?;
        fields.take(if flags & 0x10 != 0 { 4 } else { 0 })?;
        let length = fields.number(1 << (flags & 3))?;
        let at = at.checked_add((head.len() - fields.rest.len()) as u64)?;
        let block = Block { at, length, is_new: true, is_ordered: flags & 4 != 0 };
        (version == 2).then_some(block)
    }

    /// Returns the links of a group to objects of this file, in the order of the file, with the objects that soft links
    /// lead to; none for a dataset. Soft links that lead nowhere are left out.
    ///
    /// # Errors
    /// The file is damaged, or soft links lead to each other.
    pub(super) fn links(&mut self, group: u64) -> Result<Vec<(String, u64)>, FileError> {
        let mut found = Vec::new();
        for (name, target) in self.targets(group)? {
            if let Some(object) = self.follow(group, target, 0)? {
                found.push((name, object));
            }
        }
        Ok(found)
    }

    /// Returns the object that a link of a group leads to, after some other soft links.
    fn follow(
        &mut self,
        group: u64,
        target: Target,
        followed: usize,
    ) -> Result<Option<u64>, FileError> {
        let path = match target {
            Target::Object(object) => return Ok(Some(object)),
            Target::Path(path) => path,
        };
        if followed == MOST_SOFT_LINKS {
            let message =
                format!("has more than {MOST_SOFT_LINKS} soft links in a row, at `{path}`");
            return Err(self.content.fault(message));
        }
        let mut at = if path.starts_with('/') { self.root } else { group };
        for name in path.split('/').filter(|name| !matches!(*name, "" | ".")) {
            let targets = self.targets(at)?.into_iter();
            let Some((_, target)) = targets.into_iter().find(|(own, _)| own == name) else {
                return Ok(None);
            };
            let Some(object) = self.follow(at, target, followed + 1)? else { return Ok(None) };
            at = object;
        }
        Ok(Some(at))
    }

    /// Returns the links of a group as they are, in the order of the file.
    fn targets(&mut self, group: u64) -> Result<Vec<(String, Target)>, FileError> {
        let mut links = Vec::new();
        for message in self.messages(group)? {
            let mut fields = self.fields(&message.data);
            match message.kind {
                SYMBOL_TABLE => {
                    let tree = fields.address().flatten().zip(fields.address().flatten());
                    let (tree, heap) = tree.ok_or_else(|| self.damaged("a group"))?;
                    self.add_symbols(tree, heap, &mut links)?;
                }
                LINK => links.extend(link(fields)),
                LINK_INFO => {
                    let flags = fields.take(2).map_or(0, |bytes| bytes[1]);
                    fields.take(if flags & 1 != 0 { 8 } else { 0 });
                    let heap = fields.address().flatten().zip(fields.address().flatten());
                    let Some((heap, names)) = heap else { continue };
                    for record in tree::records(self, names)? {
                        let id = record.get(4..).unwrap_or_default();
                        let object = self.heap_object(heap, id)?;
                        links.extend(link(self.fields(&object)));
                    }
                }
                _ => (),
            }
        }
        Ok(links)
    }

    /// Adds the links of a symbol table, whose names are in a local heap.
    fn add_symbols(
        &mut self,
        tree: u64,
        heap: u64,
        links: &mut Vec<(String, Target)>,
    ) -> Result<(), FileError> {
        let (address, length) = (self.sizes.address, self.sizes.length);
        let head = (8 + 2 * length + address) as u64;
        let (at, size) = self.parse(heap, head, "the names of a group", |fields| {
            fields.signature(b"HEAP")?;
            fields.take(4)?;
            let size = fields.length()?;
            fields.length()?;
            Some((fields.address()??, size))
        })?;
        let names = self.bytes(at, size)?;
        let mut nodes = Vec::new();
        tree::walk_groups(self, tree, &mut nodes)?;
        for node in nodes {
            let count = self.parse(node, 8, "a group", |fields| {
                fields.signature(b"SNOD")?;
                fields.take(2)?;
                fields.number(2)
            })?;
            let entry = 2 * address + 24;
            let entries = self.bytes(node.saturating_add(8), count * entry as u64)?;
            for entry in entries.chunks_exact(entry) {
                let mut fields = self.fields(entry);
                let (name, object) = (fields.number(address), fields.address().flatten());
                let (kind, _) = (fields.number(4), fields.take(4));
                let text = |at: u64| {
                    let bytes = names.get(usize::try_from(at).ok()?..)?.split(|&byte| byte == 0);
                    bytes.into_iter().next().map(lossy)
                };
                let target = match kind {
                    Some(SOFT_ENTRY) => fields.number(4).and_then(text).map(Target::Path),
                    _ => object.map(Target::Object),
                };
                links.extend(name.and_then(text).zip(target));
            }
        }
        Ok(())
    }

    /// Returns an object of a fractal heap.
    fn heap_object(&mut self, heap: u64, id: &[u8]) -> Result<Vec<u8>, FileError> {
        const HEAP: &str = "a heap of links";
        let head = self.head(heap, 256)?;
        let heap = Heap::parse(self.fields(&head)).ok_or_else(|| self.damaged(HEAP))?;
        let (&kind, rest) = id.split_first().ok_or_else(|| self.damaged(HEAP))?;
        if kind & 0x30 == 0x20 {
            // A tiny object is its own identifier.
            return Ok(rest.get(..usize::from(kind & 0xF) + 1).unwrap_or(rest).to_vec());
        }
        if kind & 0x30 != 0 || heap.is_filtered {
            return Err(self.unsupported("links in a compressed heap"));
        }
        let mut fields = self.fields(rest);
        let place = fields.number(heap.offset_size).zip(fields.number(heap.length_size));
        let place = place.filter(|&(_, length)| length <= LONGEST_NAME);
        let (mut offset, length) = place.ok_or_else(|| self.damaged(HEAP))?;
        let (mut block, mut rows) = (heap.root, heap.rows);
        let address = self.sizes.address;
        while rows > 0 {
            let place = heap.place(offset).filter(|&(row, ..)| row < rows);
            let (row, column, within) = place.ok_or_else(|| self.damaged(HEAP))?;
            let entry = row.saturating_mul(heap.width).saturating_add(column);
            let at = block.saturating_add((5 + address + heap.offset_size) as u64);
            let at = at.saturating_add(entry.saturating_mul(address as u64));
            let child = self.bytes(at, address as u64)?;
            let child = self.fields(&child).address().flatten();
            block = child.ok_or_else(|| self.damaged(HEAP))?;
            (offset, rows) = (within, heap.child_rows(row));
        }
        self.bytes(block.saturating_add(offset), length)
    }

    /// Returns a text of variable length by its reference: a length, the address of a global heap, and an index.
    pub(super) fn heap_text(&mut self, reference: &[u8]) -> Result<String, FileError> {
        let mut fields = self.fields(reference);
        let parts = fields.number(4).zip(fields.address()).zip(fields.number(4));
        let Some(((length, Some(heap)), index)) = parts else { return Ok(String::new()) };
        if length == 0 {
            return Ok(String::new());
        }
        let size = self.sizes.length;
        let held = self.parse(heap, 8 + size as u64, "a text", |fields| {
            fields.signature(b"GCOL")?;
            fields.take(4)?;
            fields.length()
        })?;
        let collection = self.bytes(heap, held)?;
        let mut fields = self.fields(collection.get(8 + size..).unwrap_or_default());
        while let Some(own) = fields.number(2).filter(|&own| own > 0) {
            let bytes = fields.take(6).and_then(|_| {
                let bytes = fields.length().and_then(|length| usize::try_from(length).ok());
                let bytes = fields.take(bytes?)?;
                fields.take(bytes.len().wrapping_neg() % 8);
                Some(bytes)
            });
            let Some(bytes) = bytes else { break };
            if own == index {
                let text = bytes.get(..length as usize).unwrap_or(bytes);
                return Ok(String::from_utf8_lossy(text).trim_end_matches('\0').to_owned());
            }
        }
        Err(self.damaged("a text"))
    }
}

/// A fractal heap, in which a group with many links keeps them.
struct Heap {
    offset_size: usize,
    length_size: usize,
    is_filtered: bool,
    /// Number of blocks per row, and the sizes of the smallest and the largest direct block.
    width: u64,
    smallest: u64,
    largest: u64,
    /// Address of the root block, and its rows; 0 rows are a direct block.
    root: u64,
    rows: u64,
}

impl Heap {
    fn parse(mut fields: Fields) -> Option<Self> {
        fields.signature(b"FRHP")?;
        fields.take(3)?;
        let filter = fields.number(2)?;
        fields.take(1)?;
        let largest_object = fields.number(4)?;
        fields.length()?;
        fields.address()?;
        fields.length()?;
        fields.address()?;
        for _ in 0..8 {
            fields.length()?;
        }
        let width = fields.number(2)?;
        let (smallest, largest) = (fields.length()?, fields.length()?);
        let bits = fields.number(2)?;
        fields.take(2)?;
        let (root, rows) = (fields.address()??, fields.number(2)?);
        let is_sound = width.is_power_of_two()
            && smallest.is_power_of_two()
            && largest.is_power_of_two()
            && smallest <= largest
            && bits <= 64;
        let bytes = |number: u64| (number.max(1).ilog2() / 8 + 1) as usize;
        let heap = Self {
            offset_size: bits.div_ceil(8) as usize,
            length_size: bytes(largest).min(bytes(largest_object)),
            is_filtered: filter > 0,
            width,
            smallest,
            largest,
            root,
            rows,
        };
        is_sound.then_some(heap)
    }

    /// Returns the size of a block in a row: rows 0 and 1 are equal, and then each is twice the one before.
    fn block(&self, row: u64) -> Option<u64> {
        self.smallest.checked_mul(1_u64.checked_shl(row.saturating_sub(1) as u32)?)
    }

    /// Returns the row and the column of the block that has an offset, and the offset within it.
    fn place(&self, offset: u64) -> Option<(u64, u64, u64)> {
        let mut begin = 0_u64;
        for row in 0..64 {
            let block = self.block(row)?;
            let end = begin.checked_add(block.checked_mul(self.width)?)?;
            if offset < end {
                let within = offset - begin;
                return Some((row, within / block, within % block));
            }
            begin = end;
        }
        None
    }

    /// Returns the number of rows of a block in a row; 0 for a direct block.
    fn child_rows(&self, row: u64) -> u64 {
        match self.block(row) {
            Some(block) if block > self.largest => {
                u64::from((block / self.smallest / self.width).max(1).ilog2()) + 1
            }
            _ => 0,
        }
    }
}

/// The beginning of a file.
struct Superblock {
    sizes: Sizes,
    base: u64,
    /// Address of the end of the file.
    end: u64,
    root: u64,
}

/// Parses the beginning of a file.
fn superblock(head: &[u8]) -> Option<Superblock> {
    let mut fields = Fields { rest: head, sizes: Sizes { address: 8, length: 8 } };
    fields.signature(MAGIC)?;
    let version = fields.byte()?;
    let is_old = version < 2;
    fields.take(if is_old { 4 } else { 0 })?;
    let sizes = Sizes { address: fields.byte()?.into(), length: fields.byte()?.into() };
    fields.sizes = sizes;
    let fits = |size: usize| matches!(size, 2 | 4 | 8);
    if version > 3 || !fits(sizes.address) || !fits(sizes.length) {
        return None;
    }
    if !is_old {
        fields.take(1)?;
        let base = fields.address()??;
        fields.address()?;
        return Some(Superblock { sizes, base, end: fields.address()??, root: fields.address()?? });
    }
    fields.take(if version == 1 { 13 } else { 9 })?;
    let base = fields.address()??;
    fields.address()?;
    let end = fields.address()??;
    // The address of a driver's data, and the offset of the root's name.
    fields.take(2 * sizes.address)?;
    Some(Superblock { sizes, base, end, root: fields.address()?? })
}

/// Returns the next message of a block: its kind, flags and data.
fn next_message<'b>(fields: &mut Fields<'b>, block: &Block) -> Option<(u16, u8, &'b [u8])> {
    let kind = fields.number(if block.is_new { 1 } else { 2 })? as u16;
    let size = fields.number(2)? as usize;
    let flags = fields.byte()?;
    let more = match (block.is_new, block.is_ordered) {
        (false, _) => 3,
        (true, true) => 2,
        (true, false) => 0,
    };
    fields.take(more)?;
    Some((kind, flags, fields.take(size)?))
}

/// Returns the block at an address that continues the header of another.
fn continuation(at: u64, length: u64, block: &Block) -> Option<Block> {
    let Block { is_new, is_ordered, .. } = *block;
    // A signature before the messages, and a checksum after them.
    let (before, after) = if is_new { (4, 4) } else { (0, 0) };
    let length = length.checked_sub(before + after)?;
    Some(Block { at: at.checked_add(before)?, length, is_new, is_ordered })
}

/// Returns the name and the target of a link message; `None` for a link to another file.
fn link(mut fields: Fields) -> Option<(String, Target)> {
    fields.byte().filter(|&version| version == 1)?;
    let flags = fields.byte()?;
    let kind = if flags & 8 != 0 { fields.byte()? } else { HARD };
    fields.take(if flags & 4 != 0 { 8 } else { 0 })?;
    fields.take(usize::from(flags & 0x10 != 0))?;
    let length = fields.number(1 << (flags & 3))?;
    let name = fields.take(usize::try_from(length).ok()?)?;
    let target = match kind {
        HARD => Target::Object(fields.address()??),
        SOFT => {
            let length = fields.number(2)?;
            Target::Path(lossy(fields.take(usize::try_from(length).ok()?)?))
        }
        _ => return None,
    };
    Some((lossy(name), target))
}

fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
