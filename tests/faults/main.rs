//! Fault tolerance of long renders: kills at any moment, signals, full disks, removed folders, damaged files.
//! In all cases, checkpoints are intact, and the final image has the same bytes.
//!
//! `SPHERULE_FAULT_SECONDS=600 cargo test --release --test faults` kills for ten minutes instead of a few
//! seconds. Moments are random in every run; `SPHERULE_FAULT_SEED`, which a failed run prints, repeats them.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]
#![cfg(all(feature = "cli", target_os = "linux"))]

mod damage;
#[path = "../cli/folder.rs"]
mod folder;
mod kills;
mod long;
#[path = "../common/process.rs"]
mod process;
mod resume;
#[path = "../common/seed.rs"]
mod seed;
mod sequences;
mod signals;
