//! The `spherule` program: renders scenes made of spheres, and looks at scenes and pictures.
//!
//! What is typed becomes `Args`, these become a validated job, and the job calls the library's
//! public interface.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::finish(cli::run().unwrap_or_else(cli::Failure::report))
}
