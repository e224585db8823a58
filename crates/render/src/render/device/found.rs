//! Adds to a tile what a device has found of its pixels.

use super::super::pass::trace_paths;
use super::queue::FoundPixels;
use crate::film::{PixelSamples, Region, Tile, View};
use crate::integrator::Job;
use crate::integrator::columns::BATCH_PATHS;
use crate::integrator::workspace::Workspace;
use crate::scene::Rgb;
use crate::world::DevicePath;
use std::ops::Range;

/// Adds the samples of a pass that a device has found to a tile. The processor samples the pixels that the device was not
/// given, in which the camera sees lights, and follows the paths that the device does not know.
pub(super) fn add(
    job: &Job,
    tile: &mut Tile,
    pass: &Range<u32>,
    found: &FoundPixels,
    work: &mut Workspace,
) {
    let (mut unsummed, mut paths) = (Vec::new(), Vec::new());
    let mut followed = found.all.pixels[found.own.clone()].iter();
    let is_left = |index: usize| found.left.get(index).is_some_and(|&left| left);
    // The pixels that the device has followed; `None` for the others.
    let pixels: Vec<_> =
        (0..tile.len() as usize).map(|i| if is_left(i) { None } else { followed.next() }).collect();
    for (pixel, position) in pixels.iter().zip(tile.pixels()) {
        let Some(pixel) = pixel else {
            unsummed.push(position);
            paths.resize(paths.len() + pass.len(), DevicePath::UNKNOWN);
            continue;
        };
        if let Some(place) = pixel.place() {
            unsummed.push(position);
            paths.extend_from_slice(&found.all.samples[place * pass.len()..][..pass.len()]);
        } else {
            work.counters.camera_rays += pass.len() as u64;
            work.counters.bounce_rays += pixel.bounce_rays();
            work.counters.shadow_rays += pixel.shadow_rays();
        }
    }
    for path in paths.iter().filter(|path| path.radiance().is_some()) {
        work.counters.camera_rays += 1;
        work.counters.bounce_rays += path.bounce_rays();
        work.counters.shadow_rays += path.shadow_rays();
    }
    let lit = (!found.left.is_empty()).then_some(tile.region);
    let radiance = complete(job, &unsummed, pass, lit, &paths, work);
    let mut each = radiance.chunks_exact(pass.len());
    let samples =
        pixels.into_iter().map(|pixel| match pixel.filter(|pixel| pixel.place().is_none()) {
            Some(pixel) => {
                let (total, squares) = pixel.sums();
                PixelSamples::Sums(total, squares)
            }
            None => PixelSamples::Each(each.next().unwrap_or_default()),
        });
    work.counters.bad_samples += tile.add_pixels(pass.len() as u32, samples);
}

/// Returns the radiance of the paths of pixels of a tile; the processor follows those that the device does not know. `lit`
/// is a region in which the camera sees lights, if any.
fn complete(
    job: &Job,
    pixels: &[(u32, u32)],
    pass: &Range<u32>,
    lit: Option<Region>,
    paths: &[DevicePath],
    work: &mut Workspace,
) -> Vec<Rgb> {
    let mut radiance: Vec<Rgb> =
        paths.iter().map(|path| path.radiance().unwrap_or_default()).collect();
    let mut unknown: Vec<usize> =
        (0..paths.len()).filter(|&path| paths[path].radiance().is_none()).collect();
    // Paths of a batch have the same index among the samples of their pixels.
    let index = |path: usize| path % pass.len();
    unknown.sort_unstable_by_key(|&path| (index(path), path));
    let same = |a: &usize, b: &usize| index(*a) == index(*b);
    for batch in unknown.chunk_by(same).flat_map(|paths| paths.chunks(BATCH_PATHS)) {
        let sample = pass.start + index(batch[0]) as u32;
        let pixel = |&path: &usize| {
            let (x, y) = pixels[path / pass.len()];
            (x, y, job.sampler)
        };
        let streams = batch.iter().map(pixel);
        trace_paths(job, View::Anything, lit.into_iter(), streams, sample..sample + 1, work);
        batch.iter().zip(&work.paths.radiance).for_each(|(&path, &found)| radiance[path] = found);
    }
    radiance
}
