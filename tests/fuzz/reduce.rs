//! Reduction of inputs that fail (after Zeller, Hildebrandt, "Simplifying and Isolating Failure-Inducing
//! Input", IEEE Transactions on Software Engineering 2002).

use std::time::{Duration, Instant};

/// Time limit of the reduction, since cases that hang take long.
const TIME: Duration = Duration::from_secs(20);

/// Removes parts of the input, of repeatedly halved lengths, as long as it fails in the same way.
pub(crate) fn reduce(bytes: &[u8], mut fails: impl FnMut(&[u8]) -> bool) -> Vec<u8> {
    let start = Instant::now();
    let mut bytes = bytes.to_vec();
    let mut length = bytes.len().div_ceil(2);
    while length > 0 {
        let before = bytes.len();
        let mut at = 0;
        while at < bytes.len() && start.elapsed() < TIME {
            let end = bytes.len().min(at + length);
            let fewer = [&bytes[..at], &bytes[end..]].concat();
            if fails(&fewer) {
                bytes = fewer;
            } else {
                at = end;
            }
        }
        if length == 1 && (bytes.len() == before || start.elapsed() >= TIME) {
            break;
        }
        length = length.div_ceil(2).min(bytes.len());
    }
    bytes
}

#[test]
fn inputs_are_reduced_to_the_needed_bytes() {
    let ones = |bytes: &[u8]| bytes.split(|&byte| byte == 1).count() - 1;
    let needs = |bytes: &[u8]| bytes.contains(&7) && ones(bytes) > 1;
    let input: Vec<u8> = (0..100).chain(0..50).collect();
    assert_eq!(reduce(&input, needs), [1, 7, 1]);
    assert!(reduce(&[], |_| true).is_empty());
}
