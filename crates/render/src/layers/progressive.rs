//! Layers that are refined together with their image.

use super::sums::Sums;
use super::{Features, Layers, SAMPLES};
use crate::film::{Film, Region, TILE, View};
use crate::integrator::generate::{generate, generate_centers};
use crate::integrator::workspace::Workspace;
use crate::integrator::{Job, stages};
use crate::render::{self, Options, RenderError, passes, view};
use crate::scene::{SamplerKind, Settings};
use crate::trace::Traversal;
use crate::world::World;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Layers that are refined by more samples: equal to the last bit to those that
/// [`layers`](super::layers()) computes at once with this number of samples.
#[derive(Debug)]
pub struct ProgressiveLayers {
    region: Region,
    settings: Settings,
    tiles: Vec<TileLayers>,
}

/// Layers of a tile with the samples so far.
#[derive(Debug)]
pub(super) struct TileLayers {
    region: Region,
    /// The surfaces that its camera rays may hit.
    view: View,
    sums: Vec<Sums>,
    samples: u32,
    /// True if the ids at the pixels' centers are known.
    centered: bool,
}

impl ProgressiveLayers {
    /// Returns the bytes of the sums of a region's samples.
    pub fn bytes(region: Region) -> u64 {
        region.area() * size_of::<Sums>() as u64
    }

    /// Creates layers without samples, for the region of `options`.
    ///
    /// # Errors
    /// Those of [`render()`](crate::render::render()).
    pub fn begin(
        world: &World,
        settings: &Settings,
        options: &Options,
    ) -> Result<Self, RenderError> {
        let region = render::check(world, settings, options)?;
        let tiles: Vec<Region> = Film::tile_regions(region).collect();
        // New memory is slow, and less so if several threads get it.
        let tiles = tiles.into_par_iter().map(TileLayers::new).collect();
        Ok(Self { region, settings: settings.clone(), tiles })
    }

    /// Takes the samples that pixels lack of those of `settings`, at most [`SAMPLES`]. Returns false if
    /// the options' flag cancels it, which is checked for each tile. `world` must be that of the
    /// beginning; if the settings are incompatible with the samples so far, all start again.
    pub fn refine(&mut self, world: &World, settings: &Settings, options: &Options) -> bool {
        if !extends(&self.settings, settings) {
            self.tiles.iter_mut().for_each(TileLayers::reset);
        }
        self.settings = settings.clone();
        let (samples, tiles) = (settings.spp.min(SAMPLES), self.tiles.len());
        let job = Job::new(world, settings, settings.spp, options.tracer, options.elisions);
        let next = AtomicUsize::new(0);
        let queue: Vec<Mutex<&mut TileLayers>> = self.tiles.iter_mut().map(Mutex::new).collect();
        rayon::broadcast(|_| {
            let mut work = Workspace::new(world, options.elisions);
            while !options.is_cancelled() {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let Some(Ok(mut tile)) = queue.get(number).map(Mutex::lock) else { return };
                tile.refine(&job, samples, &mut work);
            }
        });
        next.into_inner() >= tiles && self.tiles.iter().all(|tile| tile.is_complete(samples))
    }

    /// Returns the layers so far. Once the flag of the options is set, pixels are left out.
    pub fn layers(&self, options: &Options) -> Layers {
        let Region { x: left, width, height, .. } = self.region;
        let in_row = width as usize;
        // Zeros are memory that is not there before a thread writes to it.
        let mut pixels = bytemuck::zeroed_vec::<Features>(in_row * height as usize);
        let rows = pixels.par_chunks_mut(in_row * TILE as usize);
        let rows = rows.zip(self.tiles.par_chunks(width.div_ceil(TILE) as usize));
        rows.for_each(|(pixels, tiles)| {
            for tile in tiles.iter().take_while(|_| !options.is_cancelled()) {
                let top = tile.region.y;
                for ((x, y), features) in tile.region.morton().zip(tile.features()) {
                    pixels[(y - top) as usize * in_row + (x - left) as usize] = features;
                }
            }
        });
        Layers { width, height, pixels, statistics: None }
    }
}

