//! The threads that do the work.

use super::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::thread::available_parallelism;

/// What was typed, or else what the affinity mask and the control group's quota allow; 1 where the
/// system does not tell.
pub(super) fn count(typed: Option<u16>) -> usize {
    let usual = || available_parallelism().map_or(1, usize::from);
    typed.map_or_else(usual, usize::from)
}

/// So many threads.
pub(super) fn pool(count: usize) -> Result<ThreadPool, Failure> {
    let builder = ThreadPoolBuilder::new().num_threads(count);
    builder.build().map_err(|error| Failure::Threads(count, error))
}
