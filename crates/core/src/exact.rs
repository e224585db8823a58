//! Ray against sphere in arithmetic without any rounding, for what double precision cannot decide.
//!
//! Coordinates in single or double precision are whole multiples of powers of two, and so is every
//! sum, difference and product of them: `Dyadic` holds such numbers with as many bits as they
//! need. With `F` from the center to the origin, `a = d.d`, `b = -F.d`, `c = F.F - r^2` and `D =
//! b^2 - a c`, all exact, a ray hits if it starts outside (`c > 0`), heads for the sphere (`b > 0`)
//! and its line meets it (`D >= 0`; a tangent hits), or starts inside, or starts on the surface and
//! heads in. It does so at `t = (b -+ sqrt(D)) / a`. Which of two such numbers is less needs no
//! root either: `sign_of_sum` squares both sides.
//!
//! It takes microseconds, and is needed about never: [`crate::intersect::confirm`] says when.

mod dyadic;

pub(crate) use dyadic::{Dyadic, SignedRoot, cross, dot};

use crate::ray::ExactRay;
use dyadic::nearest_root;
use glam::DVec3;
use std::cmp::Ordering;

/// A ray and a sphere, exactly.
pub(crate) struct Encounter {
    a: Dyadic,
    b: Dyadic,
    outside: Dyadic,
    discriminant: Dyadic,
}

impl Encounter {
    pub(crate) fn new(ray: &ExactRay, center: DVec3, radius: f64) -> Self {
        let exact = |v: DVec3| v.to_array().map(Dyadic::new);
        let (origin, center) = (exact(ray.origin), exact(center));
        let from_center: [Dyadic; 3] = std::array::from_fn(|i| &origin[i] - &center[i]);
        Self::between(&from_center, &exact(ray.direction), &Dyadic::new(radius).square())
    }

    /// The origin is given relative to the center, and the square of the radius.
    pub(crate) fn between(
        from_center: &[Dyadic; 3],
        direction: &[Dyadic; 3],
        radius2: &Dyadic,
    ) -> Self {
        let a = dot(direction, direction);
        let b = -dot(from_center, direction);
        let outside = &dot(from_center, from_center) - radius2;
        let discriminant = &b.square() - &(&a * &outside);
        Self { a, b, outside, discriminant }
    }

    /// The sign with which the root of the discriminant enters the distance; `None` if there is no
    /// hit.
    pub(crate) fn root(&self) -> Option<i32> {
        let heads_in = self.b.sign() > 0;
        match self.outside.sign() {
            1 => (heads_in && self.discriminant.sign() >= 0).then_some(-1),
            -1 => (self.a.sign() > 0).then_some(1),
            // On the surface the discriminant is b squared: twice the way to the middle.
            _ => heads_in.then_some(1),
        }
    }

    /// Returns whether the line meets the sphere.
    pub(crate) fn meets(&self) -> bool {
        self.discriminant.sign() >= 0
    }

    /// The distance with a sign of the root of the discriminant.
    pub(crate) fn distance(self, sign: i32) -> Quotient {
        Quotient { p: self.b, sign, q: self.discriminant, a: self.a }
    }
}

/// Distance, in units of the direction's length, at which a ray hits a sphere, correct to a few
/// units of its last place; `None` if it does not. The ray's origin is taken as exact, all numbers
/// are finite.
pub fn hit(ray: &ExactRay, center: DVec3, radius: f64) -> Option<f64> {
    let encounter = Encounter::new(ray, center, radius);
    let sign = encounter.root()?;
    let (a, b) = (encounter.a.to_f64(), encounter.b.to_f64());
    let root = encounter.discriminant.to_f64().sqrt();
    // The form of the two in which nothing cancels.
    let sum = b.abs() + root;
    Some(if (b > 0.0) == (sign > 0) || b == 0.0 {
        sum / a
    } else {
        encounter.outside.to_f64().abs() / sum
    })
}

/// The double that is nearest to the distance at which a ray hits a sphere, of two the even one; `None` if it
/// does not. Otherwise as [`hit`], which is faster.
pub fn nearest_distance(ray: &ExactRay, center: DVec3, radius: f64) -> Option<f64> {
    let encounter = Encounter::new(ray, center, radius);
    let sign = encounter.root()?;
    let root = SignedRoot { sign, radicand: &encounter.discriminant };
    Some(nearest_root(&encounter.a, &encounter.b, root))
}

