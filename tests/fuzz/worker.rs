//! The process that runs a target's cases: it reads paths from standard input, and writes answers to standard
//! output.

use crate::targets;
use cap::Cap;
use std::alloc::System;
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Environment variable with the name of the target; only workers have it.
pub(crate) const TARGET: &str = "SPHERULE_FUZZ_TARGET";

/// Prefix of an answer, which is empty or describes the failure in one line.
pub(crate) const ANSWER: &str = "spherule-fuzz-answer:";

/// Memory limit of a case in bytes. A larger allocation fails, which ends the process unless the reader
/// handles it.
const MEMORY: usize = 1 << 29;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// Message of the last panic. Only answers report panics, since panics in decoders of other crates may be
/// caught.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

#[test]
#[ignore = "a worker process: the fuzzing tests start it"]
fn answers() {
    let Ok(target) = std::env::var(TARGET) else { return };
    std::panic::set_hook(Box::new(|panic| *last_panic() = panic.to_string()));
    for path in io::stdin().lines() {
        let path = path.expect("a path in UTF-8");
        let outcome = run(&target, Path::new(&path));
        let answer = outcome.err().unwrap_or_default().replace('\n', " ");
        writeln!(io::stdout(), "{ANSWER}{answer}").expect("someone who listens");
    }
}

fn run(target: &str, path: &Path) -> Result<(), String> {
    // Fails only if more memory is already allocated.
    let _ = ALLOCATOR.set_limit(ALLOCATOR.allocated() + MEMORY);
    let outcome = catch_unwind(AssertUnwindSafe(|| match target {
        "scenes" => targets::scene(path),
        "particles" => targets::particles(path),
        "pictures" => targets::picture(path),
        _ => targets::fault(path),
    }));
    let _ = ALLOCATOR.set_limit(usize::MAX);
    outcome.map_err(|_| last_panic().clone())
}

fn last_panic() -> std::sync::MutexGuard<'static, String> {
    LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner)
}
