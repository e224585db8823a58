//! Pixels, and the threads that make them.

use super::random::{Cells, Random, lock};
use super::shape::Ray;
use super::{Tracer, Unsupported};
use crate::image::Image;
use crate::sampling::stream;
use crate::scene::{Integrator, Roulette, Settings};
use crate::vec3::Vec3;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// What threads have in common while they work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Threading {
    /// As in the paper: one sequence of random numbers and one list of finished pixels, each of
    /// which one thread may use at a time. With more than one thread, no two pictures are the same.
    Critical,
    /// Every row of the picture has its own sequence and its own place: nothing is in common.
    Independent,
}

/// A finished picture.
#[derive(Clone, Debug)]
pub struct Render {
    /// Mean radiance of each pixel.
    pub image: Image,
    /// Rays traced, of every kind.
    pub rays: u64,
    /// Time that it took.
    pub elapsed: Duration,
}

/// How pictures are made.
struct Plan {
    /// Probability with which a mirrored ray goes on.
    survival: f64,
    /// Most scatterings of a path.
    depth: u32,
    /// One sample at each light for each of these.
    shadows: Cells,
    /// One sample in each pixel for each of these.
    pixel: Cells,
}

/// One thread's work.
struct Worker<'a> {
    plan: &'a Plan,
    random: Random<'a>,
    rays: u64,
}

impl Plan {
    fn of(settings: &Settings) -> Result<Self, Unsupported> {
        settings.check()?;
        let Integrator::Whitted { shadow_samples } = settings.integrator else {
            return Err(Unsupported::Integrator);
        };
        let survival = match settings.roulette {
            Roulette::None => 1.0,
            Roulette::Fixed(probability) => probability,
            Roulette::Throughput => return Err(Unsupported::Roulette),
        };
        let depth = settings.depth.filter(|depth| *depth <= Tracer::MOST_BOUNCES);
        let depth = depth.ok_or(Unsupported::Depth)?;
        let (shadows, pixel) = (Cells::new(shadow_samples), Cells::new(settings.spp));
        Ok(Self { survival, depth, shadows, pixel })
    }
}

impl Worker<'_> {
    /// Whether a mirrored ray goes on.
    fn survives(&mut self) -> bool {
        self.plan.survival >= 1.0 || self.random.unit() < self.plan.survival
    }
}

impl Tracer {
    /// Renders with the threads of the current rayon pool.
    ///
    /// # Errors
    /// A setting is out of its range; the settings ask for another integrator, for roulette by throughput, or for more than
    /// [`Tracer::MOST_BOUNCES`] bounces.
    pub fn render(&self, settings: &Settings, threading: Threading) -> Result<Render, Unsupported> {
        let plan = Plan::of(settings)?;
        let start = Instant::now();
        let (pixels, rays) = match threading {
            Threading::Critical => self.in_critical_sections(&plan, settings.seed),
            Threading::Independent => self.independently(&plan, settings.seed),
        };
        let image = Image { width: self.camera.width, height: self.camera.height, pixels };
        Ok(Render { image, rays, elapsed: start.elapsed() })
    }

    /// All pixels, and the number of rays.
    fn independently(&self, plan: &Plan, seed: u64) -> (Vec<[f32; 3]>, u64) {
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

    /// The same, as in the paper.
    fn in_critical_sections(&self, plan: &Plan, seed: u64) -> (Vec<[f32; 3]>, u64) {
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

    /// The mean of a pixel's samples.
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
            let origin = vector(origin) / self.frame.scale + self.frame.shift;
            let ray = Ray { origin, direction: vector(direction) };
            sum += self.radiance(&ray, worker.plan.depth, worker);
        }
        (sum / f64::from(cells.count())).as_vec3().to_array()
    }

    /// Light that comes along a ray, by at most `depth` scatterings.
    fn radiance(&self, ray: &Ray, depth: u32, worker: &mut Worker) -> DVec3 {
        worker.rays += 1;
        let Some(hit) = self.closest(ray.origin, ray.direction) else {
            return self.background(ray.direction);
        };
        let point = ray.origin + ray.direction * hit.t;
        let (surface, normal) = self.surface(hit.what, point);
        let mut light = surface.emitted;
        if depth == 0 {
            return light;
        }
        let cosine = normal.dot(ray.direction);
        if surface.diffuse != DVec3::ZERO {
            let facing = if cosine > 0.0 { -normal } else { normal };
            let (random, rays) = (&mut worker.random, &mut worker.rays);
            let arriving = self.direct((point, facing), &worker.plan.shadows, random, rays);
            light += surface.diffuse * arriving;
        }
        if surface.mirror != DVec3::ZERO && worker.survives() {
            let direction = (ray.direction - normal * (2.0 * cosine)).normalize();
            let mirrored = self.radiance(&Ray { origin: point, direction }, depth - 1, worker);
            light += surface.mirror * mirrored / worker.plan.survival;
        }
        light
    }
}
