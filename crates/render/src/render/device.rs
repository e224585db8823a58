//! Passes whose paths a device follows, many tiles at once, while the processor adds up those of the tiles before.

use super::pass::{PASS, probe_pass, tile_pass, trace_paths};
use super::watch::Watch;
use crate::film::{PixelSamples, Region, Tile, View};
use crate::integrator::Job;
use crate::integrator::clock::Stage;
use crate::integrator::counters::Counters;
use crate::integrator::light_images::SeenLights;
use crate::integrator::workspace::{BATCH, Workspace};
use crate::scene::Rgb;
use crate::world::{DevicePath, DevicePaths, DevicePixels};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Numbers of paths at once: the first, and the most. The most is enough for all lanes of the largest GPUs.
const FEWEST: usize = 1 << 16;
const MOST: usize = 1 << 20;

/// Devices that follow a batch within this get one of twice as many paths next; few enough that a render is cancelled
/// soon. The size of batches changes no number.
const QUICK: Duration = Duration::from_millis(10);

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
    let spares = Spares::default();
    let mut seen_lights = SeenLights::default();
    // Memory for what is found next.
    let mut idle = DevicePixels::default();
    let mut size = FEWEST;
    let mut followed: Option<Followed> = None;
    loop {
        let next = if watch.cancelled() {
            None
        } else {
            Batch::next(job, &mut steps, size, &mut seen_lights)
        };
        if next.is_none() && followed.is_none() {
            return;
        }
        work.clock.restart();
        let (after, finished) = rayon::join(
            || next.map(|batch| batch.follow(device, std::mem::take(&mut idle))),
            || {
                followed.take().map(|mut followed| {
                    let counters = followed.add_up(job, probed, &spares);
                    (followed, counters)
                })
            },
        );
        work.clock.end(if finished.is_some() { Stage::Film } else { Stage::Trace });
        if let Some((followed, counters)) = finished {
            work.counters.add(&counters);
            let Batch { steps: done, pass, .. } = followed.batch;
            idle = followed.found;
            let pixels: u64 = done.iter().map(|(tile, _)| u64::from(tile.len())).sum();
            report(&mut work, pixels * pass.len() as u64);
            let left = done.into_iter().map(|(tile, samples)| (tile, pass.end..samples.end));
            steps.extend(left.filter(|(_, samples)| !samples.is_empty()));
        }
        followed = after;
        if followed.as_ref().is_some_and(|followed| followed.elapsed < QUICK) {
            size = MOST.min(2 * size);
        }
    }
}

/// Tiles of which a device follows the paths at once.
struct Batch<'a> {
    steps: Vec<Step<'a>>,
    /// Samples that all of them get now.
    pass: Range<u32>,
    /// The pixels of all tiles, without those in which the camera sees lights: the processor samples these.
    pixels: Vec<(u32, u32)>,
    /// Flags of the pixels of each tile in which the camera sees lights; empty if it sees none.
    seen: Vec<Vec<bool>>,
}

impl<'a> Batch<'a> {
    /// Takes tiles with about so many paths from those that are left; `None` if none is.
    fn next(
        job: &Job,
        steps: &mut Vec<Step<'a>>,
        size: usize,
        lights: &mut SeenLights,
    ) -> Option<Self> {
        steps.sort_by_key(|(tile, samples)| (samples.start, samples.end, tile.region.y));
        let pass = next_pass(&steps.first()?.1);
        let mut paths = 0;
        let fits = |(tile, samples): &&Step| {
            paths += tile.len() as usize * pass.len();
            paths <= size && next_pass(samples) == pass
        };
        let count = steps.iter().take_while(fits).count().max(1);
        let steps: Vec<Step> = steps.drain(..count).collect();
        let mut pixels = Vec::new();
        let seen = steps.iter().map(|(tile, _)| {
            lights.begin(job, std::iter::once(tile.region));
            if lights.is_empty() {
                pixels.extend(tile.pixels());
                return Vec::new();
            }
            let seen: Vec<bool> = tile.pixels().map(|pixel| lights.are_in(job, pixel)).collect();
            pixels.extend(tile.pixels().zip(&seen).filter(|(_, seen)| !**seen).map(|(at, _)| at));
            seen
        });
        let seen = seen.collect();
        Some(Self { steps, pass, pixels, seen })
    }

