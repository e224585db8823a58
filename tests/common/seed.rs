//! Seeds of randomized tests.

use std::env;
use std::time::{SystemTime, UNIX_EPOCH};

/// Returns the number in an environment variable, if it is set.
pub(crate) fn number(name: &str) -> Option<u64> {
    let text = env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name} is `{text}`, which is not a whole number")))
}

/// Returns the seed in an environment variable, or else the time. It is printed, so that a failed run can be
/// repeated.
#[expect(clippy::print_stderr, reason = "the seed is of use only where it is seen")]
pub(crate) fn seed(name: &str) -> u64 {
    let time = || {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).expect("a time after 1970");
        since.as_nanos() as u64
    };
    let seed = number(name).unwrap_or_else(time);
    eprintln!("{name}={seed}");
    seed
}
