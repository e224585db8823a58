//! Rays that start on a surface: do they hit what they leave, do they find the way out?
//!
//! A renderer knows more than a ray: on which sphere it starts. The forms of single precision start
//! at the surface point, rounded, and test their sphere; Spherule does what its integrators do, in
//! a world of its own making: the sphere's row goes with the ray, and a ray that goes inside knows
//! its exit before it is traced.

use super::forms::{self, Form, Intersect};
use super::rays::Ray;
use super::report::RegimeReport;
use super::scenes::parts;
use crate::bvh::{Tracer, Traversal, Tree};
use crate::integrator::surface::chord_length;
use crate::ray::{Hits, MISS, Rays};
use crate::scene::{Material, NamedMaterial, Rgb, Scene};
use crate::world::World;
use glam::{DVec3, Vec3};
use spherule_core::internals::random::Random;

/// Least cosine between normal and direction: where rounding does not decide which is the outside.
const LEAST_COSINE: f64 = 0.05;

/// A ray from a surface.
struct Start {
    /// Row in the scene; of equal spheres the first.
    sphere: usize,
    /// Outward unit normal.
    normal: DVec3,
    /// Unit length but for rounding.
    direction: Vec3,
    inward: bool,
}

/// Counts what becomes of rays from surfaces: `pairs` that go outward and as many that go inward.
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
            start.judge(t, start.exit(spheres[start.sphere]), report, form);
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
        // A sphere that is too small for the world's single precision is not there.
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
        // Something else within is a right answer, too.
        let nearer = start.inward && hit != MISS && !is_own && hits.t[row] <= exit;
        if !nearer {
            start.judge(is_own.then(|| hits.t[row]), exit, report, Form::Spherule);
        }
    }
}

impl Start {
    fn new(spheres: &[[f32; 4]], inward: bool, random: &mut Random) -> Self {
        let chosen = spheres[random.index(spheres.len())];
        let sphere = spheres.iter().position(|row| *row == chosen).unwrap_or(0);
        let normal = random.direction();
        let cosine = random.between([LEAST_COSINE, 1.0]);
        let across = random.perpendicular(normal) * (1.0 - cosine * cosine).sqrt();
        let along = normal * if inward { -cosine } else { cosine };
        Self { sphere, normal, direction: (across + along).as_vec3(), inward }
    }

    /// The distance to the far side, if the ray goes inward.
    fn exit(&self, sphere: [f32; 4]) -> f64 {
        let (_, radius) = parts(sphere);
        let direction = self.direction.as_dvec3();
        -2.0 * radius * self.normal.dot(direction) / direction.length_squared()
    }

    /// Where the ray hits its own sphere, says a form of single precision.
    fn trace(&self, form: Intersect, sphere: [f32; 4]) -> Option<f64> {
        let (center, radius) = parts(sphere);
        let origin = (center + self.normal * radius).as_vec3().to_array();
        let ray = Ray { origin, direction: self.direction.to_array() };
        form(&ray, sphere).map(|hit| f64::from(hit.0))
    }

    /// Counts what is wrong with a hit of the ray's own sphere, or with none.
    fn judge(&self, t: Option<f64>, exit: f64, report: &mut RegimeReport, form: Form) {
        let form = report.form_mut(form);
        if self.inward {
            let found = t.is_some_and(|t| t >= 0.5 * exit && t <= 2.0 * exit);
            form.missed_exits += u64::from(!found);
        } else {
            form.self_hits += u64::from(t.is_some());
        }
    }
}

/// The world that a renderer would make of some spheres.
fn world(spheres: &[[f32; 4]]) -> Option<World> {
    let mut scene = Scene::default();
    let material = Material::Lambertian { color: Rgb::ONE };
    scene.materials.push(NamedMaterial { name: String::new(), material });
    for &sphere in spheres {
        let (center, radius) = parts(sphere);
        scene.spheres.push(center, radius, 0, Rgb::ONE);
    }
    World::build(&scene).ok()
}
