//! Ray against cone in double precision: the decision.
//!
//! The formulas are those of the exact test, with a bound of the error of every number ([`Bounded`]). The discriminant is formed from the
//! moment of the line about the apex, in which the offset of a far origin does not cancel. A sign is taken from double precision
//! only where the value is beyond its bound; where one is not, [integers](crate::exact) decide all.

use super::Cone;
use crate::bounded::{Bounded, BoundedVector, COARSE};
use crate::exact;
use crate::intersect::Root;
use crate::ray::ExactRay;
use glam::DVec3;

/// Double precision cannot decide.
struct Doubt;

/// Decides whether and where a ray hits a cone; the answer is that of arithmetic without rounding on the stored apex, center of the
/// base, and radius.
///
/// Outside, that is where it enters; inside, where it leaves. The cone is closed: a ray that touches it at a point or along a line, at the
/// apex or at the rim too, hits. Where the origin is on the surface the direction decides: a ray that leaves misses, one that
/// enters hits the far side, and one that runs along a face hits its edge. On the surface is exactly so, or for an origin that was rounded itself
/// ([`ExactRay::origin_error`]) within that rounding; then a ray that enters hits at once. Zero directions, and anything
/// infinite or NaN, miss.
pub fn intersect(ray: &ExactRay, cone: &Cone) -> Option<Root> {
    if ray.origin_error > 0.0 {
        let from = ray.origin - cone.apex;
        let distances = cone.distances(from);
        let outside = distances[0].max(distances[1]);
        if outside.abs() <= ray.origin_error {
            let enters = super::FACES.into_iter().zip(distances).all(|(face, distance)| {
                let is_on = distance >= -ray.origin_error;
                !is_on || ray.direction.dot(cone.normal_of(face, from)) < 0.0
            });
            return enters.then_some(Root { t: 0.0, error: 0.0, exact: false });
        }
    }
    decide(ray, cone).unwrap_or_else(|Doubt| decide_exactly(ray, cone))
}

#[cold]
#[inline(never)]
fn decide_exactly(ray: &ExactRay, cone: &Cone) -> Option<Root> {
    let t = is_finite(ray, cone).then(|| exact::cone_hit(ray, cone)).flatten()?;
    // Rounded once.
    Some(Root { t, error: t * f64::EPSILON, exact: true })
}

fn is_finite(ray: &ExactRay, cone: &Cone) -> bool {
    [ray.origin, ray.direction, cone.apex, cone.base].into_iter().all(DVec3::is_finite)
        && cone.radius.is_finite()
}

/// Returns the distance at which a line leaves a cone, ahead of its origin, which is on the surface or inside, within
/// rounding; 0 if it has left it.
pub fn exit_distance(ray: &ExactRay, cone: &Cone) -> f64 {
    let t = match crossings(ray, cone) {
        Ok(crossings) => crossings.map_or(0.0, |[_, leave]| leave.value),
        Err(Doubt) if is_finite(ray, cone) => exact::cone_exit(ray, cone).unwrap_or(0.0),
        Err(Doubt) => 0.0,
    };
    t.max(0.0)
}

fn decide(ray: &ExactRay, cone: &Cone) -> Result<Option<Root>, Doubt> {
    let Some([enter, leave]) = crossings(ray, cone)? else { return Ok(None) };
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

/// The distances at which a line enters and leaves a cone; `None` if it misses it.
#[inline(always)]
fn crossings(ray: &ExactRay, cone: &Cone) -> Result<Option<[Bounded; 2]>, Doubt> {
    let sign = |x: Bounded| x.sign().ok_or(Doubt);
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
