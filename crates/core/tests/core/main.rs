//! Traversals, trees and queries beside their definitions.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]

mod queries;
mod traversals;
mod trees;
