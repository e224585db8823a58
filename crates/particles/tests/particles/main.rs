//! Tests of readers on files as programs and people write them, in one program.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]

mod bonds;
mod cells;
mod columns;
mod common;
mod containers;
mod crystals;
mod elements;
mod omissions;
mod shapes;
mod tables;
mod trajectories;
