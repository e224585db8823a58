//! Ray against capsule in arithmetic without any rounding.
//!
//! With `F` from the first end to the origin, `d` the direction, `v` the axis, `n = d x v` and `m = F x v`, the line is in the
//! infinite cylinder about the axis between the distances `(-n.m -+ sqrt(D)) / n.n` with `D = v.v (n.n r^2 - (F.n)^2)`, by
//! Lagrange's identity. Where it enters, `y = (F + t d).v` says whether it enters the capsule there (`0 <= y <= v.v`), or on
//! the sphere about an end, if at all: a line that is in the cylinder at an end's plane is in that end's sphere.

use super::dyadic::{Dyadic, SignedRoot, cross, dot};
use super::{Encounter, Quotient, sign_of_sum};
use crate::capsule::{Capsule, Part};
use crate::ray::ExactRay;

/// The distance at which a ray hits a capsule.
#[derive(Clone, Copy, Debug)]
pub struct CapsuleRoot {
    /// The nearest double, in units of the direction's length, more than 0.
    pub t: f64,
    /// The part of the surface that is hit.
    pub part: Part,
}

/// Returns where a ray hits a capsule; `None` if it does not. The ray's origin is taken as exact, all numbers are finite.
pub fn capsule_hit(ray: &ExactRay, capsule: &Capsule) -> Option<CapsuleRoot> {
    first(ray, capsule).map(|(root, part)| CapsuleRoot { t: root.nearest(), part })
}

/// Returns the distance at which a line leaves a capsule, likewise; `None` if it misses it or leaves it before the origin.
pub fn capsule_exit(ray: &ExactRay, capsule: &Capsule) -> Option<f64> {
    let (leave, _) = Line::new(ray, capsule).crossing(1)?;
    (leave.sign() > 0).then(|| leave.nearest())
}

/// Returns the distance of the hit, and the part that is hit: where the line enters if that is ahead of the origin, or
/// else where it leaves if that is.
pub(super) fn first(ray: &ExactRay, capsule: &Capsule) -> Option<(Quotient, Part)> {
    let line = Line::new(ray, capsule);
    let enter = line.crossing(-1)?;
    if enter.0.sign() > 0 {
        return Some(enter);
    }
    line.crossing(1).filter(|leave| leave.0.sign() > 0)
}

/// A line and a capsule, exactly.
struct Line<'a> {
    ray: &'a ExactRay,
    capsule: &'a Capsule,
    from_start: [Dyadic; 3],
    direction: [Dyadic; 3],
    axis: [Dyadic; 3],
    radius2: Dyadic,
}

impl<'a> Line<'a> {
    fn new(ray: &'a ExactRay, capsule: &'a Capsule) -> Self {
        let exact = |v: glam::DVec3| v.to_array().map(Dyadic::new);
        let minus = |a: &[Dyadic; 3], b: &[Dyadic; 3]| std::array::from_fn(|i| &a[i] - &b[i]);
        let (origin, [start, end]) = (exact(ray.origin), capsule.ends.map(exact));
        Self {
            ray,
            capsule,
            from_start: minus(&origin, &start),
            direction: exact(ray.direction),
            axis: minus(&end, &start),
            radius2: Dyadic::new(capsule.radius).square(),
        }
    }

    /// Where the line enters (`sign` is -1) or leaves (1) the capsule; `None` if it misses it.
    fn crossing(&self, sign: i32) -> Option<(Quotient, Part)> {
        let (from, d, v) = (&self.from_start, &self.direction, &self.axis);
        let length2 = dot(v, v);
        if dot(d, d).sign() == 0 {
            return None;
        }
        if length2.sign() == 0 {
            return self.end(0, sign);
        }
        let (n, m) = (cross(d, v), cross(from, v));
        let (a, along) = (dot(&n, &n), dot(d, v));
        if a.sign() == 0 {
            let outside = &dot(&m, &m) - &(&self.radius2 * &length2);
            let end = usize::from((along.sign() < 0) == (sign < 0));
            return if outside.sign() > 0 { None } else { self.end(end, sign) };
        }
        let apart = dot(from, &n);
        let discriminant = &length2 * &(&(&a * &self.radius2) - &apart.square());
        if discriminant.sign() < 0 {
            return None;
        }
        let p = -dot(&n, &m);
        // Sign of the height over an end's plane, at the start's end `y`, at the other `y - v.v`.
        let (start, slope) = (dot(from, v), &p * &along);
        let radicand = &along.square() * &discriminant;
        let root = SignedRoot { sign: sign * along.sign(), radicand: &radicand };
        let zero = SignedRoot { sign: 0, ..root };
        let side = |start: &Dyadic| sign_of_sum(&(&(&a * start) + &slope), root, zero);
        if side(&start) < 0 {
            return self.end(0, sign);
        }
        if side(&(&start - &length2)) > 0 {
            return self.end(1, sign);
        }
        Some((Quotient { p, sign, q: discriminant, a }, Part::Body))
    }

    /// Where the line enters or leaves the sphere about an end.
    fn end(&self, end: usize, sign: i32) -> Option<(Quotient, Part)> {
        let Capsule { ends, radius } = self.capsule;
        let Encounter { a, b, discriminant, .. } = Encounter::new(self.ray, ends[end], *radius);
        let root = Quotient { p: b, sign, q: discriminant, a };
        (root.q.sign() >= 0).then_some((root, Part::End(end)))
    }
}
