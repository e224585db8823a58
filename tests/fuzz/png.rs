//! PNG files with damaged content.

/// Corrects the checksum of every chunk, so that damage is not detected by it.
pub(crate) fn seal(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = length.iter().fold(0, |sum, &byte| sum << 8 | usize::from(byte));
        let Some(end) = at.checked_add(length + 8).filter(|end| end + 4 <= bytes.len()) else {
            return;
        };
        let sum = checksum(&bytes[at + 4..end]);
        bytes[end..end + 4].copy_from_slice(&sum.to_be_bytes());
        at = end + 4;
    }
}

/// CRC-32 as in PNG (ISO 3309).
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, &byte| {
        (0..8)
            .fold(sum ^ u32::from(byte), |sum, _| sum >> 1 ^ 0xEDB8_8320 & (sum & 1).wrapping_neg())
    })
}
