//! The program as users run it: commands, messages, exit codes and files.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]
#![cfg(feature = "cli")]

mod annotations;
mod bad_clients;
mod bench;
mod documents;
mod figures;
mod folder;
mod formats;
mod frames;
mod inputs;
mod layers;
mod looks;
mod memory;
mod outputs;
mod packages;
mod page;
mod particles;
mod parts;
mod pictures;
mod pipe;
mod prepared;
#[path = "../common/process.rs"]
mod process;
mod processes;
mod refusals;
mod reports;
mod sequences;
mod slices;
mod status;
mod stress;
mod viewer;
mod views;
