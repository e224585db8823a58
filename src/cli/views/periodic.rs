//! Wrapping and replication of periodic cells.

use super::ViewArgs;
use crate::cli::failure::Failure;
use spherule_render::scene::particles::{Cell, Particles, PeriodicError};
use spherule_render::scene::{FileError, Scene};
use std::path::Path;

/// `NA,NB,NC`.
pub(super) fn copies(text: &str) -> Result<[u32; 3], String> {
    let counts: Option<Vec<u32>> = text.split(',').map(|count| count.trim().parse().ok()).collect();
    counts
        .and_then(|counts| <[u32; 3]>::try_from(counts).ok())
        .filter(|counts| !counts.contains(&0))
        .ok_or_else(|| "give three integers of at least 1, as in 2,2,1".to_owned())
}

impl ViewArgs {
    /// Rejects options that apply only to particle files.
    pub(in crate::cli) fn refuse_cells(&self) -> Result<(), Failure> {
        if self.needs_cell() {
            let message = "--wrap, --replicate and --cell need a particle file";
            return Err(Failure::usage("render", message));
        }
        Ok(())
    }

    /// Draws the cell if `--cell` is given, and that of a crystal.
    pub(in crate::cli) fn show_cell(
        &self,
        scene: &mut Scene,
        cell: Option<&Cell>,
        is_crystal: bool,
    ) {
        if self.cell || is_crystal {
            scene.look.cell = cell.copied();
        }
    }

    /// Wraps and replicates particles as requested; returns the resulting cell, if there is one.
    pub(in crate::cli) fn repeat(
        &self,
        path: &Path,
        particles: &mut Particles,
    ) -> Result<Option<Cell>, FileError> {
        let refused = |error: PeriodicError| FileError::whole_file(path, error.to_string());
        if self.wrap {
            particles.wrap().map_err(refused)?;
        }
        if let Some(copies) = self.replicate {
            particles.replicate(copies).map_err(refused)?;
        }
        if self.cell && particles.cell.is_none() {
            return Err(FileError::whole_file(path, "has no simulation cell to draw"));
        }
        Ok(particles.cell)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_counts_are_read_and_nothing_else() {
        assert_eq!(copies("2,3,1"), Ok([2, 3, 1]));
        assert_eq!(copies("2, 3, 1"), Ok([2, 3, 1]));
        for text in ["2,3", "2,3,1,1", "0,1,1", "-1,1,1", "1.5,1,1", "", "99999999999,1,1"] {
            assert!(copies(text).is_err(), "{text}");
        }
    }
}
