//! CIF: molecules of the Protein Data Bank ([`MmCif`]), and crystals ([`Crystal`]).
//!
//! The crate `pdbtbx` builds a tree of models, chains and residues, many times as large as columns
//! are, so this is our own, on the syntax of CIF (Hall, Allen and Brown, "The crystallographic
//! information file (CIF)", Acta Crystallographica A47, 1991).

mod crystal;
mod declared;
mod hall;
mod mmcif;
mod occupancy;
mod rows;
mod space_group;
mod symmetry;
mod tokens;

pub(super) use crystal::{Crystal, is_crystal};
pub(super) use mmcif::MmCif;
