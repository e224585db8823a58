//! Ray against capsule in double precision: the decision.
//!
//! The formulas are those of the [exact test](crate::exact), with a bound of the error of every number ([`Bounded`]). A sign
//! is taken from double precision only where the value is beyond its bound; where one is not, integers decide all.
//!
//! The form of the discriminant, by the distance of two lines, and the choice of the part by the height of the point of entry
//! into the infinite cylinder are known from Quilez, "Intersectors" (2016), and Lagrange's identity.

use super::Capsule;
use crate::body_tree::{Doubt, Line, Part, Side, sign};
use crate::bounded::{Bounded, BoundedVector};
use crate::ray::ExactRay;
use glam::DVec3;

/// As [`enters_at_origin`](crate::body_tree::Shape::enters_at_origin).
#[inline(always)]
pub(super) fn enters_at_origin(ray: &ExactRay, capsule: &Capsule) -> Option<(bool, Part)> {
    let from = ray.origin - capsule.ends[0];
    let axis = capsule.ends[1] - capsule.ends[0];
    let (normal, along) = capsule.normal(from);
    let off = (from - axis * along).length() - capsule.radius;
    let part = match along {
        0.0 => Part::End(0),
        1.0 => Part::End(1),
        _ => Part::Body,
    };
    (off.abs() <= ray.origin_error).then(|| (ray.direction.dot(normal) < 0.0, part))
}

/// A line, and the infinite cylinder about a capsule's axis.
#[derive(Clone, Copy, Debug)]
pub struct CapsuleLine {
    origin: DVec3,
    capsule: Capsule,
    direction: BoundedVector,
    /// As in the exact test: `n.n`, `-n.m` and the root of the discriminant; `F.v`, `d.v` and `v.v`. `None` for a capsule
    /// that is a sphere.
    cylinder: Option<[Bounded; 6]>,
}

impl CapsuleLine {
    /// Returns `None` if the line misses the cylinder.
    pub(super) fn new(ray: &ExactRay, capsule: &Capsule) -> Result<Option<Self>, Doubt> {
        let ([start, end], origin) = (capsule.ends, ray.origin);
        let direction = BoundedVector::exact(ray.direction);
        if start == end {
            return Ok(Some(Self { origin, capsule: *capsule, direction, cylinder: None }));
        }
        let (from, axis) =
            (BoundedVector::between(start, origin), BoundedVector::between(start, end));
        let normal = direction.cross(&axis);
        let a = normal.dot(&normal);
        if a.sign().is_none() {
            // About parallel.
            return Err(Doubt);
        }
        let rest = a * Bounded::exact(capsule.radius).square() - from.dot(&normal).square();
        if sign(rest)? < 0 {
            return Ok(None);
        }
        let length2 = axis.dot(&axis);
        let p = -normal.dot(&from.cross(&axis));
        let root = (length2 * rest).sqrt();
        let cylinder = Some([a, p, root, from.dot(&axis), direction.dot(&axis), length2]);
        Ok(Some(Self { origin, capsule: *capsule, direction, cylinder }))
    }

    /// Where the line enters or leaves the sphere about an end.
    #[inline(always)]
    fn end(&self, end: usize, side: Side) -> Result<Option<(Bounded, Part)>, Doubt> {
        let from = BoundedVector::between(self.capsule.ends[end], self.origin);
        let a = self.direction.dot(&self.direction);
        if a.sign().is_none() {
            return Err(Doubt);
        }
        let off = from.cross(&self.direction);
        let rest = a * Bounded::exact(self.capsule.radius).square() - off.dot(&off);
        if sign(rest)? < 0 {
            return Ok(None);
        }
        let t = (signed(rest.sqrt(), side) - from.dot(&self.direction)) / a;
        Ok(Some((t, Part::End(end))))
    }
}

impl Line for CapsuleLine {
    #[inline(always)]
    fn crossing(&self, side: Side) -> Result<Option<(Bounded, Part)>, Doubt> {
        let Some([a, p, root, start, slope, length2]) = self.cylinder else {
            return self.end(0, side);
        };
        let t = (p + signed(root, side)) / a;
        let height = start + t * slope;
        if sign(height)? < 0 {
            return self.end(0, side);
        }
        if sign(height - length2)? > 0 {
            return self.end(1, side);
        }
        Ok(Some((t, Part::Body)))
    }
}

/// A root with the sign of a side.
#[inline(always)]
fn signed(root: Bounded, side: Side) -> Bounded {
    Bounded::exact(f64::from(side.sign())) * root
}
