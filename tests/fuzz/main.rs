//! Fuzzing of all readers with damaged files: truncated, spliced, nested, with extreme numbers. For all
//! inputs, readers end soon, use little memory, do not panic, and return a valid result or a short error.
//!
//! Each file of `corpus/`, which includes all inputs that failed in the past, is read; then random mutants of
//! them. Their seed is the time, and a failed run prints it. `SPHERULE_FUZZ_SEED` repeats a run, and
//! `SPHERULE_FUZZ_SECONDS` sets the time for each target:
//!
//! ```sh
//! SPHERULE_FUZZ_SECONDS=600 SPHERULE_FUZZ_SEED=7 cargo test --release --test fuzz
//! ```
//!
//! Cases run in a separate process ([`worker`]), so that failures that end it (memory, time, stack) are
//! reported like others, with the name of a file in `target/tmp` that contains the reduced input. Fix the
//! reader, and add the input to the corpus.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]

mod mutate;
mod png;
mod process;
mod reduce;
#[path = "../common/seed.rs"]
mod seed;
mod targets;
mod worker;

use mutate::Mutator;
use process::Process;
use reduce::reduce;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Number of mutants of each target in an ordinary run, and the time limit.
const MUTANTS: usize = 2000;
const PATIENCE: Duration = Duration::from_secs(4);

/// Number of different faults after which a run ends.
const FAULTS: usize = 10;

#[test]
fn scenes() {
    let others = [files("tests/fuzz/corpus/particles"), files("tests/fuzz/corpus/pictures")];
    fuzz("scenes", &files("scenes"), &others.concat());
}

#[test]
fn particles() {
    fuzz("particles", &[], &[]);
}

#[test]
fn pictures() {
    fuzz("pictures", &[], &[]);
}

#[test]
fn crashes_are_reported_and_survived() {
    let mut process = Process::new("faults", &[]);
    for (input, expected) in [
        ("panic", "as requested"),
        ("memory", "allocation of 1073741824"),
        ("stack", "stack"),
        ("end", ""),
    ] {
        let fault = process.run(input.as_bytes());
        assert!(fault.as_ref().is_err_and(|fault| fault.contains(expected)), "{input}: {fault:?}");
        assert_eq!(process.run(b"nothing"), Ok(()), "after {input}");
    }
}

/// Runs a target on every seed, from its corpus and `more`, and on mutants of them. The files `beside` are in
/// the folder of each case.
fn fuzz(target: &str, more: &[PathBuf], beside: &[PathBuf]) {
    let seconds = seed::number("SPHERULE_FUZZ_SECONDS").map(Duration::from_secs);
    let seed = seed::seed("SPHERULE_FUZZ_SEED");
    let mut mutator = Mutator::new(seed);
    let paths = [more, &files(&format!("tests/fuzz/corpus/{target}"))].concat();
    let read = |path: &PathBuf| fs::read(path).expect("a seed that can be read");
    let seeds: Vec<Vec<u8>> = paths.iter().map(read).collect();
    assert!(!seeds.is_empty(), "there is no corpus of {target}");
    let mut faults = Faults { process: Process::new(target, beside), found: Vec::new() };
    for (seed, path) in seeds.iter().zip(&paths) {
        faults.look(seed, &path.to_string_lossy());
    }
    let start = Instant::now();
    let mut done = 0;
    while seconds.map_or(done < MUTANTS, |seconds| start.elapsed() < seconds)
        && start.elapsed() < seconds.unwrap_or(PATIENCE)
        && faults.found.len() < FAULTS
    {
        faults.look(&mutator.mutant(&seeds), &format!("mutant {done}"));
        done += 1;
    }
    let messages: Vec<_> = faults.found.iter().map(|fault| fault.message.as_str()).collect();
    let files = seeds.len();
    let summary = format!("{target}: {files} files and {done} mutants, SPHERULE_FUZZ_SEED={seed}");
    assert!(messages.is_empty(), "{summary}\n{}", messages.join("\n"));
}

/// The signature of a fault, and a message about its first case.
struct Fault {
    kind: String,
    message: String,
}

/// The different faults of a target.
struct Faults<'t> {
    process: Process<'t>,
    found: Vec<Fault>,
}

impl Faults<'_> {
    /// Runs a case; if it fails in a new way, reduces its input and keeps that.
    fn look(&mut self, bytes: &[u8], name: &str) {
        let Err(fault) = self.process.run(bytes) else { return };
        let kind = kind(&fault);
        if self.found.iter().any(|found| found.kind == kind) {
            return;
        }
        let reduced = reduce(bytes, |fewer| {
            self.process.run(fewer).is_err_and(|fault| self::kind(&fault) == kind)
        });
        let kept = self.process.keep(&reduced, self.found.len());
        let message = format!("{name}, kept as {}: {fault}", kept.display());
        self.found.push(Fault { kind, message });
    }
}

/// Removes numbers, so that faults that differ only in numbers are equal.
fn kind(fault: &str) -> String {
    fault.chars().filter(|letter| letter.is_alphabetic()).take(150).collect()
}

/// Returns the files of a folder of the repository, sorted by name.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let entries = fs::read_dir(folder).expect("a folder of the project");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.is_file() && path.extension().is_none_or(|suffix| suffix != "md"));
    paths.sort();
    paths
}
