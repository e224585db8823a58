//! Random rays by a recipe.

use super::scenes::{
    Aim, LEAST, NORMALS, Origin, Recipe, TANGENTS, above, axis, center_and_radius,
};
use glam::{DVec3, Vec3};
use spherule_core::internals::elementary::power_of_two;
use spherule_core::internals::random::{Random, direction_past};
use spherule_render::query::RayColumns;

/// A ray, of exact single-precision numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Origin.
    pub origin: [f32; 3],
    /// Direction, of any nonzero length.
    pub direction: [f32; 3],
}

/// Rays as columns.
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

/// Returns a random ray by a recipe, toward a scene of the same recipe.
pub(super) fn ray(recipe: &Recipe, spheres: &[[f32; 4]], random: &mut Random) -> Ray {
    let (target, radius) = center_and_radius(spheres[random.index(spheres.len())]);
    let length = random.between([0.5, 1.0]) * random.decades(recipe.length);
    let (origin, direction) = match recipe.aim {
        Aim::AxisTangent => axis_tangent(target, radius, random),
        // Exact in single precision.
        Aim::NearOrigin(decades) => perturbed(target, decades, random),
        Aim::Ends => toward_least(&spheres[1..], random),
        aim => {
            let origin = start(recipe, target, radius, spheres, random);
            // Rounded as in the result.
            let origin = origin.as_vec3().as_dvec3();
            (origin, direction(aim, origin, spheres, target, radius, random) * length)
        }
    };
    Ray { origin: origin.as_vec3().to_array(), direction: direction.as_vec3().to_array() }
}

fn start(
    recipe: &Recipe,
    center: DVec3,
    radius: f64,
    spheres: &[[f32; 4]],
    random: &mut Random,
) -> DVec3 {
    let (giant, giant_radius) = center_and_radius(spheres[0]);
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
    center: DVec3,
    radius: f64,
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
            let ((first, near), (second, _)) =
                (center_and_radius(spheres[at]), center_and_radius(spheres[at + 1]));
            let contact = first + (second - first).normalize() * near;
            direction_past(contact - origin, near * random.decades([-9.0, -2.0]), random)
        }
        Aim::Sphere | Aim::Contact => direction_past(toward, radius * within(random), random),
        Aim::AxisTangent | Aim::NearOrigin(_) | Aim::Ends | Aim::Anywhere => random.direction(),
    }
}

/// Returns a ray along an axis that is exactly a tangent, or off by one unit in the last place to either
/// side.
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

/// Returns a ray that is a tangent to one of the spheres, exactly or off by [`LEAST`], or that passes near its
/// limb. Spheres are those of [`Arrangement::Ends`](super::scenes::Arrangement::Ends), the large one excluded.
fn toward_least(spheres: &[[f32; 4]], random: &mut Random) -> (DVec3, DVec3) {
    let (center, radius) = center_and_radius(spheres[random.index(spheres.len())]);
    // A power of two and so many other digits that quotients and roots are rounded.
    let digits = (1 + 2 * random.index(1 << 19)) as f64;
    let length = digits * power_of_two(random.index(200) as i32 - 120);
    let divides = |&(_, _, length): &(DVec3, DVec3, f64)| radius % (length * LEAST) == 0.0;
    let tangent = TANGENTS.into_iter().find(divides).filter(|_| random.coin());
    let Some((direction, normal, unit)) = tangent else {
        let origin = center + (random.in_cube() * 400.0).round() * LEAST;
        let aside = radius * (1.0 + random.sign() * random.decades([-9.0, 0.0]));
        return (origin, direction_past(center - origin, aside, random) * length);
    };
    let step = axis(random) * (LEAST * random.index(2) as f64);
    let back = direction * (LEAST * random.index(100) as f64);
    (center + normal * (radius / unit) - back + step, direction * length)
}

/// Returns a ray through the origin of coordinates, perturbed slightly along axes where its direction has
/// no component. In the plane of a pencil it is nearly a tangent; across the plane, all spheres on the
/// far side are nearly at the same distance. Products and sums are rounded.
fn perturbed(target: DVec3, decades: [f64; 2], random: &mut Random) -> (DVec3, DVec3) {
    /// Few enough bits that small multiples are exact in single precision.
    const STEPS: f64 = (1 << 16) as f64;
    let (normal, _) = NORMALS[usize::from(target.x != 0.0)];
    let steps = (random.in_cube() * STEPS).round() / STEPS;
    let across = steps * DVec3::from([(); 3].map(|()| random.index(3).min(1) as f64));
    let direction = if random.coin() { steps.cross(normal) } else { across };
    let direction = if direction == DVec3::ZERO { axis(random) } else { direction };
    // Their quotient is the distance, which is rounded.
    let [multiple, length] = [(); 2].map(|()| (1 + random.index(16)) as f64);
    let origin = direction.to_array().map(|component| {
        let perturbation = random.sign() * random.decades(decades);
        let unperturbed = component != 0.0 || random.coin();
        if unperturbed { -multiple * component } else { perturbation }
    });
    (DVec3::from(origin), direction * length)
}

/// Change of one coordinate.
trait MapAlong {
    /// Returns the point with the coordinate along `axis` changed.
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
