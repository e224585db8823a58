//! What a ray hits, for certain: the judge of all forms.
//!
//! Independent of [`crate::exact`] and [`crate::intersect`], which it judges, in formulas and in
//! code. Intervals that round outward decide what they can: the discriminant is
//! `a r^2 - |F x d|^2` here, by Lagrange's identity, which loses half as many bits as `b^2 - a c`.
//! What they cannot decide, whole numbers do. Errors of distances and normals
//! are measured against whole numbers alone.
//!
//! The rules are those of [`crate::intersect::confirm`]: outside, the near root counts, inside, the
//! far one; a tangent hits; on the surface the direction decides; of spheres at the same distance
//! the first is hit.

pub use super::integers::Twofold;
use super::integers::{Encounter, Units};
use super::interval::Interval;
use super::rays::Ray;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// What a ray hits first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Row of the sphere.
    pub sphere: Option<usize>,
    /// Whether it took whole numbers to know.
    pub close: bool,
}

/// Where a ray hits a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// In units of the direction's length.
    pub t: Twofold,
    /// Outward unit normal.
    pub normal: [Twofold; 3],
    /// The distance's natural unit: by how much it moves, to a small factor, if the ray's origin and
    /// the radius move by the unit roundoff of single precision. Infinite for a tangent.
    pub t_unit: f64,
}

/// A sphere that is hit, or may be, and `a` times the distance.
struct Candidate {
    sphere: usize,
    distance: Interval,
}

/// Which sphere a ray hits first; spheres in rows of x, y, z and radius, all finite, radii more than
/// 0, and the direction not zero.
pub fn closest(spheres: &[[f32; 4]], ray: &Ray) -> Decision {
    let mut close = false;
    let mut candidates: Vec<Candidate> = Vec::with_capacity(spheres.len());
    for (sphere, row) in spheres.iter().enumerate() {
        let terms = Terms::new(ray, *row);
        let hits = terms.decide().unwrap_or_else(|| {
            close = true;
            Encounter::new(Units::of(ray, &[*row]), ray, *row).is_some()
        });
        if hits {
            candidates.push(Candidate { sphere, distance: terms.distance() });
        }
    }
    let bound = candidates.iter().map(|c| c.distance.high).fold(f64::INFINITY, f64::min);
    candidates.retain(|candidate| candidate.distance.low <= bound);
    if let [one] = &candidates[..] {
        return Decision { sphere: Some(one.sphere), close };
    }
    Decision { close: close || !candidates.is_empty(), sphere: first(spheres, ray, &candidates) }
}

/// The nearest of some spheres that are hit, by whole numbers.
fn first(spheres: &[[f32; 4]], ray: &Ray, candidates: &[Candidate]) -> Option<usize> {
    let rows: Vec<_> = candidates.iter().map(|candidate| spheres[candidate.sphere]).collect();
    let units = Units::of(ray, &rows);
    let encounters = candidates.iter().zip(&rows).filter_map(|(candidate, row)| {
        Encounter::new(units, ray, *row).map(|encounter| (candidate.sphere, encounter))
    });
    // `min_by` keeps the first of equals.
    encounters.min_by(|a, b| a.1.compare(&b.1)).map(|nearest| nearest.0)
}

/// Where a ray hits a sphere; `None` if it does not.
pub fn solve(sphere: [f32; 4], ray: &Ray) -> Option<Solution> {
    let encounter = Encounter::new(Units::of(ray, &[sphere]), ray, sphere)?;
    let [x, y, z, radius] = sphere.map(f64::from);
    let from_center = Vec3::from(ray.origin).as_dvec3() - DVec3::new(x, y, z);
    let direction = Vec3::from(ray.direction).as_dvec3();
    let length = direction.length();
    let half = encounter.half_chord2().sqrt();
    let across = from_center.cross(direction / length).length();
    let roundoff = f64::from(f32::EPSILON) / 2.0;
    let t_unit = roundoff * (from_center.length() + radius) * (1.0 + across / half) / length;
    Some(Solution { t: encounter.distance(), normal: encounter.normal(), t_unit })
}

/// Whether a ray hits a sphere nearer than each of some bounds, which `about` makes of the distance,
/// rounded toward 0; `None` if it does not hit.
pub fn nearer_than<const N: usize>(
    sphere: [f32; 4],
    ray: &Ray,
    about: impl Fn(f64) -> [f64; N],
) -> Option<[(f64, bool); N]> {
    let encounter = Encounter::new(Units::of(ray, &[sphere]), ray, sphere)?;
    let bounds = about(encounter.distance().high);
    Some(bounds.map(|bound| (bound, encounter.compare_with(bound).is_lt())))
}

