//! Tests of rays that start on a surface: self-intersection, and missed exits.
//!
//! A renderer knows on which sphere a ray starts. The single-precision tests start at the rounded
//! surface point and test their own sphere. Spherule does what its integrators do, in a world built from
//! the scene: rays carry the sphere's row, and the exit of a ray that points inward is computed before
//! traversal.

use super::forms::{self, Form, Intersect};
use super::rays::Ray;
use super::report::RegimeReport;
use super::scenes::center_and_radius;
use glam::{DVec3, Vec3};
use spherule_core::internals::random::Random;
use spherule_render::bvh::{Tracer, Traversal, Tree};
use spherule_render::integrator::surface::chord_length;
use spherule_render::ray::{Hits, MISS, Rays};
use spherule_render::scene::{Material, NamedMaterial, Rgb, Scene};
use spherule_render::world::World;

/// Minimum cosine between normal and direction, so that rounding does not decide which side is outside.
const MIN_COSINE: f64 = 0.05;

/// A ray from a surface.
struct Start {
    /// Row in the scene; of equal spheres the first.
    sphere: usize,
    /// Outward unit normal.
    normal: DVec3,
    /// A unit vector up to rounding.
    direction: Vec3,
    inward: bool,
}

/// Counts wrong hits of rays from surfaces: `pairs` that point outward and as many that point inward.
pub(super) fn count(
    spheres: &[[f32; 4]],
    pairs: usize,
    random: &mut Random,
    report: &mut RegimeReport,
) {
    let Some(world) = world(spheres) else { return };
    let starts: Vec<Start> =
        (0..2 * pairs).map(|i| Start::new(spheres, i % 2 == 1, random)).collect();
    for start in &starts {
        *(if start.inward { &mut report.entering } else { &mut report.leaving }) += 1;
        let singles: [(Form, Intersect); 3] = [
            (Form::Naive, forms::naive),
            (Form::NaiveOffset, forms::naive_offset),
            (Form::Good, forms::good),
        ];
        for (form, intersect) in singles {
            let t = start.trace(intersect, spheres[start.sphere]);
            start.count_error(t, start.exit(spheres[start.sphere]), report, form);
        }
    }
    count_spherule(&world, &starts, report);
}

fn count_spherule(world: &World, starts: &[Start], report: &mut RegimeReport) {
    let mut rays = Rays::with_capacity(starts.len());
    let mut hits = Hits::with_capacity(starts.len());
    let mut traced = Vec::with_capacity(starts.len());
    for start in starts {
        let ids = &world.spheres.id;
        // The world omits spheres that are too small for single precision.
        let Some(own) = ids.iter().position(|&id| id as usize == start.sphere) else { continue };
        let (center, radius) = world.spheres.exact(own);
        let point = (center + start.normal * radius).as_vec3();
        let exit = chord_length(start.normal.into(), radius, start.direction.as_dvec3().into());
        let (t, hit) = if start.inward { (exit, own as u32) } else { (f64::INFINITY, MISS) };
        hits.set(rays.len(), t, hit);
        rays.push(point, start.direction, own as u32);
        traced.push((start, own, exit));
    }
    let tracer = Tracer { traversal: Traversal::Packet, ..Tracer::default() };
    tracer.closest(Tree { bvh: &world.bvh, spheres: &world.spheres }, &rays, &mut hits);
    for (row, (start, own, exit)) in traced.into_iter().enumerate() {
        let hit = hits.sphere[row];
        let is_own = hit != MISS && world.spheres.exact(hit as usize) == world.spheres.exact(own);
        // A hit of another sphere inside is correct, too.
        let nearer = start.inward && hit != MISS && !is_own && hits.t[row] <= exit;
        if !nearer {
            start.count_error(is_own.then(|| hits.t[row]), exit, report, Form::Spherule);
        }
    }
}

impl Start {
    fn new(spheres: &[[f32; 4]], inward: bool, random: &mut Random) -> Self {
        let chosen = spheres[random.index(spheres.len())];
        let sphere = spheres.iter().position(|row| *row == chosen).unwrap_or(0);
        let normal = random.direction();
        let cosine = random.between([MIN_COSINE, 1.0]);
        let across = random.perpendicular(normal) * (1.0 - cosine * cosine).sqrt();
        let along = normal * if inward { -cosine } else { cosine };
        Self { sphere, normal, direction: (across + along).as_vec3(), inward }
    }

    /// Returns the distance to the far side, for a ray that points inward.
    fn exit(&self, sphere: [f32; 4]) -> f64 {
        let (_, radius) = center_and_radius(sphere);
        let direction = self.direction.as_dvec3();
        -2.0 * radius * self.normal.dot(direction) / direction.length_squared()
    }

    /// Intersects the ray with its own sphere, by a single-precision test.
    fn trace(&self, form: Intersect, sphere: [f32; 4]) -> Option<f64> {
        let (center, radius) = center_and_radius(sphere);
        let origin = (center + self.normal * radius).as_vec3().to_array();
        let ray = Ray { origin, direction: self.direction.to_array() };
        form(&ray, sphere).map(|hit| f64::from(hit.0))
    }

    /// Counts a wrong hit or miss of the ray's own sphere.
    fn count_error(&self, t: Option<f64>, exit: f64, report: &mut RegimeReport, form: Form) {
        let form = report.form_mut(form);
        if self.inward {
            let found = t.is_some_and(|t| t >= 0.5 * exit && t <= 2.0 * exit);
            form.missed_exits += u64::from(!found);
        } else {
            form.self_hits += u64::from(t.is_some());
        }
    }
}

/// Builds the renderer's world of some spheres.
fn world(spheres: &[[f32; 4]]) -> Option<World> {
    let mut scene = Scene::default();
    let material = Material::Lambertian { color: Rgb::ONE };
    scene.materials.push(NamedMaterial { name: String::new(), material });
    for &sphere in spheres {
        let (center, radius) = center_and_radius(sphere);
        scene.spheres.push(center, radius, 0, Rgb::ONE);
    }
    World::build(&scene).ok()
}
