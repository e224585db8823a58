//! Rendering with threads.

use super::random::{Cells, Random, lock};
use super::shape::Ray;
use super::{PaperTracer, Unsupported};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use spherule_render::image::Image;
use spherule_render::sampling::stream;
use spherule_render::scene::{Integrator, Roulette, Settings};
use spherule_render::vec3::Vec3;
use std::f64::consts::TAU;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// The state that threads share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threading {
    /// One random number generator and one list of finished pixels, each behind a lock, as in the
    /// paper. With more than one thread, images are not reproducible.
    Critical,
    /// Each image row has its own random number generator and pixels; nothing is shared.
    Independent,
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Render {
    /// Mean radiance of each pixel.
    pub image: Image,
    /// Number of rays of all kinds.
    pub rays: u64,
    /// Render time.
    pub elapsed: Duration,
}

/// Settings of a render.
struct Plan {
    /// Probability that a mirrored ray survives roulette.
    survival: f64,
    /// Maximum number of bounces.
    depth: u32,
    /// Strata of light samples.
    shadows: Cells,
    /// Strata of pixel samples.
    pixel: Cells,
}

/// State of a thread.
struct Worker<'a> {
    plan: &'a Plan,
    random: Random<'a>,
    rays: u64,
}

impl Plan {
    fn new(settings: &Settings) -> Result<Self, Unsupported> {
        settings.check()?;
        let Integrator::Whitted { shadow_samples } = settings.integrator else {
            return Err(Unsupported::Integrator);
        };
        let survival = match settings.roulette {
            Roulette::None => 1.0,
            Roulette::Fixed(probability) => probability,
            Roulette::Throughput => return Err(Unsupported::Roulette),
        };
        let depth = settings.depth.filter(|depth| *depth <= PaperTracer::MAX_BOUNCES);
        let depth = depth.ok_or(Unsupported::Depth)?;
        let (shadows, pixel) = (Cells::new(shadow_samples), Cells::new(settings.spp));
        Ok(Self { survival, depth, shadows, pixel })
    }
}

impl Worker<'_> {
    /// Returns whether a mirrored ray survives roulette.
    fn survives(&mut self) -> bool {
        self.plan.survival >= 1.0 || self.random.unit() < self.plan.survival
    }
}

impl PaperTracer {
    /// Renders with the threads of the current rayon pool.
    ///
    /// # Errors
    /// A setting is out of range, or asks for another integrator, for roulette by throughput, or for
    /// more than [`PaperTracer::MAX_BOUNCES`] bounces.
    pub fn render(&self, settings: &Settings, threading: Threading) -> Result<Render, Unsupported> {
        let plan = Plan::new(settings)?;
        let start = Instant::now();
        let (pixels, rays) = match threading {
            Threading::Critical => self.render_with_locks(&plan, settings.seed),
            Threading::Independent => self.render_independently(&plan, settings.seed),
        };
        let image = Image { width: self.camera.width, height: self.camera.height, pixels };
        Ok(Render { image, rays, elapsed: start.elapsed() })
    }

    /// Returns all pixels and the number of rays, with [`Threading::Independent`].
    fn render_independently(&self, plan: &Plan, seed: u64) -> (Vec<[f32; 3]>, u64) {
        let width = self.camera.width as usize;
        let mut pixels = vec![[0.0; 3]; width * self.camera.height as usize];
        let row = |(y, row): (usize, &mut [[f32; 3]])| {
            let random = Random::Own(Random::sequence(stream(seed, y as u64)));
            let mut worker = Worker { plan, random, rays: 0 };
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = self.pixel([x as f64, y as f64], &mut worker);
            }
            worker.rays
        };
        let rays = pixels.par_chunks_mut(width).enumerate().map(row).sum();
        (pixels, rays)
    }

    /// Returns all pixels and the number of rays, with [`Threading::Critical`].
    fn render_with_locks(&self, plan: &Plan, seed: u64) -> (Vec<[f32; 3]>, u64) {
        let (width, height) = (self.camera.width as usize, self.camera.height as usize);
        let (sequence, finished) = (Mutex::new(Random::sequence(seed)), Mutex::new(Vec::new()));
        let row = |y: usize| {
            let mut worker = Worker { plan, random: Random::Shared(&sequence), rays: 0 };
            for x in 0..width {
                let pixel = self.pixel([x as f64, y as f64], &mut worker);
                lock(&finished).push((y * width + x, pixel));
            }
            worker.rays
        };
        let rays = (0..height).into_par_iter().map(row).sum();
        let mut pixels = vec![[0.0; 3]; width * height];
        lock(&finished).drain(..).for_each(|(index, pixel)| pixels[index] = pixel);
        (pixels, rays)
    }

    /// Returns the mean of a pixel's samples.
    fn pixel(&self, corner: [f64; 2], worker: &mut Worker) -> [f32; 3] {
        let (cells, mut sum) = (&worker.plan.pixel, DVec3::ZERO);
        for index in 0..cells.count() {
            let [x, y] = cells.jitter(index, &mut worker.random);
            let lens = self.camera.has_lens().then(|| {
                let (radius, turn) = (worker.random.unit().sqrt(), worker.random.unit());
                (DVec2::from_angle(TAU * turn) * radius).to_array()
            });
            let (origin, direction) = self.camera.rays([corner[0] + x, corner[1] + y], lens);
            let vector = |v: Vec3<f64>| DVec3::new(v.x, v.y, v.z);
            let origin = self.transform.user_point(vector(origin));
            let ray = Ray { origin, direction: vector(direction) };
            sum += self.radiance(&ray, worker.plan.depth, worker);
        }
        (sum / f64::from(cells.count())).as_vec3().to_array()
    }

    /// Returns the radiance along a ray, with at most `depth` bounces.
    fn radiance(&self, ray: &Ray, depth: u32, worker: &mut Worker) -> DVec3 {
        worker.rays += 1;
        let Some(hit) = self.closest(ray.origin, ray.direction) else {
            return self.background(ray.direction);
        };
        let point = ray.origin + ray.direction * hit.t;
        let (surface, normal) = self.surface(hit.primitive, point);
        let mut light = surface.emitted;
        if depth == 0 {
            return light;
        }
        let cosine = normal.dot(ray.direction);
        if surface.diffuse != DVec3::ZERO {
            let facing = if cosine > 0.0 { -normal } else { normal };
            let (random, rays) = (&mut worker.random, &mut worker.rays);
            let incident = self.direct_light(point, facing, &worker.plan.shadows, random, rays);
            light += surface.diffuse * incident;
        }
        if surface.mirror != DVec3::ZERO && worker.survives() {
            let direction = (ray.direction - normal * (2.0 * cosine)).normalize();
            let mirrored = self.radiance(&Ray { origin: point, direction }, depth - 1, worker);
            light += surface.mirror * mirrored / worker.plan.survival;
        }
        light
    }
}
