//! Ray against cone in double precision: the decision.
//!
//! The formulas are those of the exact test, with a bound of the error of every number ([`Bounded`]). The discriminant is formed from the
//! moment of the line about the apex, in which the offset of a far origin does not cancel.

use super::Cone;
use crate::body_tree::{Doubt, Part, sign};
use crate::bounded::{Bounded, BoundedVector};
use crate::ray::ExactRay;

/// As [`enters_at_origin`](crate::body_tree::Shape::enters_at_origin).
#[inline(always)]
pub(super) fn enters_at_origin(ray: &ExactRay, cone: &Cone) -> Option<(bool, Part)> {
    let from = ray.origin - cone.apex;
    let distances = cone.distances(from);
    let outside = distances[0].max(distances[1]);
    let enters = |(face, distance)| {
        let is_on = distance >= -ray.origin_error;
        !is_on || ray.direction.dot(cone.normal_of(face, from)) < 0.0
    };
    let is_on = outside.abs() <= ray.origin_error;
    is_on.then(|| (super::FACES.into_iter().zip(distances).all(enters), Part::Body))
}

/// The distances at which a line enters and leaves a cone; `None` if it misses it.
#[inline(always)]
pub(super) fn crossings(ray: &ExactRay, cone: &Cone) -> Result<Option<[Bounded; 2]>, Doubt> {
    let d = BoundedVector::exact(ray.direction);
    let from = BoundedVector::between(cone.apex, ray.origin);
    let axis = BoundedVector::between(cone.apex, cone.base);
    let (height2, radius2) = (axis.dot(&axis), Bounded::exact(cone.radius).square());
    let moment = d.cross(&from);
    let across = axis.cross(&moment);
    let rest = radius2 * across.dot(&across) - height2 * axis.dot(&moment).square();
    let (start, slope) = (from.dot(&axis), d.dot(&axis));
    let (scale, slant2) = (height2.square(), height2 + radius2);
    let a = scale * d.dot(&d) - slant2 * slope.square();
    let steep = sign(a)? > 0;
    if sign(rest)? < 0 {
        return if steep { Ok(None) } else { Err(Doubt) };
    }
    let (root, b) = (height2 * rest.sqrt(), slant2 * (start * slope) - scale * d.dot(&from));
    let [first, second] = [(b - root) / a, (b + root) / a];
    // How far within the base a point of the line is, in units of the axis.
    let within_base = |t: Bounded| height2 - (start + t * slope);
    let at_base = || (height2 - start) / slope;
    if steep {
        // Both are on one half of the double cone: that of the middle of the chord.
        if sign(axis.dot(&moment.cross(&d)))? < 0 {
            return Ok(None);
        }
        return Ok(match (sign(within_base(first))? > 0, sign(within_base(second))? > 0) {
            (true, true) => Some([first, second]),
            (true, false) => Some([first, at_base()]),
            (false, true) => Some([at_base(), second]),
            (false, false) => None,
        });
    }
    // The line meets both halves. Of negative divisors the second root is the nearer one.
    let (other, nearer) = (first, second);
    let forward = sign(slope)? > 0;
    let at_side = if forward { other } else { nearer };
    if sign(within_base(at_side))? < 0 {
        return Ok(None);
    }
    Ok(Some(if forward { [at_side, at_base()] } else { [at_base(), at_side] }))
}
