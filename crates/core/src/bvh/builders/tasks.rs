//! The division of the construction into tasks.

use rayon::prelude::*;

/// Below this many spheres a subtree is built by one task: splitting costs more than it saves.
pub(super) const PARALLEL: usize = 4096;

/// Returns what a function gives for each number below `count`. All threads write the memory, for the system to give
/// it to all at once.
pub(crate) fn collected<T: Send>(count: usize, each: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    (0..count).into_par_iter().with_min_len(PARALLEL).map(each).collect()
}

/// Gives memory back while other threads go on: it takes the system as long as some levels of a large
/// tree, and one thread at a time.
pub(super) fn freeing<T: Send, R: Send>(memory: Vec<T>, meanwhile: impl FnOnce() -> R + Send) -> R {
    if memory.len() < PARALLEL {
        return meanwhile();
    }
    rayon::join(|| drop(memory), meanwhile).1
}
