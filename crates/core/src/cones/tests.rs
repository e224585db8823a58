//! Hits on cones against an independent reference with 150 decimal places, and closed forms.

use super::*;
use crate::bodies::BodyTrees;
use crate::body_tree::tests::{Tested, body_tests, check_distances, check_hit, grazing, point};
use crate::fixed::{Fixed, Vector, dot, minus, vector};
use crate::random::Random;
use num_bigint::BigInt;

body_tests!(Cone);

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    })
}

/// What the reference takes for 0: more than its own rounding, and less than anything else.
fn nothing() -> Fixed {
    Fixed(BigInt::from(1) << 112)
}

impl Tested for Cone {
    fn item(random: &mut Random, id: u32) -> ConeItem {
        let size = |random: &mut Random| [0.3, 0.03, 3e-4][random.index(3)] * (0.5 + random.unit());
        let (apex, height) = (point(random), size(random));
        let base = apex + random.direction() * height;
        ConeItem::new(apex.as_vec3(), base.as_vec3(), size(random) as f32, id).expect("a valid one")
    }

    fn with_id(item: ConeItem, id: u32) -> ConeItem {
        ConeItem { id, ..item }
    }

    fn among<'a>(tree: &'a Cones, others: BodyTrees<'a>) -> BodyTrees<'a> {
        BodyTrees { cones: Some(tree), ..others }
    }

    /// By all points where the line crosses the side, the base or the apex, of which the first and the last bound the cone.
    fn reference(&self, ray: &ExactRay) -> Option<Fixed> {
        let (zero, two) = (Fixed::new(0.0), Fixed::new(2.0));
        let none = nothing();
        let is_zero = |x: &Fixed| *x <= none && *x >= zero.minus(&none);
        let (d, apex) = (vector(ray.direction), vector(self.apex));
        let (from, axis) = (minus(&vector(ray.origin), &apex), minus(&vector(self.base), &apex));
        let radius2 = Fixed::new(self.radius).times(&Fixed::new(self.radius));
        let height2 = dot(&axis, &axis);
        let at = |t: &Fixed| -> Vector { std::array::from_fn(|i| from[i].plus(&d[i].times(t))) };
        // |P x v|^2 v.v = r^2 (P.v)^2 on the side.
        let form = |a: &Vector, b: &Vector| {
            let across = dot(&cross(a, &axis), &cross(b, &axis)).times(&height2);
            across.minus(&radius2.times(&dot(a, &axis)).times(&dot(b, &axis)))
        };
        let (a, b, c) = (form(&d, &d), form(&d, &from), form(&from, &from));
        let mut side = Vec::new();
        if !is_zero(&a) {
            let discriminant = b.times(&b).minus(&a.times(&c));
            if discriminant >= zero.minus(&none) {
                let root = if discriminant < zero { zero.clone() } else { discriminant.root() };
                for root in [root.clone(), zero.minus(&root)] {
                    side.push(root.minus(&b).over(&a));
                }
            }
        } else if !is_zero(&b) {
            side.push(zero.minus(&c).over(&two.times(&b)));
        }
        side.retain(|t| {
            let along = dot(&at(t), &axis);
            along >= zero.minus(&none) && along <= height2.plus(&none)
        });
        let mut all = side;
        let slope = dot(&d, &axis);
        if !is_zero(&slope) {
            let t = height2.minus(&dot(&from, &axis)).over(&slope);
            let off = minus(&at(&t), &axis);
            if dot(&off, &off) <= radius2.plus(&none) {
                all.push(t);
            }
        }
        let (moment, length2) = (cross(&d, &from), dot(&d, &d));
        if is_zero(&dot(&moment, &moment)) && !is_zero(&length2) {
            all.push(zero.minus(&dot(&from, &d)).over(&length2));
        }
        let extreme =
            |less: bool| all.iter().cloned().reduce(|a, b| if (b < a) == less { b } else { a });
        [extreme(true)?, extreme(false)?].into_iter().find(|t| *t > none)
    }

    /// On the side, on the base, at the rim or at the apex.
    fn surface(&self, random: &mut Random) -> (DVec3, DVec3) {
        let axis = self.base - self.apex;
        let across = axis.cross(random.direction()).normalize() * self.radius;
        let along = [0.0, 1.0, random.unit(), random.unit()][random.index(4)];
        if random.index(3) == 0 {
            return (self.base + across * random.unit(), axis.normalize());
        }
        let normal = across.normalize() * axis.length() - axis.normalize() * self.radius;
        (self.apex + (axis + across) * along, normal.normalize())
    }

    fn grazing(&self, random: &mut Random) -> ExactRay {
        let (target, normal) = self.surface(random);
        let generator = target - self.apex;
        let around = normal.cross(random.direction());
        let tangent = [around, around, generator + around * 1e-7, generator][random.index(4)];
        let tangent = if tangent.length() > 1e-9 { tangent } else { around };
        grazing(random, target, tangent.normalize(), normal)
    }

    fn holds(&self, point: DVec3) -> bool {
        let axis = self.base - self.apex;
        let along = (point - self.apex).dot(axis) / axis.length_squared();
        let across = (point - self.apex - axis * along).length();
        along > 0.0 && along < 1.0 && across < along * self.radius
    }

    fn support(&self, direction: DVec3) -> f64 {
        let axis = self.base - self.apex;
        let rim = (direction - axis * (direction.dot(axis) / axis.length_squared())).normalize();
        self.apex.dot(direction).max((self.base + rim * self.radius).dot(direction))
    }