/// Outward unit normal where a ray hits a sphere, which it does, correct to a few units of the last
/// place: the perpendicular from the center to the line, and half the chord along it.
pub fn normal(ray: &ExactRay, center: DVec3, radius: f64) -> DVec3 {
    let encounter = Encounter::new(ray, center, radius);
    let sign = f64::from(encounter.root().unwrap_or(0));
    let exact = |v: DVec3| v.to_array().map(Dyadic::new);
    let (origin, center, direction) = (exact(ray.origin), exact(center), exact(ray.direction));
    let perpendicular: [f64; 3] = std::array::from_fn(|i| {
        let from_center = &origin[i] - &center[i];
        (&(&from_center * &encounter.a) + &(&direction[i] * &encounter.b)).to_f64()
    });
    let along = ray.direction * (sign * encounter.discriminant.to_f64().sqrt());
    (DVec3::from(perpendicular) + along).normalize_or(-ray.direction.normalize())
}

/// A distance along a ray, of a sphere or given.
#[derive(Clone, Copy, Debug)]
pub enum Distance {
    /// The distance at which the ray hits this sphere; it must hit it.
    Hit(DVec3, f64),
    /// This number.
    Number(f64),
}

/// A number `(p + sign sqrt(q)) / a`: the distance of a hit on a body without rounding. `a` is positive, `q` not negative.
#[derive(Clone, Debug)]
pub struct Quotient {
    pub(crate) p: Dyadic,
    pub(crate) sign: i32,
    pub(crate) q: Dyadic,
    pub(crate) a: Dyadic,
}

impl Quotient {
    /// A quotient of two numbers; `None` where the divisor is 0.
    pub(crate) fn ratio(dividend: Dyadic, divisor: Dyadic) -> Option<Self> {
        let zero = Dyadic::new(0.0);
        match divisor.sign() {
            0 => None,
            1 => Some(Self { p: dividend, sign: 0, q: zero, a: divisor }),
            _ => Some(Self { p: -dividend, sign: 0, q: zero, a: -divisor }),
        }
    }

    fn root(&self) -> SignedRoot<'_> {
        SignedRoot { sign: self.sign, radicand: &self.q }
    }

    /// -1, 0 or 1.
    pub(crate) fn sign(&self) -> i32 {
        sign_of_sum(&self.p, self.root(), SignedRoot { sign: 0, ..self.root() })
    }

    /// Compares two distances, exactly.
    pub fn compare(&self, other: &Self) -> Ordering {
        let (p, q) = (&self.p * &other.a, &self.q * &other.a.square());
        let (other_p, other_q) = (&other.p * &self.a, &other.q * &self.a.square());
        let root = SignedRoot { sign: self.sign, radicand: &q };
        let minus_other = SignedRoot { sign: -other.sign, radicand: &other_q };
        sign_of_sum(&(&p - &other_p), root, minus_other).cmp(&0)
    }

    /// The nearest number of double precision, of a positive number.
    pub fn nearest(&self) -> f64 {
        nearest_root(&self.a, &self.p, self.root())
    }
}

impl Distance {
    /// Returns the distance without rounding.
    pub fn value(&self, ray: &ExactRay) -> Quotient {
        match *self {
            Self::Hit(center, radius) => {
                let encounter = Encounter::new(ray, center, radius);
                let sign = encounter.root().unwrap_or(0);
                encounter.distance(sign)
            }
            Self::Number(t) => {
                let (p, q) = (Dyadic::new(t), Dyadic::new(0.0));
                Quotient { p, sign: 0, q, a: Dyadic::new(1.0) }
            }
        }
    }
}

/// Returns whether a point is inside a sphere, not on its surface; all numbers are finite.
pub fn is_inside(point: DVec3, center: DVec3, radius: f64) -> bool {
    let ray = ExactRay { origin: point, direction: DVec3::ZERO, origin_error: 0.0 };
    Encounter::new(&ray, center, radius).outside.sign() < 0
}

/// Compares two distances along a ray, exactly.
pub fn compare(ray: &ExactRay, first: &Distance, second: &Distance) -> Ordering {
    first.value(ray).compare(&second.value(ray))
}

