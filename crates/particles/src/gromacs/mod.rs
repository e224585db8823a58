//! Reads trajectories of GROMACS: XTC, compressed, and TRR. Both store big-endian numbers (XDR, RFC 4506) and
//! lengths in nanometers (manual.gromacs.org/current/reference-manual/file-formats.html).

mod compressed;
mod trr;
mod xtc;

pub(crate) use trr::{Trr, is_trr};
pub(crate) use xtc::{Xtc, is_xtc};

use crate::{Cell, FileError};
use glam::DVec3;

/// Returns the cell whose edges are rows of a matrix; none if they are zero.
fn cell(edges: [f64; 9]) -> Option<Cell> {
    let vectors = [0, 3, 6].map(|row| DVec3::from_slice(&edges[row..row + 3]));
    Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] }.declared()
}

/// Returns what `pass` makes of a frame that was looked for; false if there is none, or if the file ends
/// within its header.
fn pass<T>(
    found: Result<Option<T>, FileError>,
    pass: impl FnOnce(T) -> bool,
) -> Result<bool, FileError> {
    match found {
        Ok(found) => Ok(found.is_some_and(pass)),
        Err(error) if error.cut_off => Ok(false),
        Err(error) => Err(error),
    }
}