/// What decides about a ray and a sphere, in intervals.
struct Terms {
    a: Interval,
    b: Interval,
    /// Of which only the sign counts, and the size next to `b`.
    outside: Interval,
    discriminant: Interval,
}

impl Terms {
    fn new(ray: &Ray, [x, y, z, radius]: [f32; 4]) -> Self {
        let point = |x: f32| Interval::point(f64::from(x));
        let center = [x, y, z];
        let f: [Interval; 3] = std::array::from_fn(|i| point(ray.origin[i]) - point(center[i]));
        let d = ray.direction.map(point);
        let a = length2(d);
        let radius2 = point(radius).square();
        let cross =
            [f[1] * d[2] - f[2] * d[1], f[2] * d[0] - f[0] * d[2], f[0] * d[1] - f[1] * d[0]];
        Self {
            a,
            b: -(f[0] * d[0] + f[1] * d[1] + f[2] * d[2]),
            outside: length2(f) - radius2,
            discriminant: a * radius2 - length2(cross),
        }
    }

    /// Whether the sphere is hit; `None` if that is not certain.
    fn decide(&self) -> Option<bool> {
        match self.outside.sign() {
            Some(Ordering::Less) => Some(true),
            Some(Ordering::Equal) => self.b.sign().map(Ordering::is_gt),
            Some(Ordering::Greater) if self.b.high <= 0.0 => Some(false),
            _ if self.discriminant.high < 0.0 => Some(false),
            Some(Ordering::Greater) if self.b.low > 0.0 && self.discriminant.low >= 0.0 => {
                Some(true)
            }
            _ => None,
        }
    }

    /// `a` times the distance of a hit.
    fn distance(&self) -> Interval {
        let root = self.discriminant.sqrt();
        match self.outside.sign() {
            Some(Ordering::Greater) => (self.a * self.outside).over(self.b + root),
            Some(_) if self.b.high < 0.0 => (self.a * -self.outside).over(root - self.b),
            Some(_) => self.b + root,
            None => Interval { low: 0.0, high: (self.b + root).high.max(0.0) },
        }
    }
}

fn length2(v: [Interval; 3]) -> Interval {
    v[0].square() + v[1].square() + v[2].square()
}

#[cfg(test)]
mod tests {
    use super::super::rays;
    use super::super::regimes::REGIMES;
    use super::super::scenes;
    use super::*;
    use crate::exact::{self, Distance};
    use crate::ray::ExactRay;
    use spherule_core::internals::random::Random;

    const UNIT: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

    fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        Ray { origin, direction }
    }

    fn hit(spheres: &[[f32; 4]], ray: &Ray) -> Option<usize> {
        closest(spheres, ray).sphere
    }

    #[test]
    fn tangents_hit_and_the_next_ray_misses() {
        for direction in [1.0, 1e-30, 1e30] {
            let at = |y: f32| hit(&[UNIT], &ray([-3.0, y, 0.0], [direction, 0.0, 0.0]));
            assert_eq!((at(1.0), at(1.0_f32.next_up())), (Some(0), None));
        }
        // A tangent that is not along an axis: the line 4 x = 3 y + 5.
        let slanted = |r: f32| hit(&[[0.0, 0.0, 0.0, r]], &ray([-1.0, -3.0, 0.0], [3.0, 4.0, 0.0]));
        assert_eq!((slanted(1.0), slanted(1.0_f32.next_down())), (Some(0), None));
    }

    #[test]
    fn on_the_surface_the_direction_decides() {
        let on = |x: f32, y: f32| hit(&[UNIT], &ray([0.6, 0.0, 0.8], [x, y, 0.0]));
        // 0.6 and 0.8 are not on it once they are rounded; 1 is.
        let pole = |x: f32, z: f32| hit(&[UNIT], &ray([0.0, 0.0, 1.0], [x, 0.0, z]));
        assert_eq!((pole(1.0, -1e-30), pole(1.0, 0.0), pole(0.0, 1.0)), (Some(0), None, None));
        let [x, z] = [0.6_f32, 0.8].map(f64::from);
        assert_eq!(on(1.0, 0.0).is_some(), x * x + z * z < 1.0);
    }

    #[test]
    fn equal_distances_go_to_the_first_and_unequal_ones_to_the_nearer() {
        let ahead = ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let farther = [2.0, 0.0, 0.0, 3.0_f32.next_down()];
        let same = [2.0, 0.0, 0.0, 3.0];
        assert_eq!(hit(&[same, UNIT, same], &ahead), Some(0));
        assert_eq!(hit(&[farther, UNIT, same], &ahead), Some(1));
        assert_eq!(hit(&[], &ahead), None);
        // Equal only as sums of roots: mirror images, with the ray in the plane of the mirror.
        let mirrored = [[0.5, 0.25, 0.75, 0.875], [0.5, -0.25, 0.75, 0.875]];
        let between = ray([-3.0, 0.0, 0.7], [0.9, 0.0, 0.1]);
        assert_eq!(hit(&mirrored, &between), Some(0));
    }

    #[test]
    fn denormal_and_gigantic_numbers_are_no_exception() {
        for scale in [1e-44_f32, 1e-38, 1e30] {
            let sphere = [3.0 * scale, 0.0, 0.0, 2.0 * scale];
            let at = ray([0.0, 2.0 * scale, 0.0], [1e-38, 0.0, 0.0]);
            assert_eq!(hit(&[sphere], &at), Some(0), "{scale}");
            let beside = ray([0.0, (2.0 * scale).next_up(), 0.0], [1e-38, 0.0, 0.0]);
            assert_eq!(hit(&[sphere], &beside), None, "{scale}");
        }
    }

    #[test]
    fn solutions_are_right_beyond_double_precision() {
        // From the center of a sphere of radius 1 along (1, 1, 0): t = 1 / sqrt(2).
        let found = solve(UNIT, &ray([0.0; 3], [1.0, 1.0, 0.0])).unwrap();
        let half_root = 0.5_f64.sqrt();
        // h^2 + 2 h l = 1/2 up to l^2; the residual of h^2 is exact.
        let square_error = half_root.mul_add(half_root, -0.5);
        let (high, low) = (found.t.high, found.t.low);
        let total = (high - half_root) + low;
        assert!((total + square_error / (2.0 * half_root)).abs() < 1e-31, "{total}");
        assert_eq!((found.normal[0], found.normal[2]), (found.t, Twofold::default()));
        let near = solve(UNIT, &ray([-3.0, 0.0, 0.0], [0.5, 0.0, 0.0])).unwrap();
        assert_eq!(near.t, Twofold { high: 4.0, low: 0.0 });
        assert_eq!(near.normal[0], Twofold { high: -1.0, low: 0.0 });
        let expected = f64::from(f32::EPSILON) / 2.0 * 4.0 / 0.5;
        assert!((near.t_unit / expected - 1.0).abs() < 1e-12);
        assert_eq!(solve(UNIT, &ray([-3.0, 0.0, 0.0], [-0.5, 0.0, 0.0])), None);
    }

    fn exact_ray(ray: &Ray) -> ExactRay {
        ExactRay::new(Vec3::from(ray.origin), Vec3::from(ray.direction), false)
    }

    /// What [`crate::exact`] says.
    fn other(spheres: &[[f32; 4]], ray: &Ray) -> Option<usize> {
        let ray = exact_ray(ray);
        let hits = spheres.iter().map(|&row| scenes::parts(row)).enumerate();
        let hits =
            hits.filter(|(_, (center, radius))| exact::hit(&ray, *center, *radius).is_some());
        hits.min_by(|(_, a), (_, b)| {
            exact::compare(&ray, &Distance::Hit(a.0, a.1), &Distance::Hit(b.0, b.1))
        })
        .map(|nearest| nearest.0)
    }

    #[test]
    fn intervals_whole_numbers_and_the_other_exact_arithmetic_agree() {
        for regime in &REGIMES {
            let mut random = Random::new(11);
            for _ in 0..40 {
                let spheres = scenes::scene(&regime.recipe, &mut random);
                for _ in 0..5 {
                    let ray = rays::ray(&regime.recipe, &spheres, &mut random);
                    let found = closest(&spheres, &ray).sphere;
                    assert_eq!(found, other(&spheres, &ray), "{} {ray:?}", regime.name);
                    let everything = (0..spheres.len())
                        .map(|sphere| Candidate { sphere, distance: Interval::point(0.0) });
                    let slow = first(&spheres, &ray, &everything.collect::<Vec<_>>());
                    assert_eq!(found, slow, "{} {ray:?}", regime.name);
                    let Some(sphere) = found else { continue };
                    let (center, radius) = scenes::parts(spheres[sphere]);
                    let t = exact::hit(&exact_ray(&ray), center, radius).unwrap();
                    let solution = solve(spheres[sphere], &ray).unwrap();
                    assert!((t / solution.t.high - 1.0).abs() < 1e-14, "{} {ray:?}", regime.name);
                }
            }
        }
    }
}