/// The sign of `p + s1 sqrt(q1) + s2 sqrt(q2)`, a number and two roots.
pub(crate) fn sign_of_sum(p: &Dyadic, first: SignedRoot, second: SignedRoot) -> i32 {
    let (q1, q2) = (first.radicand, second.radicand);
    let (s1, s2) = (first.sign * q1.sign(), second.sign * q2.sign());
    let roots = match (s1, s2) {
        (0, s) | (s, 0) => s,
        (a, b) if a == b => a,
        _ => s1 * (q1 - q2).sign(),
    };
    if p.sign() * roots >= 0 {
        return if roots == 0 { p.sign() } else { roots };
    }
    // Opposite signs: the larger square decides. (s1 sqrt(q1) + s2 sqrt(q2))^2 = q1 + q2 + 2 s1 s2
    // sqrt(q1 q2).
    let mut rest = p.square();
    for (s, q) in [(s1, q1), (s2, q2)] {
        if s != 0 {
            rest = &rest - q;
        }
    }
    // sign(rest - 2 s1 s2 sqrt(q1 q2)), again by squares where the signs are alike.
    let product = s1 * s2;
    let larger = if rest.sign() * product <= 0 {
        if rest.sign() == 0 { -product } else { rest.sign() }
    } else {
        let four = Dyadic::new(4.0);
        product * (&rest.square() - &(&four * &(q1 * q2))).sign()
    };
    p.sign() * larger
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn number(x: f64) -> Dyadic {
        Dyadic::new(x)
    }

    #[test]
    fn tangents_hit_and_the_next_ray_misses() {
        let ray = |y: f64| ExactRay {
            origin: DVec3::new(-3.0, y, 0.0),
            direction: DVec3::new(0.5, 0.0, 0.0),
            origin_error: 0.0,
        };
        assert_eq!(hit(&ray(1.0), DVec3::ZERO, 1.0), Some(6.0));
        assert_eq!(hit(&ray(1.0_f64.next_up()), DVec3::ZERO, 1.0), None);
        assert!(hit(&ray(1.0_f64.next_down()), DVec3::ZERO, 1.0) < Some(6.0));
    }

    #[test]
    fn on_the_surface_the_direction_decides() {
        let ray = |x: f64| ExactRay {
            origin: DVec3::new(-1.0, 0.0, 0.0),
            direction: DVec3::new(x, 0.25, 0.0),
            origin_error: 0.0,
        };
        assert_eq!(hit(&ray(-1.0), DVec3::ZERO, 1.0), None);
        assert_eq!(hit(&ray(0.0), DVec3::ZERO, 1.0), None);
        assert_eq!(hit(&ray(0.25), DVec3::ZERO, 1.0), Some(4.0));
    }

    #[test]
    fn equal_roots_compare_equal() {
        let ray = ExactRay {
            origin: DVec3::new(-3.0, 0.3, 0.125),
            direction: DVec3::new(0.7, 0.0, 0.0),
            origin_error: 0.0,
        };
        // Mirror images at the ray's plane, and a sphere that is not.
        let above = Distance::Hit(DVec3::new(0.0, 0.3, 0.625), 1.0);
        let below = Distance::Hit(DVec3::new(0.0, 0.3, -0.375), 1.0);
        let nearer = Distance::Hit(DVec3::new(0.0, 0.3, 0.625), 1.0_f64.next_up());
        assert_eq!(compare(&ray, &above, &below), Ordering::Equal);
        assert_eq!(compare(&ray, &nearer, &above), Ordering::Less);
        assert_eq!(compare(&ray, &above, &Distance::Number(1e9)), Ordering::Less);
    }

    proptest! {
        /// Against integers, whose sums of roots double precision tells apart where they differ.
        #[test]
        fn sums_of_roots_have_the_right_sign(
            p in -60_i32..60, s1 in -1_i32..=1, q1 in 0_i32..900, s2 in -1_i32..=1, q2 in 0_i32..900,
        ) {
            let root = |s: i32, q: i32| f64::from(s) * f64::from(q).sqrt();
            let sum = f64::from(p) + root(s1, q1) + root(s2, q2);
            let expected = if sum.abs() < 1e-9 { 0 } else { sum.signum() as i32 };
            let (p, q1, q2) = (number(p.into()), number(q1.into()), number(q2.into()));
            let first = SignedRoot { sign: s1, radicand: &q1 };
            let second = SignedRoot { sign: s2, radicand: &q2 };
            prop_assert_eq!(sign_of_sum(&p, first, second), expected);
        }
    }
}
