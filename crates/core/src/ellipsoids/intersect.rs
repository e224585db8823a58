//! Ray against ellipsoid in double precision: the decision.
//!
//! The matrix `M` takes the ellipsoid to the unit sphere, the origin, relative to the center, to `y`, and the direction to `w`, at the
//! same distances. `|w|^2 - |y x w|^2` is the discriminant: the form of the sphere's test in which the offset of a far origin does not cancel.
//! The bounds of `y` and `w` cover cancellation: each number has one ([`Bounded`]).

use super::Ellipsoid;
use crate::body_tree::{Doubt, Part, sign};
use crate::bounded::{Bounded, BoundedVector};
use crate::ray::ExactRay;

/// As [`enters_at_origin`](crate::body_tree::Shape::enters_at_origin). The origin is on the surface if `|y|^2 - 1` is no more than a way of the
/// length of its error changes it.
#[inline(always)]
pub(super) fn enters_at_origin(ray: &ExactRay, ellipsoid: &Ellipsoid) -> Option<(bool, Part)> {
    let from = ray.origin - ellipsoid.center;
    let outside = ellipsoid.to_unit(from).length_squared() - 1.0;
    let gradient = ellipsoid.gradient(from);
    let is_on = outside.abs() <= 2.0 * gradient.length() * ray.origin_error;
    is_on.then(|| (ray.direction.dot(gradient) < 0.0, Part::Body))
}

/// The distances at which a line enters and leaves an ellipsoid; `None` if it misses it.
#[inline(always)]
pub(super) fn crossings(
    ray: &ExactRay,
    ellipsoid: &Ellipsoid,
) -> Result<Option<[Bounded; 2]>, Doubt> {
    let rows = ellipsoid.to_unit.map(BoundedVector::exact);
    let to_unit = |v: BoundedVector| BoundedVector(std::array::from_fn(|i| rows[i].dot(&v)));
    let y = to_unit(BoundedVector::between(ellipsoid.center, ray.origin));
    let w = to_unit(BoundedVector::exact(ray.direction));
    let a = w.dot(&w);
    if a.sign().is_none() {
        return Err(Doubt);
    }
    let off = y.cross(&w);
    let rest = a - off.dot(&off);
    if sign(rest)? < 0 {
        return Ok(None);
    }
    let (root, b) = (rest.sqrt(), -y.dot(&w));
    Ok(Some([(b - root) / a, (b + root) / a]))
}
