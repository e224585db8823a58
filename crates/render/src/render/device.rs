//! Passes whose paths a device follows, many tiles at once.

use super::pass::{PASS, probe_pass, tile_pass, trace_paths};
use super::watch::Watch;
use crate::film::{Tile, View};
use crate::integrator::Job;
use crate::integrator::clock::Stage;
use crate::integrator::workspace::{BATCH, Workspace};
use crate::scene::Rgb;
use crate::world::{DevicePath, DevicePaths};
use rayon::prelude::*;
use std::ops::Range;

/// Maximum number of paths at once: enough for all lanes of the largest GPUs, and few enough that a render is cancelled
/// soon.
const PATHS: usize = 1 << 18;

/// A tile, and samples of its pixels that it is to get.
type Step<'a> = (&'a mut Tile, Range<u32>);

/// Takes samples of tiles of which the device follows the paths, a pass at a time; and of their probes, from `probed`
/// on, if it is given, which the processor follows. `report` gets the number of samples of each batch.
///
/// Tiles whose camera rays hit no sphere get none: they take the processor no time.
pub(super) fn run<'a>(
    job: &Job,
    steps: impl Iterator<Item = Step<'a>>,
    probed: Option<u32>,
    watch: &Watch,
    mut report: impl FnMut(&mut Workspace, u64),
) {
    let Some(device) = job.device else { return };
    let mut steps: Vec<Step> = steps
        .filter(|(tile, samples)| tile.view == View::Anything && !samples.is_empty())
        .collect();
    let mut work = Workspace::new(job.world, job.elisions);
    while !watch.cancelled() {
        steps.sort_by_key(|(tile, samples)| (samples.start, samples.end, tile.region.y));
        let Some(first) = steps.first() else { return };
        let pass = next_pass(&first.1);
        let mut paths = 0;
        let fits = |(tile, samples): &&Step| {
            paths += tile.len() as usize * pass.len();
            paths <= PATHS && next_pass(samples) == pass
        };
        let count = steps.iter().take_while(fits).count().max(1);
        let mut tiles: Vec<&mut Tile> =
            steps[..count].iter_mut().map(|(tile, _)| &mut **tile).collect();
        work.clock.restart();
        let added: u64 = tiles.iter().map(|tile| u64::from(tile.len())).sum();
        take(job, device, &mut tiles, (&pass, probed), &mut work);
        report(&mut work, added * pass.len() as u64);
        for (_, samples) in &mut steps[..count] {
            samples.start = pass.end;
        }
        steps.retain(|(_, samples)| !samples.is_empty());
    }
}

/// Returns the first of the passes that samples are divided into, which end where those of the processor do.
fn next_pass(samples: &Range<u32>) -> Range<u32> {
    let end = (samples.start / PASS + 1).saturating_mul(PASS);
    samples.start..samples.end.min(end)
}

/// Takes samples of tiles.
fn take(
    job: &Job,
    device: &dyn DevicePaths,
    tiles: &mut [&mut Tile],
    (samples, probed): (&Range<u32>, Option<u32>),
    work: &mut Workspace,
) {
    let pixels: Vec<(u32, u32)> = tiles.iter().flat_map(|tile| tile.pixels()).collect();
    let radiance = device.follow(&pixels, samples.clone()).map(|paths| {
        count_rays(&paths, work);
        work.clock.end(Stage::Trace);
        complete(job, &pixels, samples, &paths, work)
    });
    let mut first = 0;
    let count = samples.len() as u32;
    let own: Vec<Range<usize>> = tiles
        .iter()
        .map(|tile| {
            let own = first..first + (tile.len() * count) as usize;
            first = own.end;
            own
        })
        .collect();
    let counted: Vec<_> = tiles
        .par_iter_mut()
        .zip(own)
        .map_init(
            || Workspace::new(job.world, job.elisions),
            |work, (tile, own)| {
                match &radiance {
                    Some(radiance) => {
                        work.counters.bad_samples += tile.add(&radiance[own], count);
                    }
                    None => tile_pass(job, &mut [&mut **tile], samples.clone(), work),
                }
                if let Some(from) = probed {
                    probe_pass(job, &mut [&mut **tile], from..samples.end, work, || true);
                }
                std::mem::take(&mut work.counters)
            },
        )
        .collect();
    for counters in &counted {
        work.counters.add(counters);
    }
    work.clock.end(Stage::Film);
}

/// Counts the rays of the paths that the device knows.
fn count_rays(paths: &[DevicePath], work: &mut Workspace) {
    for path in paths.iter().filter(|path| path.radiance().is_some()) {
        work.counters.camera_rays += 1;
        work.counters.bounce_rays += path.bounce_rays();
        work.counters.shadow_rays += path.shadow_rays();
    }
}

/// Returns the radiance of paths; the processor follows those that the device does not know.
fn complete(
    job: &Job,
    pixels: &[(u32, u32)],
    samples: &Range<u32>,
    paths: &[DevicePath],
    work: &mut Workspace,
) -> Vec<Rgb> {
    let mut radiance: Vec<Rgb> =
        paths.iter().map(|path| path.radiance().unwrap_or_default()).collect();
    let mut unknown: Vec<usize> =
        (0..paths.len()).filter(|&path| paths[path].radiance().is_none()).collect();
    // Paths of a batch have the same index among the samples of their pixels.
    let index = |path: usize| path % samples.len();
    unknown.sort_unstable_by_key(|&path| (index(path), path));
    let same = |a: &usize, b: &usize| index(*a) == index(*b);
    let batches: Vec<&[usize]> =
        unknown.chunk_by(same).flat_map(|paths| paths.chunks(BATCH)).collect();
    let follow = |work: &mut Workspace, batch: &&[usize]| {
        let sample = samples.start + index(batch[0]) as u32;
        let pixel = |&path: &usize| {
            let (x, y) = pixels[path / samples.len()];
            (x, y, *job.sampler)
        };
        let streams = (batch.iter().map(pixel), sample..sample + 1);
        trace_paths(job, (View::Anything, std::iter::empty()), streams, work);
        let followed = work.paths.radiance[..batch.len()].to_vec();
        (followed, std::mem::take(&mut work.counters))
    };
    let followed: Vec<_> = batches
        .par_iter()
        .map_init(|| Workspace::new(job.world, job.elisions), |work, batch| follow(work, batch))
        .collect();
    for (batch, (followed, counters)) in batches.iter().zip(followed) {
        batch.iter().zip(followed).for_each(|(&path, found)| radiance[path] = found);
        work.counters.add(&counters);
    }
    work.clock.end(Stage::Shade);
    radiance
}