    /// Has a device follow the paths.
    fn follow(self, device: &dyn DevicePaths, mut found: DevicePixels) -> Followed<'a> {
        let start = Instant::now();
        let followed = device.follow(&self.pixels, self.pass.clone(), &mut found);
        Followed { batch: self, found, failed: !followed, elapsed: start.elapsed() }
    }
}

/// Returns the first of the passes that samples are divided into, which end where those of the processor do.
fn next_pass(samples: &Range<u32>) -> Range<u32> {
    let end = (samples.start / PASS + 1).saturating_mul(PASS);
    samples.start..samples.end.min(end)
}

/// A batch whose paths a device has followed.
struct Followed<'a> {
    batch: Batch<'a>,
    found: DevicePixels,
    /// True if the device has failed, and nothing is found.
    failed: bool,
    elapsed: Duration,
}

impl Followed<'_> {
    /// Adds the samples to the tiles, and those of probes from `probed` on, if it is given. The processor follows the
    /// paths that the device does not know. Returns the counts of all tiles.
    fn add_up(&mut self, job: &Job, probed: Option<u32>, spares: &Spares) -> Counters {
        let Self { batch: Batch { steps, pass, seen, .. }, found, failed, .. } = self;
        let (pass, found) = (&*pass, &*found);
        let mut before = 0;
        let places: Vec<Range<usize>> = steps
            .iter()
            .zip(&*seen)
            .map(|((tile, _), seen)| {
                let first = before;
                before += tile.len() as usize - seen.iter().filter(|&&seen| seen).count();
                first..before
            })
            .collect();
        let add = |spare: &mut Spare, tile: &mut Tile, (own, seen): (Range<usize>, &[bool])| {
            let mut counters = Counters::default();
            if *failed {
                tile_pass(job, &mut [tile], pass.clone(), spare.get(job));
            } else {
                counters = add_found(job, tile, (pass, found, own), seen, spare);
            }
            if let Some(from) = probed {
                probe_pass(job, &mut [tile], from..pass.end, spare.get(job), || true);
            }
            counters.add(&spare.take_counters());
            counters
        };
        let sum = |mut all: Counters, more: Counters| {
            all.add(&more);
            all
        };
        steps
            .par_iter_mut()
            .zip(places.into_par_iter().zip(seen))
            .map_init(
                || Spare::of(spares),
                |spare, ((tile, _), (own, seen))| add(spare, tile, (own, seen)),
            )
            .reduce(Counters::default, sum)
    }
}

