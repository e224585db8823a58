//! B-trees of an HDF5 file: those of version 1 under groups and chunks, and those of version 2.

use super::file::File;
use crate::FileError;

/// A chunk: the place of its first value, where its bytes are, their number, and the filters that were left out.
#[derive(Clone, Debug)]
pub(super) struct Chunk {
    pub(super) offset: Vec<u64>,
    pub(super) at: u64,
    pub(super) stored: u64,
    pub(super) mask: u32,
}

/// A node of a tree of version 1.
struct Node {
    level: u8,
    count: usize,
    /// Keys and children in turn, a key last.
    entries: Vec<u8>,
}

fn node(file: &mut File, at: u64, kind: u8, key: usize) -> Result<Node, FileError> {
    let address = file.sizes.address;
    let (level, count) = file.parse(at, 8, "a tree", |fields| {
        fields.signature(b"TREE")?;
        let own = fields.byte()?;
        let (level, count) = (fields.byte()?, fields.number(2)?);
        (own == kind).then_some((level, count as usize))
    })?;
    let at = at.saturating_add((8 + 2 * address) as u64);
    let entries = file.bytes(at, (count * (key + address) + key) as u64)?;
    Ok(Node { level, count, entries })
}

/// Adds the addresses of a group's symbol nodes.
pub(super) fn walk_groups(file: &mut File, at: u64, nodes: &mut Vec<u64>) -> Result<(), FileError> {
    let (key, address) = (file.sizes.length, file.sizes.address);
    let mut pending = vec![(at, None)];
    while let Some((at, above)) = pending.pop() {
        let node = node(file, at, 0, key)?;
        check_level(file, node.level, above)?;
        let mut children = Vec::new();
        for entry in node.entries.chunks_exact(key + address).take(node.count) {
            let child = file.fields(&entry[key..]).address().flatten();
            children.push(child.ok_or_else(|| file.damaged("a group"))?);
        }
        if node.level == 0 {
            nodes.extend(children);
        } else {
            pending.extend(children.into_iter().rev().map(|child| (child, Some(node.level))));
        }
    }
    Ok(())
}

/// Checks that levels decrease from the root.
fn check_level(file: &File, level: u8, above: Option<u8>) -> Result<(), FileError> {
    if above.is_none_or(|above| level < above) { Ok(()) } else { Err(file.damaged("a tree")) }
}

/// Returns the chunks of a tree of version 1 whose first value is in rows `first` to `last` of the first
/// dimension, for a dataset of this rank.
pub(super) fn chunks(
    file: &mut File,
    at: u64,
    rank: usize,
    [first, last]: [u64; 2],
) -> Result<Vec<Chunk>, FileError> {
    let (key, address) = (8 + 8 * (rank + 1), file.sizes.address);
    let mut pending = vec![(at, None)];
    let mut chunks = Vec::new();
    while let Some((at, above)) = pending.pop() {
        let node = node(file, at, 1, key)?;
        check_level(file, node.level, above)?;
        let row = |at: usize| {
            node.entries
                .get(at + 8..at + 16)
                .map_or(0, |bytes| file.fields(bytes).number(8).unwrap_or(0))
        };
        for entry in 0..node.count {
            let begin = entry * (key + address);
            // Keys are sorted, and the first dimension comes first.
            let (low, high) = (row(begin), row(begin + key + address));
            let is_leaf = node.level == 0;
            if low > last || (if is_leaf { low < first } else { high < first }) {
                continue;
            }
            let mut fields = file.fields(&node.entries[begin..]);
            let chunk = fields.number(4).zip(fields.number(4)).and_then(|(stored, mask)| {
                let offset = (0..rank).map(|_| fields.number(8)).collect::<Option<Vec<u64>>>()?;
                fields.number(8)?;
                let at = fields.address()??;
                Some(Chunk { offset, at, stored, mask: mask as u32 })
            });
            let chunk = chunk.ok_or_else(|| file.damaged("a tree of chunks"))?;
            if is_leaf {
                chunks.push(chunk);
            } else {
                pending.push((chunk.at, Some(node.level)));
            }
        }
    }
    Ok(chunks)
}

/// Sizes in the nodes of one level of a tree of version 2.
#[derive(Clone, Copy)]
struct Level {
    most: u64,
    /// Most records under a node of this level.
    total: u64,
}

/// Returns all records of a tree of version 2.
pub(super) fn records(file: &mut File, at: u64) -> Result<Vec<Vec<u8>>, FileError> {
    let address = file.sizes.address;
    let head = (16 + address + 2) as u64;
    let (size, record, depth, root, count) = file.parse(at, head, "a tree", |fields| {
        fields.signature(b"BTHD")?;
        fields.take(2)?;
        let (node, record) = (fields.number(4)?, fields.number(2)?);
        let depth = fields.number(2)?;
        fields.take(2)?;
        let root = fields.address()?;
        let count = fields.number(2)?;
        (record > 0 && depth < 64 && node > 10).then_some((
            node,
            record,
            depth as usize,
            root,
            count,
        ))
    })?;
    let Some(root) = root else { return Ok(Vec::new()) };
    let levels = levels(size, record, depth, address).ok_or_else(|| file.damaged("a tree"))?;
    let bytes = |number: u64| (number.max(1).ilog2() / 8 + 1) as usize;
    let mut pending = vec![(root, count, depth)];
    let mut records = Vec::new();
    while let Some((at, count, level)) = pending.pop() {
        let node = file.bytes(at, size)?;
        let signature = if level == 0 { b"BTLF" } else { b"BTIN" };
        let mut fields = file.fields(&node);
        let head = fields.signature(signature).and_then(|()| fields.take(2));
        head.ok_or_else(|| file.damaged("a tree"))?;
        for _ in 0..count {
            let record = fields.take(record as usize).ok_or_else(|| file.damaged("a tree"))?;
            records.push(record.to_vec());
        }
        if level == 0 {
            continue;
        }
        for _ in 0..=count {
            let child = fields.address().flatten().zip(fields.number(bytes(levels[0].most)));
            let (at, count) = child.ok_or_else(|| file.damaged("a tree"))?;
            fields.take(if level > 1 { bytes(levels[level - 1].total) } else { 0 });
            pending.push((at, count, level - 1));
        }
    }
    Ok(records)
}

fn levels(size: u64, record: u64, depth: usize, address: usize) -> Option<Vec<Level>> {
    let bytes = |number: u64| u64::from(number.max(1).ilog2() / 8 + 1);
    let most = (size - 10) / record;
    let mut levels = vec![Level { most, total: most }];
    for level in 1..=depth {
        let below = levels[level - 1];
        let more = if level > 1 { bytes(below.total) } else { 0 };
        let pointer = address as u64 + bytes(levels[0].most) + more;
        let most = size.checked_sub(10 + pointer)? / (record + pointer);
        let total = most.checked_add(1)?.checked_mul(below.total)?.checked_add(most)?;
        levels.push(Level { most, total });
    }
    Some(levels)
}
