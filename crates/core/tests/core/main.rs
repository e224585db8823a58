//! Traversals, trees and queries beside their definitions.

mod queries;
mod traversals;
mod trees;
