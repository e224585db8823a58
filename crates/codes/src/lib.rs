//! From pixels to the codes of files: tone curves, and the rows of PNG images.
//!
//! These loops over all pixels are apart from all else that is known of images so that builds for tests optimize them, and
//! little else.

#![forbid(unsafe_code)]
#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "tests compare with tolerances"))]

mod deflate;
pub mod png;
pub mod tone;
