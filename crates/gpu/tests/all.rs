//! Tests that need a device, in one program: they share one device, and the kernels that it has compiled.
//! `tools/gpu-check` takes the program to other machines.

mod common;
mod devices;
mod hits;
mod loss;
mod paths;
mod stages;
