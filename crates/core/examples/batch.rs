//! Times batches of rays on all threads, for `python/benchmarks/rays.py`, which asks for one round after the other.
//!
//! ```sh
//! cargo build --release --package spherule-core --example batch
//! python python/benchmarks/rays.py --batch target/release/examples/batch
//! ```
//!
//! The argument is the common beginning of the paths of raw float32 columns: `-positions.f32` and `-radius.f32`,
//! `-origins.f32` and `-directions.f32`, x before y before z. For each line on the standard input, the time of a batch
//! in seconds and the number of rays that hit something go to the standard output.

use rayon::prelude::*;
use spherule_core::{Hits, NOTHING, QueryError, RayColumns, SphereTree};
use std::error::Error;
use std::io::{Write, stdin, stdout};
use std::time::Instant;

/// Rays of a task, as docs/library.md advises: as many as are put in order together.
const TASK: usize = 1 << 16;

fn main() -> Result<(), Box<dyn Error>> {
    let stem = std::env::args().nth(1).ok_or("the beginning of the files' paths is missing")?;
    let read = |name: &str| -> Result<Vec<f32>, Box<dyn Error>> {
        let bytes = std::fs::read(format!("{stem}-{name}.f32"))?;
        Ok(bytes.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect())
    };
    let (positions, radius) = (read("positions")?, read("radius")?);
    let [x, y, z] = columns(&positions)?;
    let tree = SphereTree::from_columns(x, y, z, &radius)?;
    let (origins, directions) = (read("origins")?, read("directions")?);
    let (origin, direction) = (columns(&origins)?, columns(&directions)?);
    for line in stdin().lines() {
        line?;
        let start = Instant::now();
        let sphere = trace(&tree, origin, direction)?.1;
        let seconds = start.elapsed().as_secs_f64();
        let hits = sphere.iter().filter(|&&sphere| sphere != NOTHING).count();
        writeln!(stdout(), "{seconds} {hits}")?;
    }
    Ok(())
}

/// The columns x, y and z of a table that has them one after the other.
fn columns(table: &[f32]) -> Result<[&[f32]; 3], Box<dyn Error>> {
    let columns: Vec<&[f32]> = table.chunks((table.len() / 3).max(1)).collect();
    columns.try_into().map_err(|_| "three columns of the same length are needed".into())
}

/// Distances and spheres, in new memory as Python has them.
fn trace(
    tree: &SphereTree,
    origin: [&[f32]; 3],
    direction: [&[f32]; 3],
) -> Result<(Vec<f64>, Vec<u32>), QueryError> {
    let count = origin[0].len();
    let (mut t, mut sphere) = (vec![f64::INFINITY; count], vec![NOTHING; count]);
    let size = count.div_ceil(4 * rayon::current_num_threads()).clamp(1, TASK);
    let tasks = t.par_chunks_mut(size).zip(sphere.par_chunks_mut(size)).enumerate();
    tasks.try_for_each(|(task, (t, sphere))| {
        let (first, count) = (task * size, t.len());
        let rays = RayColumns {
            origin: origin.map(|column| &column[first..first + count]),
            direction: direction.map(|column| &column[first..first + count]),
        };
        tree.intersect_columns(&rays, Hits { t, sphere, surface: None }).map(|_| ())
    })?;
    Ok((t, sphere))
}
