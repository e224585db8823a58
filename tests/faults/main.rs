//! Long renders, and all that may befall them: kills at any moment, signals, full disks, folders that vanish, files
//! that are damaged. Whatever it is, what was kept is whole, and the picture comes to the same bytes in the end.
//!
//! `SPHERULE_FAULT_SECONDS=600 cargo test --release --test faults` kills for ten minutes instead of some seconds;
//! the moments are others in every run, and `SPHERULE_FAULT_SEED`, which a run that fails prints, repeats them.
#![cfg(all(feature = "cli", target_os = "linux"))]

mod damage;
#[path = "../cli/folder.rs"]
mod folder;
mod kills;
mod process;
mod resume;
#[path = "../common/seed.rs"]
mod seed;
mod sequences;
mod signals;
