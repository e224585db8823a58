//! Tests of beams against the rays that they must contain.

use crate::scene::{Camera as View, Lens, Material, NamedMaterial, Pose, Projection, Rgb, Scene};
use crate::world::World;
use glam::{DVec2, DVec3};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

struct Random(Xoshiro256PlusPlus);

impl Random {
    /// Returns a number in 0..1.
    fn number(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a point in the cube from -1 to 1.
    fn point(&mut self) -> DVec3 {
        DVec3::new(self.number(), self.number(), self.number()) * 2.0 - 1.0
    }
}

/// A few spheres about the origin, or over a very large one, with a random camera.
fn scene(random: &mut Random, case: u32) -> Scene {
    let mut scene = Scene::default();
    let material = Material::Lambertian { color: Rgb::ONE };
    scene.materials.push(NamedMaterial { name: String::new(), material });
    for _ in 0..=(4.0 * random.number()) as u32 {
        let (center, radius) = (random.point(), 0.3 * random.number());
        scene.spheres.push(center, radius, 0, Rgb::ONE);
    }
    if case.is_multiple_of(3) {
        let radius = 10f64.powf(4.0 * random.number());
        scene.spheres.push(DVec3::Y * (-1.0 - radius), radius, 0, Rgb::ONE);
    }
    let eye = random.point() * 10f64.powf(2.0 * random.number());
    let projection = match case % 2 {
        0 => Projection::Perspective { fov: 1.0 + 120.0 * random.number() },
        _ => Projection::Orthographic { height: Some(4.0 * random.number() + 0.1) },
    };
    let lens = (case % 5 < 2).then(|| Lens {
        aperture: random.number(),
        focus: Some(eye.length() * (0.5 + random.number())),
    });
    let near = if case % 4 == 3 { eye.length() * random.number() } else { 0.0 };
    let pose = Pose::LookAt { eye, target: random.point() };
    scene.camera = View { projection, pose, lens, near, ..View::default() };
    (scene.settings.width, scene.settings.height) = (64, 48);
    scene
}

/// Returns whether any of many rays through a rectangle of the picture hits a sphere.
fn is_hit(world: &World, random: &mut Random, low: DVec2, high: DVec2) -> bool {
    let lens = world.camera.has_lens();
    (0..400).any(|i| {
        let part = DVec2::new(random.number(), random.number());
        // Including corners and edges.
        let part = if i % 2 == 0 { part.round() } else { part };
        let point = low + (high - low) * part;
        let (radius, angle) = (random.number().sqrt(), std::f64::consts::TAU * random.number());
        let lens = lens.then_some([radius * angle.cos(), radius * angle.sin()]);
        let (origin, direction) = world.camera.rays([point.x, point.y], lens);
        let [origin, direction] = [origin, direction].map(|v| DVec3::new(v.x, v.y, v.z));
        (0..world.spheres.len()).any(|row| {
            let (center, radius) = world.spheres.exact(row);
            let toward = center - origin;
            let along = toward.dot(direction).max(0.0);
            (toward - direction * along).length() <= radius
        })
    })
}

#[test]
fn beams_contain_their_rays_and_little_else() {
    let mut random = Random(Xoshiro256PlusPlus::seed_from_u64(7));
    let (mut empty, mut found) = (0, 0);
    for case in 0..600 {
        let scene = scene(&mut random, case);
        let world = World::build(&scene).expect("a valid scene");
        for _ in 0..4 {
            let low = DVec2::new(64.0 * random.number(), 48.0 * random.number()).floor();
            let high = low + DVec2::splat(1.0 + 16.0 * random.number()).floor();
            let hit = is_hit(&world, &mut random, low, high);
            let may = world.bvh.may_be_hit(&world.spheres, &world.camera.beam(low, high));
            assert!(may || !hit, "{case}: {low} to {high} of {scene:?}");
            empty += u32::from(!hit);
            found += u32::from(!may);
        }
    }
    assert!(empty > 500, "{empty}");
    // Not all are culled: beams of wide lenses, and spheres off a corner.
    assert!(10 * found > 8 * empty, "{found} of {empty}");
}
