//! Random rays after a recipe.

use super::scenes::{Aim, NORMALS, Origin, Recipe, above, axis, parts};
use crate::query::RayColumns;
use glam::{DVec3, Vec3};
use spherule_core::internals::random::{Random, direction_past};

/// A ray: single-precision numbers, taken exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: [f32; 3],
    /// Where it goes, of any length but 0.
    pub direction: [f32; 3],
}

/// Rays in columns.
pub(super) struct Columns {
    origin: [Vec<f32>; 3],
    direction: [Vec<f32>; 3],
}

impl Columns {
    pub(super) fn new(rays: &[Ray]) -> Self {
        let column = |of: &dyn Fn(&Ray) -> f32| rays.iter().map(of).collect();
        Self {
            origin: std::array::from_fn(|i| column(&|ray| ray.origin[i])),
            direction: std::array::from_fn(|i| column(&|ray| ray.direction[i])),
        }
    }

    pub(super) fn view(&self) -> RayColumns<'_> {
        RayColumns {
            origin: self.origin.each_ref().map(Vec::as_slice),
            direction: self.direction.each_ref().map(Vec::as_slice),
        }
    }
}

/// A ray after a recipe, toward a scene of it.
pub(super) fn ray(recipe: &Recipe, spheres: &[[f32; 4]], random: &mut Random) -> Ray {
    let (target, radius) = parts(spheres[random.index(spheres.len())]);
    let length = random.between([0.5, 1.0]) * random.decades(recipe.length);
    let (origin, direction) = match recipe.aim {
        Aim::AxisTangent => axis_tangent(target, radius, random),
        // Exact as it is.
        Aim::Hair(decades) => hair(target, decades, random),
        aim => {
            let origin = start(recipe, (target, radius), spheres, random);
            // As it will be.
            let origin = origin.as_vec3().as_dvec3();
            (origin, direction(aim, origin, spheres, (target, radius), random) * length)
        }
    };
    Ray { origin: origin.as_vec3().to_array(), direction: direction.as_vec3().to_array() }
}

fn start(
    recipe: &Recipe,
    (center, radius): (DVec3, f64),
    spheres: &[[f32; 4]],
    random: &mut Random,
) -> DVec3 {
    let (giant, giant_radius) = parts(spheres[0]);
    match recipe.origin {
        Origin::Away(decades) => center + random.direction() * (radius * random.decades(decades)),
        Origin::Zero => DVec3::ZERO,
        Origin::Inside => center + random.direction() * (radius * random.unit()),
        Origin::Surface => center + random.direction() * radius,
        Origin::Above(decades) => {
            giant + above(giant, random) * (giant_radius + random.decades(decades))
        }
        Origin::Ground => giant + above(giant, random) * giant_radius,
        Origin::Somewhere(decades) => random.direction() * random.decades(decades),
    }
}

fn direction(
    aim: Aim,
    origin: DVec3,
    spheres: &[[f32; 4]],
    (center, radius): (DVec3, f64),
    random: &mut Random,
) -> DVec3 {
    let toward = center - origin;
    let within = |random: &mut Random| 1.2 * random.unit().sqrt();
    let beside = |decades, random: &mut Random| 1.0 + random.sign() * random.decades(decades);
    match aim {
        Aim::Tangent(decades) => direction_past(toward, radius * beside(decades, random), random),
        Aim::SphereOrTangent if random.coin() => {
            direction_past(toward, radius * within(random), random)
        }
        Aim::SphereOrTangent => {
            direction_past(toward, radius * beside([-8.0, -1.0], random), random)
        }
        Aim::Away => -direction_past(toward, radius * within(random), random),
        Aim::Contact if spheres.len() > 1 && random.coin() => {
            let at = random.index(spheres.len() - 1);
            let ((first, near), (second, _)) = (parts(spheres[at]), parts(spheres[at + 1]));
            let contact = first + (second - first).normalize() * near;
            direction_past(contact - origin, near * random.decades([-9.0, -2.0]), random)
        }
        Aim::Sphere | Aim::Contact => direction_past(toward, radius * within(random), random),
        Aim::AxisTangent | Aim::Hair(_) | Aim::Anywhere => random.direction(),
    }
}

/// A ray along an axis that is a tangent exactly, or misses by one unit in the last place, or is
/// within by one.
fn axis_tangent(center: DVec3, radius: f64, random: &mut Random) -> (DVec3, DVec3) {
    let first = random.index(3);
    let (along, aside) = (DVec3::AXES[first], DVec3::AXES[(first + 1 + random.index(2)) % 3]);
    let touch = (center + aside * (random.sign() * radius)).as_vec3();
    let touch = match random.index(3) {
        0 => touch,
        1 => touch.map_along(aside, f32::next_up),
        _ => touch.map_along(aside, f32::next_down),
    };
    let direction = along * random.sign();
    (touch.as_dvec3() - direction * (1.0 + random.index(64) as f64 / 16.0), direction)
}

/// A ray through the origin of coordinates exactly, but for a hair where its direction has no
/// component. In the plane of a pencil that is a tangent by a hair, across it all spheres on the far
/// side are equally far; and products and sums round.
fn hair(target: DVec3, decades: [f64; 2], random: &mut Random) -> (DVec3, DVec3) {
    /// Few enough bits for small multiples to fit single precision.
    const STEPS: f64 = (1 << 16) as f64;
    let (normal, _) = NORMALS[usize::from(target.x != 0.0)];
    let steps = (random.in_cube() * STEPS).round() / STEPS;
    let across = steps * DVec3::from([(); 3].map(|()| random.index(3).min(1) as f64));
    let direction = if random.coin() { steps.cross(normal) } else { across };
    let direction = if direction == DVec3::ZERO { axis(random) } else { direction };
    // Their quotient is the distance, and rounds.
    let [multiple, length] = [(); 2].map(|()| (1 + random.index(16)) as f64);
    let origin = direction.to_array().map(|component| {
        let hair = random.sign() * random.decades(decades);
        let none = component != 0.0 || random.coin();
        if none { -multiple * component } else { hair }
    });
    (DVec3::from(origin), direction * length)
}

/// Changing one coordinate.
trait MapAlong {
    /// The point with the coordinate along `axis` changed.
    fn map_along(self, axis: DVec3, change: impl Fn(f32) -> f32) -> Self;
}

impl MapAlong for Vec3 {
    fn map_along(mut self, axis: DVec3, change: impl Fn(f32) -> f32) -> Self {
        for i in 0..3 {
            if axis[i] != 0.0 {
                self[i] = change(self[i]);
            }
        }
        self
    }
}
