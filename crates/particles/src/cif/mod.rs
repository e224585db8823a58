//! Readers of CIF: molecules of the Protein Data Bank ([`MmCif`]), in text or in BinaryCIF, and crystals ([`Crystal`]).
//!
//! The crate `pdbtbx` isn't used: it builds a tree of models, chains and residues, many times as large
//! as columns. The syntax is that of Hall, Allen and Brown, "The crystallographic information file
//! (CIF)", Acta Crystallographica A47, 1991.

mod binary;
mod component;
mod connections;
mod crystal;
mod declared;
mod geometry;
mod hall;
mod mmcif;
mod occupancy;
mod rows;
mod space_group;
mod symmetry;
mod tokens;

pub(super) use binary::{decoded, is_binary};
pub(super) use crystal::{Crystal, is_crystal};
pub(super) use mmcif::MmCif;
