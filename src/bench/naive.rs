//! A renderer as it is usually written first, to measure what its random numbers cost: each sample
//! follows one path, each number is asked for on its own. Every surface is gray and the sky is
//! white.

use crate::bvh::walk::Method;
use crate::image::Image;
use crate::ray::{GROUND, Hits, MISS, Rays};
use crate::trace::{Tracer, Width};
use crate::world::World;
use glam::{DVec3, Vec3};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Where random numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// A generator for each row of the picture.
    Own,
    /// One generator for all threads, behind a lock: the paper's way.
    Locked,
}

const SEED: u64 = 1;

/// Most segments of a path.
const DEPTH: u32 = 8;

/// What a surface reflects.
const ALBEDO: f64 = 0.7;

/// A generator of numbers in 0..1.
trait Generator {
    fn bits(&mut self) -> u64;

    fn number(&mut self) -> f64 {
        // The upper 53 bits: what double precision holds.
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl Generator for Xoshiro256PlusPlus {
    fn bits(&mut self) -> u64 {
        self.next_u64()
    }
}

impl Generator for &Mutex<Xoshiro256PlusPlus> {
    fn bits(&mut self) -> u64 {
        // Nobody panics with the lock in hand.
        self.lock().unwrap_or_else(PoisonError::into_inner).next_u64()
    }
}

/// Renders on the threads of the current pool, row by row. With a generator for each row the picture
/// is the same on any number of threads; with one for all it is another each time.
pub fn render(world: &World, spp: u32, numbers: Numbers) -> Image {
    let shared = Mutex::new(Xoshiro256PlusPlus::seed_from_u64(SEED));
    let row = |y: u32| match numbers {
        Numbers::Own => {
            let seed = SEED.wrapping_add(u64::from(y) << 32);
            row(world, (y, spp), &mut Xoshiro256PlusPlus::seed_from_u64(seed))
        }
        Numbers::Locked => row(world, (y, spp), &mut &shared),
    };
    let (width, height) = (world.camera.width, world.camera.height);
    let rows: Vec<_> = (0..height).into_par_iter().map(row).collect();
    Image { width, height, pixels: rows.concat() }
}

fn row(world: &World, (y, spp): (u32, u32), numbers: &mut impl Generator) -> Vec<[f32; 3]> {
    let mut rays = (Rays::with_capacity(1), Hits::with_capacity(1));
    let pixel = |x: u32| {
        let samples = (0..spp).map(|_| path(world, (x, y), numbers, &mut rays));
        [(samples.sum::<f64>() / f64::from(spp)) as f32; 3]
    };
    (0..world.camera.width).map(pixel).collect()
}

/// The light that a path through a pixel finds.
fn path(
    world: &World,
    (x, y): (u32, u32),
    numbers: &mut impl Generator,
    (rays, hits): &mut (Rays, Hits),
) -> f64 {
    let tracer = Tracer { method: Method::Single, width: Width::One };
    let at = [f64::from(x) + numbers.number(), f64::from(y) + numbers.number()];
    let (from, toward) = world.camera.rays(at, None);
    let (mut origin, mut direction) = (
        Vec3::new(from.x as f32, from.y as f32, from.z as f32),
        Vec3::new(toward.x as f32, toward.y as f32, toward.z as f32),
    );
    let (mut own, mut light) = (MISS, 1.0);
    for _ in 0..DEPTH {
        rays.truncate(0);
        rays.push(origin, direction, own);
        hits.set(0, f64::INFINITY, MISS);
        tracer.closest(world, rays, hits);
        own = hits.sphere[0];
        if own == MISS {
            return light;
        }
        let (point, outward) = surface(world, rays, hits);
        let facing = if outward.dot(direction.as_dvec3()) > 0.0 { -outward } else { outward };
        origin = point.as_vec3();
        direction = (facing + unit(numbers)).normalize_or(facing).as_vec3();
        light *= ALBEDO;
    }
    0.0
}

/// Where the ray hits, and the normal there.
fn surface(world: &World, rays: &Rays, hits: &Hits) -> (DVec3, DVec3) {
    let (ray, hit) = (rays.exact(0), hits.sphere[0]);
    if hit == GROUND {
        return (ray.at(hits.t[0]), world.ground.map_or(DVec3::Z, |ground| ground.normal));
    }
    let (center, radius) = world.spheres.exact(hit as usize);
    let normal = ray.at_from(center, hits.t[0]).normalize();
    (center + normal * radius, normal)
}

/// A direction, by throwing points into a cube until one is in the ball: the paper's way.
fn unit(numbers: &mut impl Generator) -> DVec3 {
    loop {
        let mut coordinate = || 2.0 * numbers.number() - 1.0;
        let point = DVec3::new(coordinate(), coordinate(), coordinate());
        if (1e-6..=1.0).contains(&point.length_squared()) {
            return point.normalize();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::scenes::{FIELD, NamedScene};
    use crate::image::compare;

    #[test]
    fn both_ways_lead_to_the_same_light() {
        let world = NamedScene::named(FIELD).unwrap().resized(48).world().unwrap();
        let own = render(&world, 8, Numbers::Own);
        assert_eq!(own, render(&world, 8, Numbers::Own));
        let locked = render(&world, 8, Numbers::Locked);
        let found = compare(&locked, &own).unwrap();
        assert!(found.rmse > 0.0 && found.bias.abs() < 5.0 * found.bias_standard_error);
        // The upper edge shows nothing but the sky.
        assert_eq!(own.pixels[0], [1.0; 3]);
        assert!(own.pixels.iter().any(|pixel| pixel[0] < 0.7));
    }
}
