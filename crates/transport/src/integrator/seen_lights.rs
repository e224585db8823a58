//! Small lights that the camera sees near the pixels of a batch of paths.

use super::Job;
use crate::film::Region;
use crate::lanes::MAX_LANES;
use crate::scene::Integrator;
use crate::world::{CausticSource, LightImage, SeenLight};

/// Places in a pixel that are tested for each sample: a row.
pub(super) const PLACES: usize = MAX_LANES;

/// Images of lights near the pixels of a batch of paths.
#[derive(Default)]
pub struct SeenLights {
    images: Vec<LightImage>,
    /// Their numbers in the list of all.
    numbers: Vec<u32>,
    /// By path: its pixel.
    pub(super) pixels: Vec<[u32; 2]>,
}

impl Job<'_> {
    /// Returns whether lights that the camera sees are sampled; shadow rays need a bounce.
    fn samples_images(&self) -> bool {
        self.settings.caustics
            && self.depth() > 0
            && self.settings.integrator == Integrator::Path
            && !self.world.light_images.is_empty()
    }
}

impl SeenLights {
    /// Prepares for paths of pixels of some regions.
    pub fn begin(&mut self, job: &Job, regions: impl Iterator<Item = Region>) {
        if !job.samples_images() {
            return;
        }
        self.numbers.clear();
        for Region { x, y, width, height } in regions {
            let near = job.world.light_images.near([x, y], [x + width, y + height]);
            self.numbers.extend(near);
        }
        self.numbers.sort_unstable();
        self.numbers.dedup();
        let images = self.numbers.iter().map(|&number| job.world.light_images.image(number));
        self.images.clear();
        self.images.extend(images.filter(|image| image.light.bounces() <= job.depth()));
    }

    /// Returns whether there are no images near the pixels.
    pub fn is_empty(&self) -> bool {
        self.images.is_empty()
    }

    /// Returns whether the camera sees a light in the pixel of a column and a row of these regions.
    pub fn are_in(&self, job: &Job, x: u32, y: u32) -> bool {
        self.images.iter().any(|image| image.reaches([x, y], job.filter.radius()))
    }

    /// Stores the pixels of sixteen paths from `first` on.
    pub(super) fn set_pixels(&mut self, first: usize, columns: &[f32], rows: &[f32]) {
        if !self.images.is_empty() {
            self.pixels.truncate(first);
            let pixels = columns.iter().zip(rows).map(|(&x, &y)| [x as u32, y as u32]);
            self.pixels.extend(pixels.take(MAX_LANES));
        }
    }

    /// Returns an image of a light if that is sampled for the pixel of a path.
    pub(crate) fn find(&self, job: &Job, path: usize, light: &SeenLight) -> Option<&LightImage> {
        let mut of_light = self.images.iter().filter(|image| image.light == *light);
        of_light.find(|image| image.reaches(self.pixels[path], job.filter.radius()))
    }

    /// Returns the standard deviation of what is sampled of a light in the pixel of a path, relative to that of
    /// what camera rays find: nearly 0 for points of the light, that of a mean for places in the pixel.
    pub(super) fn deviation(&self, job: &Job, path: usize, source: CausticSource) -> f32 {
        let mut places =
            self.images.iter().filter(|image| image.light.source == source && !image.is_tiny());
        let reached = |image: &LightImage| image.reaches(self.pixels[path], job.filter.radius());
        if places.any(reached) { (PLACES as f32).sqrt().recip() } else { 0.0 }
    }

    /// Returns the pixel of a path.
    pub(super) fn pixel(&self, path: usize) -> [u32; 2] {
        self.pixels[path]
    }

    /// Collects the selected lights of a pixel, each once, and whether their images are tiny.
    pub(super) fn collect(
        &self,
        job: &Job,
        pixel: [u32; 2],
        selected: &impl Fn(&SeenLight) -> bool,
        lights: &mut Vec<(SeenLight, bool)>,
    ) {
        lights.clear();
        for image in self.images.iter().filter(|image| selected(&image.light)) {
            let light = (image.light, image.is_tiny());
            // Images of one light are neighbors.
            if image.reaches(pixel, job.filter.radius()) && lights.last() != Some(&light) {
                lights.push(light);
            }
        }
    }
}
