//! Thread pools.

use super::Failure;
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

/// Creates a pool of `count` threads, one of which is this thread: so that little memory changes hands
/// between threads, and a single thread starts no other. A thread can be in one pool only.
pub(super) fn pool_with_this_thread(count: usize) -> Result<ThreadPool, Failure> {
    let builder = ThreadPoolBuilder::new().num_threads(count).use_current_thread();
    builder.build().map_err(|error| Failure::Threads(count, error))
}
