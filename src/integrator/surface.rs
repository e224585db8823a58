//! Where rays hit: points and normals, and how far it is through spheres from there.

use super::workspace::Workspace;
use crate::ray::{ExactRay, GROUND};
use crate::world::World;
use glam::{DVec3, Vec3};

/// Point and outward normal of a hit, in double precision from the surface itself: the point is no
/// farther off it than rounding takes it.
#[inline]
pub(super) fn solve(world: &World, work: &Workspace, row: usize, hit: u32) -> (Vec3, DVec3) {
    let ray = work.rays.exact(row);
    if hit == GROUND {
        let normal = world.ground.map_or(DVec3::Z, |ground| ground.normal);
        let height = world.ground.map_or(0.0, |ground| ground.height);
        let point = ray.at(work.hits.t[row]);
        let off = normal.dot(point) - height;
        return ((point - normal * off).as_vec3(), normal);
    }
    let center = world.spheres.center(hit as usize).as_dvec3();
    let radius = f64::from(world.spheres.radius(hit as usize));
    let normal = if work.rays.own[row] == hit {
        exit_normal(&ray, work.surface.normal[row])
    } else {
        // Of a sphere that is smaller than rounding, the ray is all that is known.
        ray.at_from(center, work.hits.t[row]).normalize_or(-ray.direction.normalize())
    };
    ((center + normal * radius).as_vec3(), normal)
}

/// [`solve`] in a world where spheres are cut: points of caps, and of spheres from their caps.
#[cold]
pub(super) fn solve_cut(world: &World, work: &Workspace, row: usize, hit: u32) -> (Vec3, DVec3) {
    let (ray, own, t) = (work.rays.exact(row), work.rays.own[row], work.hits.t[row]);
    if hit == GROUND {
        return solve(world, work, row, hit);
    }
    if let Some(normal) = world.cut.cap(&ray, own, t) {
        return (ray.at(t).as_vec3(), normal);
    }
    let (center, radius) = world.spheres.exact(hit as usize);
    if own == hit && world.cut.divides(center, radius) {
        let normal = ray.at_from(center, t).normalize_or(-ray.direction.normalize());
        return ((center + normal * radius).as_vec3(), normal);
    }
    solve(world, work, row, hit)
}

/// Where a chord leaves a sphere, from where it entered: mirrored at the plane across the chord's
/// middle. It does not use the origin, which was rounded.
fn exit_normal(ray: &ExactRay, entry: DVec3) -> DVec3 {
    let d = ray.direction;
    (entry - d * (2.0 * entry.dot(d) / d.length_squared())).normalize()
}

/// Distance from a point of a sphere, with outward unit `normal`, through the inside to where
/// `direction` leaves.
#[inline]
pub fn chord(normal: DVec3, radius: f64, direction: DVec3) -> f64 {
    (-2.0 * radius * normal.dot(direction) / direction.length_squared()).max(0.0)
}

/// The same from a point of the inside, `offset` from the center.
pub(super) fn far_end(offset: DVec3, radius: f64, direction: DVec3) -> f64 {
    let (a, b) = (direction.length_squared(), -offset.dot(direction));
    let outside = offset.length_squared() - radius * radius;
    ((b + (b * b - a * outside).max(0.0).sqrt()) / a).max(0.0)
}
