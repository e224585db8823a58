//! Writing of checkpoints.

use super::blocks::{TILES, pack};
use super::{FORMAT, MAGIC, Origin, PROGRAM};
use crate::atomic::write_atomically;
use crate::render::{RenderHeader, ResumableRender};
use crate::sealed::HashingWriter;
use rayon::prelude::*;
use std::io::{self, Write};
use std::path::Path;

/// Number of blocks per thread that are compressed before they are written.
const BLOCKS_PER_THREAD: usize = 4;

/// Writes a render to a file for [`super::read()`], with the threads of the current rayon pool.
///
/// # Errors
/// Those of [`write_atomically`]; the old file is then unchanged.
pub fn write(path: &Path, origin: &Origin, render: &ResumableRender) -> io::Result<()> {
    let head = postcard::to_stdvec(&(PROGRAM, origin, RenderHeader::of(render)));
    let head = head.map_err(io::Error::other)?;
    write_atomically(path, |writer| {
        let mut file = HashingWriter::begin(writer, &MAGIC, FORMAT, &head)?;
        for tiles in
            render.film().tiles.chunks(TILES * BLOCKS_PER_THREAD * rayon::current_num_threads())
        {
            let blocks: Vec<Vec<u8>> = tiles.par_chunks(TILES).map(pack).collect();
            blocks.iter().try_for_each(|block| file.write_all(block))?;
        }
        file.finish()
    })
}
