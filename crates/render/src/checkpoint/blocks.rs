//! Compressed blocks of tile sums.
//!
//! Sums of single-precision numbers have many trailing zeros, and similar exponents: bytes of equal
//! significance are stored together, so that LZ4 compresses them well.

use crate::film::Tile;
use std::array;

/// Number of tiles in a block.
pub(super) const TILES: usize = 64;

/// Bytes of a number.
const WIDTH: usize = size_of::<f64>();

/// Maximum compression ratio of LZ4.
pub(super) const MAX_RATIO: u64 = 255;

/// Compresses tiles; returns the length of a block, followed by the block.
pub(super) fn pack(tiles: &[Tile]) -> Vec<u8> {
    let numbers: Vec<f64> = tiles.iter().flat_map(Tile::columns).flatten().copied().collect();
    let mut bytes = vec![0; numbers.len() * WIDTH];
    let mut planes = bytes.chunks_mut(numbers.len().max(1));
    let mut planes: [&mut [u8]; WIDTH] = array::from_fn(|_| planes.next().unwrap_or_default());
    for (at, number) in numbers.iter().enumerate() {
        for (plane, byte) in planes.iter_mut().zip(number.to_le_bytes()) {
            plane[at] = byte;
        }
    }
    let most = lz4_flex::block::get_maximum_output_size(bytes.len());
    let mut block = vec![0; size_of::<u32>() + most];
    let (length, packed) = block.split_at_mut(size_of::<u32>());
    // The buffer has the maximum compressed size.
    let used = lz4_flex::block::compress_into(&bytes, packed).unwrap_or_default();
    length.copy_from_slice(&(used as u32).to_le_bytes());
    block.truncate(size_of::<u32>() + used);
    block
}

/// Fills tiles from a block without its length; `None` if the block does not match them.
pub(super) fn unpack(block: &[u8], tiles: &mut [Tile]) -> Option<()> {
    let count: usize = tiles.iter().flat_map(Tile::columns).map(<[f64]>::len).sum();
    let mut bytes = vec![0; count * WIDTH];
    let used = lz4_flex::block::decompress_into(block, &mut bytes).ok()?;
    if used != bytes.len() {
        return None;
    }
    let mut at = 0..;
    for number in tiles.iter_mut().flat_map(Tile::columns_mut).flatten() {
        let at = at.next()?;
        *number = f64::from_le_bytes(array::from_fn(|plane| bytes[plane * count + at]));
        if !number.is_finite() {
            return None;
        }
    }
    Some(())
}