/// Returns whether the samples of `a` are among those of `b`.
fn extends(a: &Settings, b: &Settings) -> bool {
    let strata = a.sampler != SamplerKind::Stratified || a.spp == b.spp;
    (a.sampler, a.seed, a.filter) == (b.sampler, b.seed, b.filter) && a.spp <= b.spp && strata
}

impl TileLayers {
    /// Returns the layers of a tile without samples.
    pub(super) fn new(region: Region) -> Self {
        let sums = vec![Sums::default(); region.area() as usize];
        Self { region, view: View::Anything, sums, samples: 0, centered: false }
    }

    fn reset(&mut self) {
        self.sums.fill(Sums::default());
        (self.samples, self.centered) = (0, false);
    }

    fn is_complete(&self, samples: u32) -> bool {
        self.samples == samples && self.centered
    }

    /// Takes the missing samples, and traces the rays through the pixels' centers.
    pub(super) fn refine(&mut self, job: &Job, samples: u32, work: &mut Workspace) {
        if self.is_complete(samples) {
            return;
        }
        if !self.centered && job.tracer.traversal != Traversal::Brute {
            self.view = view(job, self.region);
        }
        if self.view == View::Anything || job.world.ground.is_some() {
            self.trace(job, samples, work);
        }
        (self.samples, self.centered) = (samples, true);
    }

    fn trace(&mut self, job: &Job, samples: u32, work: &mut Workspace) {
        work.view = self.view;
        for pass in passes(samples).filter(|pass| pass.end > self.samples) {
            let pass = pass.start.max(self.samples)..pass.end;
            let count = pass.len();
            generate(job, self.region.morton(), pass, work);
            stages::intersect(job, work);
            for (pixel, sums) in self.sums.iter_mut().enumerate() {
                (pixel * count..(pixel + 1) * count).for_each(|row| sums.add(job.world, work, row));
            }
        }
        if self.centered {
            return;
        }
        generate_centers(job, self.region.morton(), work);
        stages::intersect(job, work);
        for (sums, &hit) in self.sums.iter_mut().zip(&work.hits.sphere) {
            sums.id = job.world.id_of(hit);
        }
    }

    /// Returns the features of its pixels, in the order of [`Tile::pixels`](crate::film::Tile::pixels).
    pub(super) fn features(&self) -> impl Iterator<Item = Features> {
        self.sums.iter().map(|sums| sums.mean(self.samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layers::{Layer, layers};
    use crate::scene::generate::default_scene;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn refined_layers_equal_those_computed_at_once() {
        let mut scene = default_scene(4);
        (scene.settings.width, scene.settings.height) = (40, 27);
        let world = World::build(&scene).unwrap();
        for sampler in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
            let of = |spp| Settings { spp, sampler, ..scene.settings.clone() };
            let options = Options::default();
            let mut growing = ProgressiveLayers::begin(&world, &of(1), &options).unwrap();
            for spp in [1, 2, 5, 16, 20, 37, 36, 40] {
                assert!(growing.refine(&world, &of(spp), &options));
                let whole = layers(&world, &of(spp), &options, &[Layer::Depth]).unwrap();
                assert_eq!(growing.layers(&Options::default()), whole, "{sampler:?} {spp}");
            }
        }
    }

    #[test]
    fn cancelled_layers_can_be_resumed() {
        let mut scene = default_scene(4);
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (40, 27, 3);
        let world = World::build(&scene).unwrap();
        let flag = AtomicBool::new(true);
        let stopped = Options { cancel: Some(&flag), ..Options::default() };
        let mut growing = ProgressiveLayers::begin(&world, &scene.settings, &stopped).unwrap();
        assert!(!growing.refine(&world, &scene.settings, &stopped));
        assert!(growing.refine(&world, &scene.settings, &Options::default()));
        let whole = layers(&world, &scene.settings, &Options::default(), &[Layer::Depth]).unwrap();
        assert_eq!(growing.layers(&Options::default()), whole);
    }
}
