//! Long renders, and all that may befall them: kills at any moment, signals, full disks, folders that vanish, files
//! that are damaged. Whatever it is, what was kept is whole, and the picture comes to the same bytes in the end.
//!
//! `SPHERULE_FAULT_SECONDS=600 cargo test --release --test faults` kills for ten minutes instead of some seconds;
//! `SPHERULE_FAULT_SEED` takes other moments.
#![cfg(all(feature = "cli", target_os = "linux"))]

mod damage;
#[path = "../cli/folder.rs"]
mod folder;
mod kills;
mod process;
mod resume;
mod sequences;
mod signals;
