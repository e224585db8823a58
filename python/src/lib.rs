//! The extension module of the Python package `spherule`.
//!
//! The package's Python modules check arguments and turn them into arrays and tables; here they become scenes,
//! pictures and trees. Work runs on threads of its own while Python waits without its lock, so that other threads of
//! Python go on and a signal is noticed at once ([`watch`]).

#![forbid(unsafe_code)]
#![allow(clippy::needless_pass_by_value, reason = "arguments come from Python by value")]

mod arrays;
mod encode;
mod errors;
mod first_frame;
mod level;
mod movie;
mod options;
mod parts;
mod pools;
mod read;
mod scene;
mod session;
mod tree;
mod watch;

use pyo3::prelude::*;

#[pymodule]
mod _spherule {
    #[pymodule_export]
    use super::encode::{Drawn, Matte, display_codes, encode};
    #[pymodule_export]
    use super::level::{compiled_level, missing_features, packaged_levels};
    #[pymodule_export]
    use super::movie::{FrameSequence, Video};
    #[pymodule_export]
    use super::parts::{merge, render_part};
    #[pymodule_export]
    use super::read::{FrameFile, count_frames, element_of, material_names, read};
    #[pymodule_export]
    use super::scene::{Scene, color_of, linear_color};
    #[pymodule_export]
    use super::session::{Refinement, refine, render};
    #[pymodule_export]
    use super::tree::SphereTree;
    #[pymodule_export]
    use super::watch::Stop;
}
