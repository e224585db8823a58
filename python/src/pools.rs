//! Pools of threads, one for each number of threads.
//!
//! A process that was forked has no threads but one: it gets pools of its own.

use crate::errors::error;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::available_parallelism;

type Pools = HashMap<usize, Arc<ThreadPool>>;

/// The process that the pools belong to, and the pools.
///
/// The lock is held only with that of Python, so that no other thread has it when the process is forked.
static POOLS: Mutex<Option<(u32, Pools)>> = Mutex::new(None);

/// Returns the pool with this number of threads; by default as many as the process may use.
pub(crate) fn pool(py: Python<'_>, threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let count = threads.unwrap_or_else(|| available_parallelism().map_or(1, usize::from));
    let process = std::process::id();
    let mut state = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    if state.as_ref().is_some_and(|(owner, _)| *owner != process) {
        // Its threads are not in this process, and must not be waited for.
        std::mem::forget(state.take());
    }
    let (_, pools) = state.get_or_insert_with(|| (process, Pools::new()));
    if let Some(pool) = pools.get(&count) {
        return Ok(Arc::clone(pool));
    }
    let built = ThreadPoolBuilder::new().num_threads(count).build();
    let pool = built.map_err(|reason| {
        error(py, &format!("cannot start {count} threads: {reason}; use fewer `threads`"))
    })?;
    let pool = Arc::new(pool);
    pools.insert(count, Arc::clone(&pool));
    Ok(pool)
}
