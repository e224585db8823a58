//! Hits on ellipsoids against an independent reference with 150 decimal places, and closed forms.

use super::*;
use crate::bodies::BodyTrees;
use crate::body_tree::tests::{Tested, body_tests, check_distances, grazing, point};
use crate::exact::Distance;
use crate::fixed::{Fixed, dot, minus, roots, vector};
use crate::intersect::confirm;
use crate::random::Random;
use glam::DMat3;
use std::cmp::Ordering;

body_tests!(Ellipsoid);

impl Tested for Ellipsoid {
    fn item(random: &mut Random, id: u32) -> EllipsoidItem {
        let axis = |random: &mut Random| [0.3, 0.03, 3e-4][random.index(3)] * (0.5 + random.unit());
        let semi_axes = DVec3::new(axis(random), axis(random), axis(random));
        let orientation = DQuat::from_axis_angle(random.direction(), random.unit() * 6.0);
        let center = point(random).as_vec3();
        EllipsoidItem::new(center, semi_axes, orientation, id).expect("a valid one")
    }

    fn with_id(item: EllipsoidItem, id: u32) -> EllipsoidItem {
        EllipsoidItem { id, ..item }
    }

    fn among<'a>(tree: &'a Ellipsoids, others: BodyTrees<'a>) -> BodyTrees<'a> {
        BodyTrees { ellipsoids: Some(tree), ..others }
    }

    /// By the roots of a quadratic without rounding that matters.
    fn reference(&self, ray: &ExactRay) -> Option<Fixed> {
        let rows = self.to_unit.map(vector);
        let to_unit = |v: &[Fixed; 3]| -> [Fixed; 3] { std::array::from_fn(|i| dot(&rows[i], v)) };
        let y = to_unit(&minus(&vector(ray.origin), &vector(self.center)));
        let w = to_unit(&vector(ray.direction));
        let (zero, one) = (Fixed::new(0.0), Fixed::new(1.0));
        let b = zero.minus(&dot(&y, &w));
        let roots = roots(&dot(&w, &w), &b, &dot(&y, &y).minus(&one))?;
        roots.into_iter().find(|t| *t > zero)
    }

    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let (inverse, unit) = (from_unit(self), random.direction());
        let tangent = unit.any_orthonormal_vector();
        let normal = (inverse * tangent).cross(inverse * unit.cross(tangent)).normalize();
        let from_center = inverse * unit;
        (self.center + from_center, normal * normal.dot(from_center).signum())
    }

    fn grazing(&self, random: &mut Random) -> ExactRay {
        let inverse = from_unit(self);
        let normal = random.direction();
        let tangent = normal.cross(random.direction()).normalize();
        grazing(random, self.center + inverse * normal, inverse * tangent, inverse * normal)
    }

    fn holds(&self, point: DVec3) -> bool {
        (from_unit(self).inverse() * (point - self.center)).length() < 1.0
    }

    fn support(&self, direction: DVec3) -> f64 {
        // The farthest point is where the normal points along the direction.
        let inverse = from_unit(self);
        let farthest = inverse * (inverse.transpose() * direction).normalize();
        (self.center + farthest).dot(direction)
    }
}

fn from_unit(ellipsoid: &Ellipsoid) -> DMat3 {
    let [x, y, z] = ellipsoid.to_unit;
    DMat3::from_cols(x, y, z).transpose().inverse()
}

#[test]
fn tangents_hit_and_the_next_ray_misses() {
    let axes = DVec3::new(2.0, 1.0, 0.5);
    let item = EllipsoidItem::new(Vec3::ZERO, axes, DQuat::IDENTITY, 0).expect("a valid one");
    let rays = [
        ([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0], Some(1.0)),
        ([-3.0, 0.0, 0.5], [1.0, 0.0, 0.0], Some(3.0)),
        ([-3.0, 0.0, 0.5_f64.next_up()], [1.0, 0.0, 0.0], None),
        ([2.0, -4.0, 0.0], [0.0, 2.0, 0.0], Some(2.0)),
        ([2.0_f64.next_up(), -4.0, 0.0], [0.0, 2.0, 0.0], None),
        // From the middle, from the surface inward and outward, and away.
        ([0.0; 3], [0.0, 0.0, -1.0], Some(0.5)),
        ([0.0, 0.0, 0.5], [0.0, 0.0, -1.0], Some(1.0)),
        ([0.0, 0.0, 0.5], [0.0, 0.0, 1.0], None),
        ([0.0, 0.0, 0.5], [1.0, 0.0, 0.0], None),
        ([3.0, 0.0, 0.0], [1.0, 0.0, 0.0], None),
    ];
    check_distances(&Ellipsoid::stored(&item), rays);
}

#[test]
fn equal_axes_are_a_sphere() {
    let mut random = Random::new(22);
    let mut hits = 0;
    for _ in 0..2000 {
        let center = point(&mut random);
        let orientation = [DQuat::IDENTITY, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)];
        let orientation = orientation[random.index(2)];
        let item =
            EllipsoidItem::new(center.as_vec3(), DVec3::splat(0.25), orientation, 0).unwrap();
        let body = Ellipsoid::stored(&item);
        let ray = body.grazing(&mut random);
        let (found, sphere) = (body.intersect(&ray), confirm(&ray, center, 0.25, || false));
        assert_eq!(found.is_some(), sphere.is_some());
        if found.is_some() {
            let (distance, _) = body.exact_hit(&ray).expect("a hit");
            let of_sphere = Distance::Hit(center, 0.25).value(&ray);
            assert_eq!(distance.compare(&of_sphere), Ordering::Equal);
            hits += 1;
        }
    }
    assert!(hits > 500 && hits < 1900, "{hits}");
}

#[test]
fn bad_axes_are_refused() {
    let make = |x: f64| {
        EllipsoidItem::new(Vec3::ZERO, DVec3::new(x, 1.0, 1.0), DQuat::IDENTITY, 0).map(|_| ())
    };
    for x in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300] {
        assert_eq!(make(x), Err(BadEllipsoid::Axis), "{x}");
    }
    assert_eq!(make(1.0 / EllipsoidItem::MAX_RATIO), Ok(()));
    assert_eq!(make(0.9 / EllipsoidItem::MAX_RATIO), Err(BadEllipsoid::Ratio));
}
