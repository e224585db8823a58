//! Exact ray-sphere intersection, the reference for all tests.
//!
//! Formulas and code are independent of [`spherule_render::exact`] and [`spherule_render::intersect`],
//! which are tested with it. Interval arithmetic decides most cases; the discriminant is
//! `a r^2 - |F x d|^2` here, by Lagrange's identity, which loses half as many bits as `b^2 - a c`.
//! Integer arithmetic decides the rest, and gives distances and normals for error measurements.
//!
//! The rules are those of [`spherule_render::intersect::confirm`]: the near root counts outside, the far
//! one inside; a tangent hits; on the surface the direction decides; of spheres at the same distance
//! the first is hit.

pub use super::integers::DoubleDouble;
use super::integers::{ExactHit, Units};
use super::interval::Interval;
use super::rays::Ray;
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// The closest hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decision {
    /// Row of the sphere; `None` for a miss.
    pub sphere: Option<usize>,
    /// True if integer arithmetic was necessary.
    pub close: bool,
}

/// Distance and normal of a hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Distance in units of the direction's length.
    pub t: DoubleDouble,
    /// Outward unit normal.
    pub normal: [DoubleDouble; 3],
    /// Natural unit of the distance's error: its change, up to a small factor, if the ray's origin and
    /// the radius change by the unit roundoff of single precision. Infinite for a tangent.
    pub t_unit: f64,
}

/// A sphere that is or may be hit, and `a` times the distance.
struct Candidate {
    sphere: usize,
    distance: Interval,
}

