//! Interior lists: which glass spheres contain a path, nested or overlapping.
//!
//! A point inside several glass spheres is in the smallest of them (of equals, the first in the scene):
//! the rule of priorities of Schmidt and Budge, "Simple Nested Dielectrics in Ray Traced Images",
//! Journal of Graphics Tools 2002, with the radius as the priority, since nested spheres are smaller.
//! The medium depends on the point alone, not on the path that led there. An interface inside a smaller
//! sphere does not exist.

use crate::ray::MISS;
use crate::world::World;

/// An interior list: the glass spheres that contain a path, as rows in any order; [`MISS`] marks a free
/// slot.
pub(super) type InteriorList<'a> = &'a mut [u32];

/// Returns the index of refraction of glass sphere `row`.
#[inline(always)]
pub(super) fn ior(world: &World, row: u32) -> f32 {
    let material = world.appearance.material.row(row as usize);
    world.materials.dielectric[material.row()].ior
}

/// Returns the index of refraction outside of glass sphere `row` where a ray meets it, as
/// [`Interface::ior_outside`](crate::shade::dielectric::Interface::ior_outside); removes the sphere from the ray's interior list `inside`.
pub(super) fn outside_ior(world: &World, row: u32, inside: InteriorList<'_>) -> f32 {
    remove(inside, row);
    match innermost(world, inside) {
        None => 1.0,
        Some(other) if precedes(world, row, other) => ior(world, other),
        Some(_) => 0.0,
    }
}

/// Returns whether sphere `a` decides the medium where it overlaps sphere `b`.
fn precedes(world: &World, a: u32, b: u32) -> bool {
    let key = |row: u32| (world.spheres.radius(row as usize), world.spheres.id[row as usize]);
    key(a) < key(b)
}

/// Returns the sphere of the list that decides the medium.
fn innermost(world: &World, inside: &[u32]) -> Option<u32> {
    let filled = inside.iter().copied().filter(|&row| row != MISS);
    filled.reduce(|a, b| if precedes(world, a, b) { a } else { b })
}

fn remove(inside: InteriorList<'_>, row: u32) {
    if let Some(place) = inside.iter_mut().find(|place| **place == row) {
        *place = MISS;
    }
}

/// Adds a sphere to an interior list. If the list is full, drops the sphere of lowest priority and
/// returns false.
pub(super) fn insert(world: &World, inside: InteriorList<'_>, row: u32) -> bool {
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
