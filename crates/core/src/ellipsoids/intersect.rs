//! Ray against ellipsoid in double precision: the decision.
//!
//! The matrix `M` takes the ellipsoid to the unit sphere, the origin, relative to the center, to `y`, and the direction to `w`, at the
//! same distances. `|w|^2 - |y x w|^2` is the discriminant: the form of the sphere's test in which the offset of a far origin does not cancel.
//! The bounds of `y` and `w` cover cancellation: each number has one ([`Bounded`]). A sign is taken from double precision only where
//! the value is beyond its bound; where one is not, [integers](crate::exact) decide all.

use super::Ellipsoid;
use crate::bounded::{Bounded, BoundedVector, COARSE};
use crate::exact;
use crate::intersect::Root;
use crate::ray::ExactRay;

/// Double precision cannot decide.
struct Doubt;

/// Decides whether and where a ray hits an ellipsoid; the answer is that of arithmetic without rounding on the stored center
/// and matrix.
///
/// Outside, that is where it enters; inside, where it leaves; a tangent hits. Where the origin is on the surface the direction
/// decides: a ray that leaves misses, a ray that enters hits the far side. On the surface is exactly so, or for an origin that
/// was rounded itself ([`ExactRay::origin_error`]) within that rounding; then a ray that enters hits at once. Zero directions,
/// and anything infinite or NaN, miss.
pub fn intersect(ray: &ExactRay, ellipsoid: &Ellipsoid) -> Option<Root> {
    if ray.origin_error > 0.0 && is_surface_at_origin(ray, ellipsoid) {
        let normal = ellipsoid.gradient(ray.origin - ellipsoid.center);
        let root = Root { t: 0.0, error: 0.0, exact: false };
        return (ray.direction.dot(normal) < 0.0).then_some(root);
    }
    decide(ray, ellipsoid).unwrap_or_else(|Doubt| decide_exactly(ray, ellipsoid))
}

/// Returns whether the origin is on the surface, within its own rounding: `|y|^2 - 1` is no more than a way of that length changes
/// it.
#[inline(always)]
fn is_surface_at_origin(ray: &ExactRay, ellipsoid: &Ellipsoid) -> bool {
    let from = ray.origin - ellipsoid.center;
    let outside = ellipsoid.to_unit(from).length_squared() - 1.0;
    let slope = 2.0 * ellipsoid.gradient(from).length();
    outside.abs() <= slope * ray.origin_error
}

#[cold]
#[inline(never)]
fn decide_exactly(ray: &ExactRay, ellipsoid: &Ellipsoid) -> Option<Root> {
    let finite = ray.origin.is_finite()
        && ray.direction.is_finite()
        && ellipsoid.center.is_finite()
        && ellipsoid.to_unit.iter().all(|row| row.is_finite());
    let t = finite.then(|| exact::ellipsoid_hit(ray, ellipsoid)).flatten()?;
    // Rounded once.
    Some(Root { t, error: t * f64::EPSILON, exact: true })
}

/// Returns the distance at which a line leaves an ellipsoid, ahead of its origin, which is on the surface or inside, within
/// rounding; 0 if it has left it.
pub fn exit_distance(ray: &ExactRay, ellipsoid: &Ellipsoid) -> f64 {
    let t = match crossings(ray, ellipsoid) {
        Ok(crossings) => crossings.map_or(0.0, |[_, leave]| leave.value),
        // From inside, and otherwise as close to the surface as can be.
        Err(Doubt) => decide_exactly(ray, ellipsoid).map_or(0.0, |root| root.t),
    };
    t.max(0.0)
}

fn decide(ray: &ExactRay, ellipsoid: &Ellipsoid) -> Result<Option<Root>, Doubt> {
    let Some([enter, leave]) = crossings(ray, ellipsoid)? else { return Ok(None) };
    let t = if enter.sign().ok_or(Doubt)? > 0 {
        enter
    } else if leave.sign().ok_or(Doubt)? > 0 {
        leave
    } else {
        return Ok(None);
    };
    if t.error > t.value * COARSE {
        return Err(Doubt);
    }
    // An error of 0 would call it a given number.
    let error = t.error.max(f64::MIN_POSITIVE);
    Ok(Some(Root { t: t.value, error, exact: false }))
}

/// The distances at which a line enters and leaves an ellipsoid; `None` if it misses it.
#[inline(always)]
fn crossings(ray: &ExactRay, ellipsoid: &Ellipsoid) -> Result<Option<[Bounded; 2]>, Doubt> {
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
    if rest.sign().ok_or(Doubt)? < 0 {
        return Ok(None);
    }
    let (root, b) = (rest.sqrt(), -y.dot(&w));
    Ok(Some([(b - root) / a, (b + root) / a]))
}