    fn is_edge(&self, point: DVec3) -> bool {
        let from = point - self.apex;
        let [side, base] = self.distances(from);
        side.max(base).abs() < 1e-6 && (side.min(base) > -1e-6 || from.length() < 1e-6)
    }

    fn leaves_clearly(&self, direction: DVec3) -> bool {
        direction.dot((self.base - self.apex).normalize()).abs() > 0.01
    }
}

/// Cones and rays on a lattice, of which many touch at the apex, at the rim, along the base or along the side.
#[test]
fn hits_are_right_where_everything_touches() {
    let mut random = Random::new(32);
    let (mut hits, mut misses, mut exact) = (0, 0, 0);
    let lattice = |random: &mut Random| -> DVec3 {
        DVec3::from([(); 3].map(|()| f64::from(random.index(9) as u32) - 4.0))
    };
    while hits < 12_000 {
        let (apex, base) = (lattice(&mut random), lattice(&mut random));
        if apex == base {
            continue;
        }
        let cone = Cone { apex, base, radius: f64::from(1 + random.index(4) as u32) };
        let origin = lattice(&mut random);
        let towards = [apex, base, lattice(&mut random)][random.index(3)];
        let ray = ExactRay { origin, direction: towards - origin, origin_error: 0.0 };
        match check_hit(&cone, &ray) {
            Some(by_integers) => (hits, exact) = (hits + 1, exact + u32::from(by_integers)),
            None => misses += 1,
        }
    }
    assert!(misses > 3_000 && exact > 1_000, "{misses} {exact}");
}

#[test]
fn touching_rays_hit_and_the_next_ray_misses() {
    // A rim of radius 3 about the origin, and an apex at a height of 4: lines of the side have a length of 5.
    let cone = Cone { apex: DVec3::Z * 4.0, base: DVec3::ZERO, radius: 3.0 };
    let above = 4.0_f64.next_up();
    let rays = [
        // The base, the side, the apex, the rim.
        ([1.0, 1.0, -5.0], [0.0, 0.0, 1.0], Some(5.0)),
        ([-5.0, 0.0, 2.0], [1.0, 0.0, 0.0], Some(3.5)),
        ([-5.0, 0.0, 4.0], [1.0, 0.0, 0.0], Some(5.0)),
        ([-5.0, 0.0, above], [1.0, 0.0, 0.0], None),
        ([3.0, -2.0, 0.0], [0.0, 1.0, 0.0], Some(2.0)),
        ([3.0_f64.next_up(), -2.0, 0.0], [0.0, 1.0, 0.0], None),
        ([3.0, 0.0, -2.0], [0.0, 0.0, 1.0], Some(2.0)),
        ([3.0_f64.next_up(), 0.0, -2.0], [0.0, 0.0, 1.0], None),
        // In the plane of the base, and below it.
        ([-5.0, 0.0, 0.0], [1.0, 0.0, 0.0], Some(2.0)),
        ([-5.0, 0.0, -f64::MIN_POSITIVE], [1.0, 0.0, 0.0], None),
        // Along the side from beyond the apex, beside it, and within, parallel to it.
        ([-3.0, 0.0, 8.0], [3.0, 0.0, -4.0], Some(1.0)),
        ([(-3.0_f64).next_up(), 0.0, 8.0], [3.0, 0.0, -4.0], None),
        ([-4.0, 0.0, 8.0], [3.0, 0.0, -4.0], Some(7.0 / 6.0)),
        // From within, from the base inward and outward, from the apex.
        ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], Some(3.0)),
        ([0.0; 3], [0.0, 0.0, 1.0], Some(4.0)),
        ([0.0; 3], [0.0, 0.0, -1.0], None),
        ([1.0, 0.0, 0.0], [1.0, 0.0, 0.0], Some(2.0)),
        ([0.0, 0.0, 4.0], [0.0, 0.0, -1.0], Some(4.0)),
        ([0.0, 0.0, 4.0], [1.0, 0.0, 0.0], None),
        ([0.0, 0.0, 4.0], [3.0, 0.0, -4.0], Some(1.0)),
        // The other half of the double cone is not there.
        ([-5.0, 0.0, 5.0], [1.0, 0.0, 0.0], None),
        ([0.0, 0.0, 5.0], [0.0, 0.0, 1.0], None),
        ([1.0, 0.0, 9.0], [0.0, 0.0, 1.0], None),
    ];
    check_distances(&cone, rays);
}

#[test]
fn bad_cones_are_refused() {
    let make = |height: f32, radius: f32| {
        ConeItem::new(Vec3::ZERO, Vec3::X * height, radius, 0).map(|_| ())
    };
    for radius in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-30] {
        assert_eq!(make(1.0, radius), Err(BadCone::Radius), "{radius}");
    }
    for height in [0.0, f32::NAN, f32::INFINITY, 1e-30] {
        assert_eq!(make(height, 1.0), Err(BadCone::Height), "{height}");
    }
    let most = ConeItem::MAX_RATIO as f32;
    assert_eq!((make(1.0, 1.0 / most), make(1.0 / most, 1.0)), (Ok(()), Ok(())));
    assert_eq!(make(1.0, 0.9 / most), Err(BadCone::Ratio));
    assert_eq!(make(0.9 / most, 1.0), Err(BadCone::Ratio));
}
