//! Wrapping and replication of periodic cells.

use super::ViewArgs;
use crate::cli::failure::Failure;
use spherule_render::compose::CellRequest;

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

    /// Returns what is done to the cell.
    pub(in crate::cli) fn cell(&self) -> CellRequest {
        CellRequest { wrap: self.wrap, copies: self.replicate, show: self.cell }
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
