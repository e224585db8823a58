//! Ray against capsule in arithmetic without any rounding.
//!
//! With `F` from the first end to the origin, `d` the direction, `v` the axis, `n = d x v` and `m = F x v`, the line is in the
//! infinite cylinder about the axis between the distances `(-n.m -+ sqrt(D)) / n.n` with `D = v.v (n.n r^2 - (F.n)^2)`, by
//! Lagrange's identity. Where it enters, `y = (F + t d).v` says whether it enters the capsule there (`0 <= y <= v.v`), or on
//! the sphere about an end, if at all: a line that is in the cylinder at an end's plane is in that end's sphere.

use super::Capsule;
use crate::body_tree::{Part, Side};
use crate::exact::{Dyadic, Encounter, Quotient, SignedRoot, cross, dot, sign_of_sum};
use crate::ray::ExactRay;

/// Returns where a ray hits a capsule: where its line enters it if that is ahead of the origin, or else where it leaves it if that
/// is.
pub(super) fn hit(ray: &ExactRay, capsule: &Capsule) -> Option<(Quotient, Part)> {
    let line = Line::new(ray, capsule);
    let enter = line.crossing(Side::Enter)?;
    if enter.0.sign() > 0 {
        return Some(enter);
    }
    line.crossing(Side::Leave).filter(|leave| leave.0.sign() > 0)
}

/// Returns where the line leaves the capsule, ahead of the origin.
pub(super) fn exit(ray: &ExactRay, capsule: &Capsule) -> Option<Quotient> {
    let (leave, _) = Line::new(ray, capsule).crossing(Side::Leave)?;
    (leave.sign() > 0).then_some(leave)
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

    /// Returns the distance at which the line enters or leaves the capsule; `None` if it misses it.
    fn crossing(&self, side: Side) -> Option<(Quotient, Part)> {
        let (from, d, v) = (&self.from_start, &self.direction, &self.axis);
        let length2 = dot(v, v);
        if dot(d, d).sign() == 0 {
            return None;
        }
        if length2.sign() == 0 {
            return self.end(0, side);
        }
        let (n, m) = (cross(d, v), cross(from, v));
        let (a, along) = (dot(&n, &n), dot(d, v));
        if a.sign() == 0 {
            let outside = &dot(&m, &m) - &(&self.radius2 * &length2);
            let end = usize::from((along.sign() < 0) == (side == Side::Enter));
            return if outside.sign() > 0 { None } else { self.end(end, side) };
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
        let root = SignedRoot { sign: side.sign() * along.sign(), radicand: &radicand };
        let zero = SignedRoot { sign: 0, ..root };
        let over = |start: &Dyadic| sign_of_sum(&(&(&a * start) + &slope), root, zero);
        if over(&start) < 0 {
            return self.end(0, side);
        }
        if over(&(&start - &length2)) > 0 {
            return self.end(1, side);
        }
        Some((Quotient { p, sign: side.sign(), q: discriminant, a }, Part::Body))
    }

    /// Where the line enters or leaves the sphere about an end.
    fn end(&self, end: usize, side: Side) -> Option<(Quotient, Part)> {
        let Capsule { ends, radius } = self.capsule;
        let sphere = Encounter::new(self.ray, ends[end], *radius);
        sphere.meets().then(|| (sphere.distance(side.sign()), Part::End(end)))
    }
}
