//! Smooth glass, nested and overlapping.
//!
//! A point inside several glass spheres is in the smallest of them (of equals, the one that comes
//! first in the scene): the rule of priorities of Schmidt and Budge, "Simple Nested Dielectrics in
//! Ray Traced Images", Journal of Graphics Tools 2002, with the radius as the priority, since what
//! is nested is smaller. It depends on the point alone, not on the path that led there. An
//! interface that lies inside a smaller sphere is not there.

use super::fresnel;
use crate::ray::MISS;
use crate::world::World;
use glam::DVec3;

/// The glass spheres that a path is in, as rows, in any order; [`MISS`] marks a free place.
pub type Inside<'a> = &'a mut [u32];

/// What glass does to a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Where the ray goes on: a unit vector.
    pub direction: DVec3,
    /// Whether it goes on inside the sphere.
    pub inward: bool,
    /// Whether the interface was there: if not, the ray went on as it came.
    pub real: bool,
}

/// Takes a ray through or back from the surface of glass sphere `row`, where the outward unit
/// normal is `normal`.
///
/// It is reflected with the probability of the share that is, so its weight does not change.
/// `inside` is what the ray was in before, and becomes what it is in after. Returns whether
/// `inside` overflowed as well.
pub fn pass(
    world: &World,
    row: u32,
    (direction, normal): (DVec3, DVec3),
    inside: Inside<'_>,
    choice: f32,
) -> (Passage, bool) {
    let direction = direction.normalize();
    let entering = direction.dot(normal) < 0.0;
    remove(inside, row);
    let around = innermost(world, inside);
    let real = around.is_none_or(|other| precedes(world, row, other));
    let mut passage = Passage { direction, inward: entering, real };
    if real {
        let (here, there) = (ior(world, row), around.map_or(1.0, |other| ior(world, other)));
        let eta = if entering { there / here } else { here / there };
        let facing = if entering { normal } else { -normal };
        let (direction, through) = refract(direction, facing, eta, f64::from(choice));
        passage.direction = direction;
        passage.inward = entering == through;
    }
    let overflow = passage.inward && !insert(world, inside, row);
    (passage, overflow)
}

/// Reflects or refracts at an interface with unit normal `facing`, against the ray. Returns whether
/// it went through.
fn refract(direction: DVec3, facing: DVec3, eta: f64, choice: f64) -> (DVec3, bool) {
    let cosine = (-direction.dot(facing)).clamp(0.0, 1.0);
    let (reflected, refracted) = fresnel::dielectric(cosine, eta);
    if choice < reflected {
        return ((direction + facing * (2.0 * cosine)).normalize(), false);
    }
    ((direction * eta + facing * (eta * cosine - refracted)).normalize(), true)
}

fn ior(world: &World, row: u32) -> f64 {
    let material = world.appearance.material.row(row as usize);
    f64::from(world.materials.dielectric[material.row()].ior)
}

/// Whether sphere `a` decides the medium where it overlaps sphere `b`.
fn precedes(world: &World, a: u32, b: u32) -> bool {
    let key = |row: u32| (world.spheres.radius(row as usize), world.spheres.id[row as usize]);
    key(a) < key(b)
}

/// The sphere whose glass a path is in.
fn innermost(world: &World, inside: &[u32]) -> Option<u32> {
    let filled = inside.iter().copied().filter(|&row| row != MISS);
    filled.reduce(|a, b| if precedes(world, a, b) { a } else { b })
}

fn remove(inside: Inside<'_>, row: u32) {
    if let Some(place) = inside.iter_mut().find(|place| **place == row) {
        *place = MISS;
    }
}

/// Adds a sphere. If there is no room, the one that matters least is forgotten, and the answer is
/// false.
pub fn insert(world: &World, inside: Inside<'_>, row: u32) -> bool {
    if let Some(free) = inside.iter_mut().find(|place| **place == MISS) {
        *free = row;
        return true;
    }
    let outermost = inside.iter_mut().reduce(|a, b| if precedes(world, *a, *b) { b } else { a });
    if let Some(outermost) = outermost
        && precedes(world, row, *outermost)
    {
        *outermost = row;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refraction_obeys_snell_and_keeps_to_the_plane() {
        let normal = DVec3::Z;
        for degrees in [1.0, 30.0, 60.0, 89.0] {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let direction = DVec3::new(sin, 0.0, -cos);
            // A choice of 1 never reflects, but for total reflection.
            let (refracted, through) = refract(direction, normal, 1.0 / 1.5, 1.0);
            assert!(through && refracted.y == 0.0 && refracted.z < 0.0);
            assert!((refracted.x * 1.5 - sin).abs() < 1e-14);
            let (reflected, through) = refract(direction, normal, 1.0 / 1.5, 0.0);
            assert!(!through && (reflected - DVec3::new(sin, 0.0, cos)).length() < 1e-14);
        }
        let grazing = DVec3::new(0.9, 0.0, -(1.0_f64 - 0.81).sqrt());
        assert!(!refract(grazing, normal, 1.5, 0.999_999).1, "total reflection");
    }
}
