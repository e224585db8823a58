//! The `spherule` program: renders scenes of spheres, and inspects scenes and images.
//!
//! The command line is parsed to `Args`; that of a render is validated as its setup. Commands call `spherule-render` and
//! `spherule-measure`.

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::finish(cli::run())
}