/// Returns the closest hit of a ray. Spheres are rows of x, y, z and radius. All numbers are finite, radii
/// are positive, and the direction is not zero.
pub fn closest(spheres: &[[f32; 4]], ray: &Ray) -> Decision {
    let mut close = false;
    let mut candidates: Vec<Candidate> = Vec::with_capacity(spheres.len());
    for (sphere, row) in spheres.iter().enumerate() {
        let terms = Terms::new(ray, *row);
        let hits = terms.decide().unwrap_or_else(|| {
            close = true;
            ExactHit::new(Units::of(ray, &[*row]), ray, *row).is_some()
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

/// Returns the nearest of the candidates that are hit, by integer arithmetic.
fn first(spheres: &[[f32; 4]], ray: &Ray, candidates: &[Candidate]) -> Option<usize> {
    let rows: Vec<_> = candidates.iter().map(|candidate| spheres[candidate.sphere]).collect();
    let units = Units::of(ray, &rows);
    let hits = candidates.iter().zip(&rows).filter_map(|(candidate, row)| {
        ExactHit::new(units, ray, *row).map(|hit| (candidate.sphere, hit))
    });
    // `min_by` returns the first of equal elements.
    hits.min_by(|a, b| a.1.compare(&b.1)).map(|nearest| nearest.0)
}

/// Returns distance and normal of a hit; `None` for a miss.
pub fn solve(sphere: [f32; 4], ray: &Ray) -> Option<Solution> {
    let hit = ExactHit::new(Units::of(ray, &[sphere]), ray, sphere)?;
    let [x, y, z, radius] = sphere.map(f64::from);
    let from_center = Vec3::from(ray.origin).as_dvec3() - DVec3::new(x, y, z);
    let direction = Vec3::from(ray.direction).as_dvec3();
    let length = direction.length();
    let half = hit.half_chord2().sqrt();
    let across = from_center.cross(direction / length).length();
    let roundoff = f64::from(f32::EPSILON) / 2.0;
    let t_unit = roundoff * (from_center.length() + radius) * (1.0 + across / half) / length;
    Some(Solution { t: hit.distance(), normal: hit.normal(), t_unit })
}

/// Returns bounds, and for each whether the ray hits the sphere nearer than it. `bounds_around` computes
/// the bounds from the distance, rounded toward 0. Returns `None` for a miss.
pub fn nearer_than<const N: usize>(
    sphere: [f32; 4],
    ray: &Ray,
    bounds_around: impl Fn(f64) -> [f64; N],
) -> Option<[(f64, bool); N]> {
    let hit = ExactHit::new(Units::of(ray, &[sphere]), ray, sphere)?;
    let bounds = bounds_around(hit.distance().high);
    Some(bounds.map(|bound| (bound, hit.compare_with(bound).is_lt())))
}

/// Terms of the intersection of a ray and a sphere, as intervals.
struct Terms {
    a: Interval,
    b: Interval,
    /// Squared distance of the origin from the center, minus the squared radius.
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

    /// Returns whether the sphere is hit; `None` if the intervals cannot decide.
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

    /// Returns `a` times the distance of a hit.
    fn distance(&self) -> Interval {
        let root = self.discriminant.sqrt();
        match self.outside.sign() {
            Some(Ordering::Greater) => (self.a * self.outside).divide(self.b + root),
            Some(_) if self.b.high < 0.0 => (self.a * -self.outside).divide(root - self.b),
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
    use spherule_core::internals::random::Random;
    use spherule_render::exact::{self, Distance};
    use spherule_render::ray::ExactRay;

    const UNIT: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

    fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        Ray { origin, direction }
    }

    fn hit(spheres: &[[f32; 4]], ray: &Ray) -> Option<usize> {
        closest(spheres, ray).sphere
    }

    #[test]
    fn tangents_hit_and_the_next_rays_miss() {
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
        // 1 is exactly on the surface; rounded 0.6 and 0.8 are not.
        let pole = |x: f32, z: f32| hit(&[UNIT], &ray([0.0, 0.0, 1.0], [x, 0.0, z]));
        assert_eq!((pole(1.0, -1e-30), pole(1.0, 0.0), pole(0.0, 1.0)), (Some(0), None, None));
        let [x, z] = [0.6_f32, 0.8].map(f64::from);
        assert_eq!(on(1.0, 0.0).is_some(), x * x + z * z < 1.0);
    }

    #[test]
    fn the_nearest_sphere_is_hit_and_the_first_of_equal_ones() {
        let ahead = ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let farther = [2.0, 0.0, 0.0, 3.0_f32.next_down()];
        let same = [2.0, 0.0, 0.0, 3.0];
        assert_eq!(hit(&[same, UNIT, same], &ahead), Some(0));
        assert_eq!(hit(&[farther, UNIT, same], &ahead), Some(1));
        assert_eq!(hit(&[], &ahead), None);
        // Equal only as sums of roots: mirror images, with the ray in the mirror plane.
        let mirrored = [[0.5, 0.25, 0.75, 0.875], [0.5, -0.25, 0.75, 0.875]];
        let between = ray([-3.0, 0.0, 0.7], [0.9, 0.0, 0.1]);
        assert_eq!(hit(&mirrored, &between), Some(0));
    }

    #[test]
    fn denormal_and_huge_numbers_are_decided_correctly() {
        for scale in [1e-44_f32, 1e-38, 1e30] {
            let sphere = [3.0 * scale, 0.0, 0.0, 2.0 * scale];
            let at = ray([0.0, 2.0 * scale, 0.0], [1e-38, 0.0, 0.0]);
            assert_eq!(hit(&[sphere], &at), Some(0), "{scale}");
            let beside = ray([0.0, (2.0 * scale).next_up(), 0.0], [1e-38, 0.0, 0.0]);
            assert_eq!(hit(&[sphere], &beside), None, "{scale}");
        }
    }

    #[test]
    fn solutions_exceed_double_precision() {
        // From the center of a sphere of radius 1 along (1, 1, 0): t = 1 / sqrt(2).
        let found = solve(UNIT, &ray([0.0; 3], [1.0, 1.0, 0.0])).unwrap();
        let half_root = 0.5_f64.sqrt();
        // h^2 + 2 h l = 1/2 up to l^2; the residual of h^2 is exact.
        let square_error = half_root.mul_add(half_root, -0.5);
        let (high, low) = (found.t.high, found.t.low);
        let total = (high - half_root) + low;
        assert!((total + square_error / (2.0 * half_root)).abs() < 1e-31, "{total}");
        assert_eq!((found.normal[0], found.normal[2]), (found.t, DoubleDouble::default()));
        let near = solve(UNIT, &ray([-3.0, 0.0, 0.0], [0.5, 0.0, 0.0])).unwrap();
        assert_eq!(near.t, DoubleDouble { high: 4.0, low: 0.0 });
        assert_eq!(near.normal[0], DoubleDouble { high: -1.0, low: 0.0 });
        let expected = f64::from(f32::EPSILON) / 2.0 * 4.0 / 0.5;
        assert!((near.t_unit / expected - 1.0).abs() < 1e-12);
        assert_eq!(solve(UNIT, &ray([-3.0, 0.0, 0.0], [-0.5, 0.0, 0.0])), None);
    }

    fn exact_ray(ray: &Ray) -> ExactRay {
        ExactRay::new(Vec3::from(ray.origin), Vec3::from(ray.direction), false)
    }

    /// Returns the closest hit by [`spherule_render::exact`].
    fn by_exact(spheres: &[[f32; 4]], ray: &Ray) -> Option<usize> {
        let ray = exact_ray(ray);
        let hits = spheres.iter().map(|&row| scenes::center_and_radius(row)).enumerate();
        let hits =
            hits.filter(|(_, (center, radius))| exact::hit(&ray, *center, *radius).is_some());
        hits.min_by(|(_, a), (_, b)| {
            exact::compare(&ray, &Distance::Hit(a.0, a.1), &Distance::Hit(b.0, b.1))
        })
        .map(|nearest| nearest.0)
    }

    #[test]
    fn intervals_integers_and_the_other_exact_arithmetic_agree() {
        for regime in &REGIMES {
            let mut random = Random::new(11);
            for _ in 0..40 {
                let spheres = scenes::scene(&regime.recipe, &mut random);
                for _ in 0..5 {
                    let ray = rays::ray(&regime.recipe, &spheres, &mut random);
                    let found = closest(&spheres, &ray).sphere;
                    assert_eq!(found, by_exact(&spheres, &ray), "{} {ray:?}", regime.name);
                    let everything = (0..spheres.len())
                        .map(|sphere| Candidate { sphere, distance: Interval::point(0.0) });
                    let slow = first(&spheres, &ray, &everything.collect::<Vec<_>>());
                    assert_eq!(found, slow, "{} {ray:?}", regime.name);
                    let Some(sphere) = found else { continue };
                    let (center, radius) = scenes::center_and_radius(spheres[sphere]);
                    let t = exact::hit(&exact_ray(&ray), center, radius).unwrap();
                    let solution = solve(spheres[sphere], &ray).unwrap();
                    assert!((t / solution.t.high - 1.0).abs() < 1e-14, "{} {ray:?}", regime.name);
                }
            }
        }
    }
}
