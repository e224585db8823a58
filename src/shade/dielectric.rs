//! Smooth glass, nested and overlapping.
//!
//! A point inside several glass spheres is in the smallest of them (of equals, the one that comes
//! first in the scene): the rule of priorities of Schmidt and Budge, "Simple Nested Dielectrics in
//! Ray Traced Images", Journal of Graphics Tools 2002, with the radius as the priority, since what
//! is nested is smaller. It depends on the point alone, not on the path that led there. An
//! interface that lies inside a smaller sphere is not there.

use super::fresnel;
use crate::lanes::Doubles;
use crate::ray::MISS;
use crate::vec3::Vec3;
use crate::world::World;

/// The glass spheres that a path is in, as rows, in any order; [`MISS`] marks a free place.
pub type Inside<'a> = &'a mut [u32];

/// A ray that meets the surface of a glass sphere, or a row of them.
#[derive(Clone, Copy, Debug)]
pub struct Meeting<D> {
    /// Where the ray goes, of any length.
    pub direction: Vec3<D>,
    /// The outward unit normal.
    pub normal: Vec3<D>,
    /// Index of refraction of the sphere.
    pub here: D,
    /// Index of refraction of what is around the sphere there; 0 where that decides the medium on
    /// both sides, so that the surface is not there.
    pub around: D,
    /// A number in [0, 1) that chooses whether the ray is reflected.
    pub choice: D,
}

/// What glass does to a ray.
#[derive(Clone, Copy, Debug)]
pub struct Passage<D: Doubles> {
    /// Where the ray goes on: a unit vector.
    pub direction: Vec3<D>,
    /// Whether it goes on inside the sphere.
    pub inward: D::Mask,
}

/// Takes a ray through or back from the surface of a glass sphere.
///
/// It is reflected with the probability of the share that is, so its weight does not change.
#[inline(always)]
pub fn pass<D: Doubles>(meeting: &Meeting<D>) -> Passage<D> {
    let Meeting { direction, normal, here, around, choice } = *meeting;
    let direction = direction * direction.inverse_length();
    let entering = direction.dot_unfused(normal).lt(D::splat(0.0));
    let from = D::select(entering, around, here);
    let eta = from / D::select(entering, here, around);
    let facing = Vec3::select(entering, normal, -normal);
    let (sent, through) = refract(direction, facing, eta, choice);
    let real = D::splat(0.0).lt(around);
    let across = through | !real;
    Passage {
        direction: Vec3::select(real, sent, direction),
        inward: (entering & across) | (!entering & !across),
    }
}

/// Reflects or refracts at an interface with unit normal `facing`, against the ray. Returns whether
/// it went through.
#[inline(always)]
fn refract<D: Doubles>(
    direction: Vec3<D>,
    facing: Vec3<D>,
    eta: D,
    choice: D,
) -> (Vec3<D>, D::Mask) {
    let cosine = clamp(-direction.dot_unfused(facing));
    let (reflected, refracted) = fresnel::dielectric(cosine, eta);
    let back = choice.lt(reflected);
    let mirrored = direction + facing * (D::splat(2.0) * cosine);
    let bent = direction * eta + facing * (eta * cosine - refracted);
    let sent = Vec3::select(back, mirrored, bent);
    (sent * sent.inverse_length(), !back)
}

/// The nearest number in 0..=1.
#[inline(always)]
fn clamp<D: Doubles>(x: D) -> D {
    let (zero, one) = (D::splat(0.0), D::splat(1.0));
    let x = D::select(x.lt(zero), zero, x);
    D::select(one.lt(x), one, x)
}

/// The index of refraction of glass sphere `row`.
#[inline(always)]
pub fn index(world: &World, row: u32) -> f32 {
    let material = world.appearance.material.row(row as usize);
    world.materials.dielectric[material.row()].ior
}

/// The index of refraction around glass sphere `row` where a ray meets it, as [`Meeting::around`];
/// `inside` is what the ray is in, and loses the sphere.
pub fn around(world: &World, row: u32, inside: Inside<'_>) -> f32 {
    remove(inside, row);
    match innermost(world, inside) {
        None => 1.0,
        Some(other) if precedes(world, row, other) => index(world, other),
        Some(_) => 0.0,
    }
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
    use crate::lanes::{F64x8, Mask};
    use crate::shade::tests::numbers;
    use glam::DVec3;

    fn meet(direction: DVec3, normal: DVec3, eta: f64, choice: f64) -> (DVec3, bool) {
        let (sent, through) = refract(direction.into(), normal.into(), eta, choice);
        (DVec3::new(sent.x, sent.y, sent.z), through)
    }

    #[test]
    fn refraction_obeys_snell_and_keeps_to_the_plane() {
        let normal = DVec3::Z;
        for degrees in [1.0, 30.0, 60.0, 89.0] {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let direction = DVec3::new(sin, 0.0, -cos);
            // A choice of 1 never reflects, but for total reflection.
            let (refracted, through) = meet(direction, normal, 1.0 / 1.5, 1.0);
            assert!(through && refracted.y == 0.0 && refracted.z < 0.0);
            assert!((refracted.x * 1.5 - sin).abs() < 1e-14);
            let (reflected, through) = meet(direction, normal, 1.0 / 1.5, 0.0);
            assert!(!through && (reflected - DVec3::new(sin, 0.0, cos)).length() < 1e-14);
        }
        let grazing = DVec3::new(0.9, 0.0, -(1.0_f64 - 0.81).sqrt());
        assert!(!meet(grazing, normal, 1.5, 0.999_999).1, "total reflection");
    }

    #[test]
    fn rays_in_a_row_pass_as_each_does() {
        let draws: Vec<[f64; 3]> =
            numbers(5, 24).map(|u| u.map(|x| 2.0 * f64::from(x) - 1.0)).collect();
        let meeting = |lane: usize| {
            let [a, b, c] = [draws[lane], draws[lane + 8], draws[lane + 16]];
            let around = [1.0, 0.0, 1.33, 2.4][lane % 4];
            let normal = DVec3::from(b).normalize();
            Meeting {
                direction: DVec3::from(a).into(),
                normal: normal.into(),
                here: 1.5,
                around,
                choice: c[0].abs(),
            }
        };
        let one: [Meeting<f64>; 8] = std::array::from_fn(meeting);
        let row = |of: fn(&Meeting<f64>) -> f64| F64x8::new(one.each_ref().map(of));
        let together = pass(&Meeting {
            direction: Vec3::new(
                row(|m| m.direction.x),
                row(|m| m.direction.y),
                row(|m| m.direction.z),
            ),
            normal: Vec3::new(row(|m| m.normal.x), row(|m| m.normal.y), row(|m| m.normal.z)),
            here: row(|m| m.here),
            around: row(|m| m.around),
            choice: row(|m| m.choice),
        });
        let direction = together.direction.map(F64x8::to_array);
        for (lane, meeting) in one.iter().enumerate() {
            let alone = pass(meeting);
            let sent = Vec3::new(direction.x[lane], direction.y[lane], direction.z[lane]);
            assert_eq!(sent, alone.direction, "{lane}");
            assert_eq!(together.inward.bits() >> lane & 1 == 1, alone.inward, "{lane}");
            if meeting.around == 0.0 {
                let scale = meeting.direction.inverse_length();
                assert_eq!(alone.direction, meeting.direction * scale, "what is not there");
                assert_eq!(alone.inward, meeting.direction.dot_unfused(meeting.normal) < 0.0);
            }
        }
    }
}
