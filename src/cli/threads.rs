//! Thread pools.

use super::failure::Failure;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::thread::available_parallelism;

/// Number of threads: that of `--threads`, or else as the CPU affinity mask and the cgroup's quota allow; 1
/// if unknown.
pub(super) fn count(typed: Option<u16>) -> usize {
    let default = || available_parallelism().map_or(1, usize::from);
    typed.map_or_else(default, usize::from)
}

/// Creates a pool of `count` threads.
pub(super) fn pool(count: usize) -> Result<ThreadPool, Failure> {
    let builder = ThreadPoolBuilder::new().num_threads(count);
    builder.build().map_err(|error| Failure::Threads(count, error))
}
