//! An unfinished render becomes a file.

use super::blocks::{TILES, pack};
use super::{FORMAT, MAGIC, Origin, PROGRAM};
use crate::atomic::write_atomically;
use crate::render::{Outline, ResumableRender};
use crate::sealed::Sealing;
use rayon::prelude::*;
use std::io::{self, Write};
use std::path::Path;

/// Blocks that are packed before they are written, for each thread.
const AHEAD: usize = 4;

/// Writes a render to a file that [`super::read()`] reads, with the threads of the current rayon
/// pool.
///
/// # Errors
/// What [`write_atomically`] says; the old file is then untouched.
pub fn write(path: &Path, origin: &Origin, render: &ResumableRender) -> io::Result<()> {
    let head = postcard::to_stdvec(&(PROGRAM, origin, Outline::of(render)));
    let head = head.map_err(io::Error::other)?;
    write_atomically(path, |writer| {
        let mut sealing = Sealing::new(writer);
        sealing.write_all(&MAGIC)?;
        sealing.write_all(&FORMAT.to_le_bytes())?;
        sealing.write_all(&(head.len() as u64).to_le_bytes())?;
        sealing.write_all(&head)?;
        for tiles in render.film().tiles.chunks(TILES * AHEAD * rayon::current_num_threads()) {
            let blocks: Vec<Vec<u8>> = tiles.par_chunks(TILES).map(pack).collect();
            blocks.iter().try_for_each(|block| sealing.write_all(block))?;
        }
        sealing.seal()
    })
}
