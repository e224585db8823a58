//! Intersections with the ground plane, eight rays at a time, in double precision.

use crate::intersect::Plane;
use crate::lanes::{
    Doubles, F32x8, F64x8, Lanes, Mask, bits, bits_of, load_doubles, set_bits, store_where,
};
use crate::ray::{Columns3, GROUND, Hits, MISS, Rays};
use crate::vec3::Vec3;
use crate::world::Ground;

/// Rays that are tested at once.
const LANES: usize = 8;

/// Intersects rays with the ground, and updates the hits that are farther.
pub(crate) fn intersect_ground(ground: &Ground, rays: &Rays, hits: &mut Hits) {
    let plane = plane(ground);
    for first in (0..rays.len()).step_by(LANES) {
        let (crossed, t) = crossed(&plane, rays, first);
        let nearer = crossed & t.lt(bounds(hits, first));
        let active = lanes_of(rays, first) & nearer.bits();
        if active == nearer.bits() {
            store_where(nearer, t, &mut hits.t[first..]);
            set_bits(active).for_each(|lane| hits.sphere[first + lane] = GROUND);
        } else {
            let t = t.to_array();
            set_bits(active).for_each(|lane| hits.set(first + lane, t[lane], GROUND));
        }
    }
}

/// Tests whether the ground occludes rays that have no hit yet.
pub(crate) fn occlude_by_ground(ground: &Ground, rays: &Rays, hits: &mut Hits) {
    let plane = plane(ground);
    for first in (0..rays.len()).step_by(LANES) {
        let (crossed, t) = crossed(&plane, rays, first);
        let free = bits_of::<F32x8>(&hits.sphere[first..]).has_bits_of(bits(MISS)).bits();
        let hidden = crossed & t.lt(bounds(hits, first));
        set_bits(hidden.bits() & free & lanes_of(rays, first))
            .for_each(|lane| hits.sphere[first + lane] = GROUND);
    }
}

fn plane(ground: &Ground) -> Plane<f64> {
    Plane { normal: ground.normal.into(), height: ground.height }
}

fn bounds(hits: &Hits, first: usize) -> F64x8 {
    F64x8::new(*hits.t[first..].first_chunk().expect("columns hold whole rows"))
}

/// Returns the lanes with a ray that does not start on the ground.
#[inline(always)]
fn lanes_of(rays: &Rays, first: usize) -> u32 {
    let active = u32::MAX >> (u32::BITS as usize - LANES.min(rays.len() - first));
    active & !bits_of::<F32x8>(&rays.own[first..]).has_bits_of(bits(GROUND)).bits()
}

/// Intersects a row of rays with the plane; returns a mask and the distances.
#[inline(always)]
fn crossed(plane: &Plane<f64>, rays: &Rays, first: usize) -> (<F64x8 as Doubles>::Mask, F64x8) {
    debug_assert!(rays.precise.is_empty(), "rays of scenes are what their columns hold");
    let vector = |v: &Columns3| {
        let [x, y, z] = [&v.x, &v.y, &v.z].map(|column| load_doubles(&column[first..]));
        Vec3::new(x, y, z)
    };
    let (origin, direction) = (vector(&rays.origin), vector(&rays.direction));
    let from_camera = bits_of::<F32x8>(&rays.own[first..]).has_bits_of(bits(MISS));
    let rounded = Lanes::select(from_camera, F32x8::splat(0.0), F32x8::splat(f32::EPSILON));
    let span = origin.x.abs() + origin.y.abs() + origin.z.abs();
    let row = Plane { normal: plane.normal.map(F64x8::splat), height: F64x8::splat(plane.height) };
    row.crossed((origin, direction), span * Lanes::doubles(rounded, 0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::ExactRay;
    use crate::shade::MaterialId;
    use glam::DVec3;
    use spherule_core::internals::random::Random;

    /// Intersects one ray with one plane, by the definition.
    fn reached(ground: &Ground, ray: &ExactRay) -> Option<f64> {
        let above = ground.normal.dot(ray.origin) - ground.height;
        let descent = -ground.normal.dot(ray.direction);
        if above.abs() <= ray.origin_error {
            return (descent > 0.0).then_some((above / descent).max(0.0));
        }
        Some(above / descent).filter(|&t| t > 0.0 && t < f64::INFINITY)
    }

    #[test]
    fn rows_equal_their_rays() {
        let mut random = Random::new(3);
        let (mut ended, mut hidden) = (0, 0);
        for round in 0..4000 {
            let normal = if round % 2 == 0 { DVec3::Z } else { random.direction() };
            let ground =
                Ground { normal, height: random.in_cube().x, material: MaterialId::default() };
            let count = 1 + random.index(20);
            let mut rays = Rays::with_capacity(count);
            let mut hits = Hits::with_capacity(count);
            for row in 0..count {
                let on = random.coin();
                let start = random.in_cube();
                let off = normal * (normal.dot(start) - ground.height);
                let start = if on { start - off } else { start };
                let level = random.index(8) == 0;
                let direction = random.direction();
                let direction =
                    if level { direction - normal * normal.dot(direction) } else { direction };
                let own = [MISS, GROUND, 7][random.index(3)];
                rays.push(start.as_vec3(), direction.as_vec3(), own);
                let t = if random.coin() { f64::INFINITY } else { random.unit() };
                hits.set(row, t, if random.index(4) == 0 { 5 } else { MISS });
            }
            let mut shadows = hits.clone();
            let before = hits.clone();
            intersect_ground(&ground, &rays, &mut hits);
            occlude_by_ground(&ground, &rays, &mut shadows);
            for row in 0..count {
                let (t, sphere) = (before.t[row], before.sphere[row]);
                let found = reached(&ground, &rays.exact(row))
                    .filter(|&found| rays.own[row] != GROUND && found < t);
                let expected = found.map_or((t, sphere), |found| (found, GROUND));
                assert_eq!((hits.t[row], hits.sphere[row]), expected, "row {row} of {count}");
                let hides = found.is_some() && sphere == MISS;
                let expected = if hides { GROUND } else { sphere };
                assert_eq!((shadows.t[row], shadows.sphere[row]), (t, expected));
                (ended, hidden) = (ended + i32::from(found.is_some()), hidden + i32::from(hides));
            }
        }
        assert!(ended > 5000 && hidden > 3000, "{ended} {hidden}");
    }
}
