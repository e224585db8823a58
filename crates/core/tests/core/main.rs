//! Traversals, trees and queries beside their definitions.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]

mod distances;
mod queries;
mod reference;
mod translucency;
mod traversals;
mod trees;
