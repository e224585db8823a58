//! Readers of AMBER's text files: topologies (`prmtop`, `parm7`) and restart files (`rst7`, `inpcrd`).

mod prmtop;
mod restart;

pub(super) use prmtop::{Prmtop, is_prmtop};
pub(super) use restart::{Restart, is_restart};
