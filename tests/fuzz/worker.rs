//! The process that runs a target's cases, from inside: paths come on standard input, answers go to
//! standard output.

use crate::targets;
use cap::Cap;
use std::alloc::System;
use std::io::{self, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// The variable of the environment that names the target; without it this is no worker.
pub(crate) const TARGET: &str = "SPHERULE_FUZZ_TARGET";

/// What an answer stands behind: nothing, or how the case failed, in one line.
pub(crate) const ANSWER: &str = "spherule-fuzz-answer:";

/// Memory that a case may take, in bytes. An allocation beyond it fails, which ends the process
/// unless the reader asked whether it may.
const MEMORY: usize = 1 << 29;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

/// Message of the last panic. Panics are reported by answers alone: decoders of other crates may panic,
/// and be caught.
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
    // Fails only if more than that is taken already.
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
