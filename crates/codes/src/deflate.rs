//! Compression by all threads to a zlib stream (RFC 1950), as in `pigz`.
//!
//! Data are compressed in parts, each with the end of the part before as its dictionary, so that the
//! stream is hardly larger than that of one thread, and independent of the number of threads.

use flate2::{Compress, CompressError, Compression, FlushCompress, Status};
use rayon::prelude::*;

/// Bytes of a part.
const PART: usize = 1 << 17;

/// Maximum distance of a match, and so the bytes of a dictionary.
const WINDOW: usize = 1 << 15;

/// A window of 32 KiB, and the default level.
const HEADER: [u8; 2] = [0x78, 0x9c];

/// Compresses data to a zlib stream.
pub(crate) fn compress(data: &[u8]) -> Result<Vec<u8>, CompressError> {
    let count = data.len().div_ceil(PART).max(1);
    let parts = (0..count).into_par_iter().map(|part| {
        let (start, end) = (part * PART, data.len().min((part + 1) * PART));
        let flush = if part + 1 < count { FlushCompress::Sync } else { FlushCompress::Finish };
        let dictionary = &data[start.saturating_sub(WINDOW)..start];
        Ok((compress_part(dictionary, &data[start..end], flush)?, Adler::of(&data[start..end])))
    });
    let parts: Vec<_> = parts.collect::<Result<_, CompressError>>()?;
    let mut stream = HEADER.to_vec();
    let mut sum = Adler::default();
    for (part, of_part) in parts {
        stream.extend(part);
        sum = sum.followed_by(&of_part);
    }
    stream.extend(sum.value().to_be_bytes());
    Ok(stream)
}

/// Compresses data to blocks that end at a byte, the last if `flush` is to finish.
fn compress_part(
    dictionary: &[u8],
    data: &[u8],
    flush: FlushCompress,
) -> Result<Vec<u8>, CompressError> {
    let mut compress = Compress::new(Compression::default(), false);
    if !dictionary.is_empty() {
        compress.set_dictionary(dictionary)?;
    }
    let mut blocks = Vec::with_capacity(data.len() + data.len() / 8 + 64);
    let before = compress.total_in();
    loop {
        let rest = &data[(compress.total_in() - before) as usize..];
        let status = compress.compress_vec(rest, &mut blocks, flush)?;
        // Room that is left shows that everything has been written.
        if status == Status::StreamEnd || blocks.len() < blocks.capacity() {
            return Ok(blocks);
        }
        blocks.reserve(PART);
    }
}

/// The checksum Adler-32 of some bytes.
struct Adler {
    length: u64,
    /// The sum of the bytes and 1.
    low: u64,
    /// The sum of `low` after each byte.
    high: u64,
}

/// Returns the checksum of no bytes.
impl Default for Adler {
    fn default() -> Self {
        Self { length: 0, low: 1, high: 0 }
    }
}

impl Adler {
    const MODULUS: u64 = 65_521;

    fn of(bytes: &[u8]) -> Self {
        // So few that their sums fit into 32 bits.
        let chunks = bytes.chunks(1 << 10).map(|chunk| {
            let (mut low, mut high) = (0, 0);
            for (left, &byte) in (1..=chunk.len() as u32).rev().zip(chunk) {
                low += u32::from(byte);
                high += left * u32::from(byte);
            }
            let length = chunk.len() as u64;
            Self { length, low: 1 + u64::from(low), high: length + u64::from(high) }
        });
        chunks.fold(Self::default(), |sum, chunk| sum.followed_by(&chunk))
    }

    /// Returns the checksum of these bytes and then others.
    fn followed_by(&self, other: &Self) -> Self {
        let (length, before) = (other.length % Self::MODULUS, self.low + Self::MODULUS - 1);
        Self {
            length: self.length + other.length,
            low: (before + other.low) % Self::MODULUS,
            high: (self.high + length * before + other.high) % Self::MODULUS,
        }
    }

    fn value(&self) -> u32 {
        (self.high << 16 | self.low) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::Read;

    #[test]
    fn streams_are_decompressed_whatever_their_length() {
        let mut random = 1_u32;
        let mut noise = |bits: u32| {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (random >> (32 - bits)) as u8
        };
        for length in [0, 1, 5, PART - 1, PART, PART + 1, 3 * PART + 77] {
            for bits in [1, 4, 8] {
                let data: Vec<u8> = (0..length).map(|_| noise(bits)).collect();
                let stream = compress(&data).unwrap();
                let mut back = Vec::new();
                // The decoder checks the sum.
                ZlibDecoder::new(&stream[..]).read_to_end(&mut back).unwrap();
                assert!(back == data, "{length} {bits}");
                assert!(stream.len() < data.len() * bits as usize / 8 * 5 / 4 + 100);
            }
        }
    }

    #[test]
    fn repetitions_are_found_across_parts() {
        let stream = compress(&vec![7; 4 * PART]).unwrap();
        assert!(stream.len() < 4 * PART / 500, "{}", stream.len());
    }

    #[test]
    fn known_checksums() {
        assert_eq!(Adler::of(b"").value(), 1);
        assert_eq!(Adler::of(b"Wikipedia").value(), 0x11e6_0398);
        let bytes = vec![255; 100_000];
        let ones = Adler::of(&bytes);
        let [a, b] = [Adler::of(&bytes[..70_000]), Adler::of(&bytes[70_000..])];
        assert_eq!(a.followed_by(&b).value(), ones.value());
    }
}