/// Adds what a device has found of the pixels of a tile, of which `own` are the places in a batch; the processor samples
/// those in which the camera sees lights, and follows paths that the device does not know. Returns the counts of the others.
fn add_found(
    job: &Job,
    tile: &mut Tile,
    (pass, found, own): (&Range<u32>, &DevicePixels, Range<usize>),
    seen: &[bool],
    spare: &mut Spare,
) -> Counters {
    let mut counters = Counters::default();
    let (mut unsummed, mut paths) = (Vec::new(), Vec::new());
    let mut followed = found.pixels[own].iter();
    let is_seen = |index: usize| seen.get(index).is_some_and(|&seen| seen);
    // The pixels that the device has followed; `None` for the others.
    let pixels: Vec<_> =
        (0..tile.len() as usize).map(|i| if is_seen(i) { None } else { followed.next() }).collect();
    for (pixel, position) in pixels.iter().zip(tile.pixels()) {
        let Some(pixel) = pixel else {
            unsummed.push(position);
            paths.resize(paths.len() + pass.len(), DevicePath::UNKNOWN);
            continue;
        };
        if let Some(place) = pixel.place() {
            unsummed.push(position);
            paths.extend_from_slice(&found.samples[place * pass.len()..][..pass.len()]);
        } else {
            counters.camera_rays += pass.len() as u64;
            counters.bounce_rays += pixel.bounce_rays();
            counters.shadow_rays += pixel.shadow_rays();
        }
    }
    for path in paths.iter().filter(|path| path.radiance().is_some()) {
        counters.camera_rays += 1;
        counters.bounce_rays += path.bounce_rays();
        counters.shadow_rays += path.shadow_rays();
    }
    let lit = (!seen.is_empty()).then_some(tile.region);
    let radiance = complete(job, (&unsummed, pass, lit), &paths, spare);
    let mut each = radiance.chunks_exact(pass.len());
    let samples =
        pixels.into_iter().map(|pixel| match pixel.filter(|pixel| pixel.place().is_none()) {
            Some(pixel) => {
                let (total, squares) = pixel.sums();
                PixelSamples::Sums(total, squares)
            }
            None => PixelSamples::Each(each.next().unwrap_or_default()),
        });
    counters.bad_samples += tile.add_pixels(pass.len() as u32, samples);
    counters
}

/// Returns the radiance of the paths of pixels of a tile; the processor follows those that the device does not know. `lit`
/// is a region in which the camera sees lights, if any.
fn complete(
    job: &Job,
    (pixels, pass, lit): (&[(u32, u32)], &Range<u32>, Option<Region>),
    paths: &[DevicePath],
    spare: &mut Spare,
) -> Vec<Rgb> {
    let mut radiance: Vec<Rgb> =
        paths.iter().map(|path| path.radiance().unwrap_or_default()).collect();
    let mut unknown: Vec<usize> =
        (0..paths.len()).filter(|&path| paths[path].radiance().is_none()).collect();
    // Paths of a batch have the same index among the samples of their pixels.
    let index = |path: usize| path % pass.len();
    unknown.sort_unstable_by_key(|&path| (index(path), path));
    let same = |a: &usize, b: &usize| index(*a) == index(*b);
    for batch in unknown.chunk_by(same).flat_map(|paths| paths.chunks(BATCH)) {
        let sample = pass.start + index(batch[0]) as u32;
        let pixel = |&path: &usize| {
            let (x, y) = pixels[path / pass.len()];
            (x, y, *job.sampler)
        };
        let streams = (batch.iter().map(pixel), sample..sample + 1);
        let work = spare.get(job);
        trace_paths(job, (View::Anything, lit.into_iter()), streams, work);
        batch.iter().zip(&work.paths.radiance).for_each(|(&path, &found)| radiance[path] = found);
    }
    radiance
}

/// Workspaces that no thread uses now.
#[derive(Default)]
struct Spares(Mutex<Vec<Workspace>>);

impl Spares {
    fn all(&self) -> MutexGuard<'_, Vec<Workspace>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The workspace of a thread, which has one if it needs one.
struct Spare<'a> {
    spares: &'a Spares,
    work: Option<Workspace>,
}

impl<'a> Spare<'a> {
    fn of(spares: &'a Spares) -> Self {
        Self { spares, work: None }
    }

    fn get(&mut self, job: &Job) -> &mut Workspace {
        self.work.get_or_insert_with(|| {
            let spare = self.spares.all().pop();
            spare.unwrap_or_else(|| Workspace::new(job.world, job.elisions))
        })
    }

    /// Returns what was counted since it was last asked.
    fn take_counters(&mut self) -> Counters {
        self.work.as_mut().map(|work| std::mem::take(&mut work.counters)).unwrap_or_default()
    }
}

impl Drop for Spare<'_> {
    fn drop(&mut self) {
        self.spares.all().extend(self.work.take());
    }
}
