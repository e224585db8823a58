//! Ray against capsule in double precision: the decision.
//!
//! The formulas are those of the [exact test](crate::exact), with a bound of the error of every number ([`Bounded`]). A sign
//! is taken from double precision only where the value is beyond its bound; where one is not, integers decide all.
//!
//! The form of the discriminant, by the distance of two lines, and the choice of the part by the height of the point of entry
//! into the infinite cylinder are known from Quilez, "Intersectors" (2016), and Lagrange's identity.

use super::{Capsule, Part};
use crate::bounded::{Bounded, BoundedVector, COARSE};
use crate::exact;
use crate::intersect::Root;
use crate::ray::ExactRay;
use glam::DVec3;

/// Relative error of a distance that integers gave, which is rounded once.
const NEAREST: f64 = f64::EPSILON;

/// A hit on a capsule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CapsuleHit {
    /// The distance.
    pub root: Root,
    /// The part of the surface that is hit.
    pub part: Part,
}

/// Double precision cannot decide.
struct Doubt;

/// Decides whether and where a ray hits a capsule; the answer is that of arithmetic without rounding.
///
/// Outside, that is where it enters; inside, where it leaves; a tangent hits. Where the origin is on the surface the direction
/// decides: a ray that leaves misses, a ray that enters hits the far side. On the surface is exactly so, or for an origin that
/// was rounded itself ([`ExactRay::origin_error`]) within that rounding; then a ray that enters hits at once. Zero directions,
/// and anything infinite or NaN, miss.
pub fn intersect(ray: &ExactRay, capsule: &Capsule) -> Option<CapsuleHit> {
    if ray.origin_error > 0.0
        && let Some((part, normal)) = surface_at_origin(ray, capsule)
    {
        let root = Root { t: 0.0, error: 0.0, exact: false };
        return (ray.direction.dot(normal) < 0.0).then_some(CapsuleHit { root, part });
    }
    decide(ray, capsule).unwrap_or_else(|Doubt| decide_exactly(ray, capsule))
}

/// Returns the part of the surface on which the origin is, within its own rounding, and the outward normal there; `None` if it
/// is elsewhere.
#[inline(always)]
fn surface_at_origin(ray: &ExactRay, capsule: &Capsule) -> Option<(Part, DVec3)> {
    let from = ray.origin - capsule.ends[0];
    let axis = capsule.ends[1] - capsule.ends[0];
    let (normal, along) = capsule.normal(from);
    let off = (from - axis * along).length() - capsule.radius;
    let part = match along {
        0.0 => Part::End(0),
        1.0 => Part::End(1),
        _ => Part::Body,
    };
    (off.abs() <= ray.origin_error).then_some((part, normal))
}

#[cold]
#[inline(never)]
fn decide_exactly(ray: &ExactRay, capsule: &Capsule) -> Option<CapsuleHit> {
    let hit = is_finite(ray, capsule).then(|| exact::capsule_hit(ray, capsule)).flatten()?;
    let root = Root { t: hit.t, error: hit.t * NEAREST, exact: true };
    Some(CapsuleHit { root, part: hit.part })
}

fn is_finite(ray: &ExactRay, capsule: &Capsule) -> bool {
    let [start, end] = capsule.ends;
    [ray.origin, ray.direction, start, end].into_iter().all(DVec3::is_finite)
        && capsule.radius.is_finite()
}

/// Returns the distance at which a line leaves a capsule, ahead of its origin, which is on the surface or inside, within
/// rounding; 0 if it has left it.
pub fn exit_distance(ray: &ExactRay, capsule: &Capsule) -> f64 {
    let leave = |line: Line| line.crossing(Bounded::exact(1.0));
    let t = match Line::new(ray, capsule).and_then(|line| line.map_or(Ok(None), leave)) {
        Ok(crossing) => crossing.map_or(0.0, |(t, _)| t.value),
        Err(Doubt) if is_finite(ray, capsule) => exact::capsule_exit(ray, capsule).unwrap_or(0.0),
        Err(Doubt) => 0.0,
    };
    t.max(0.0)
}

fn decide(ray: &ExactRay, capsule: &Capsule) -> Result<Option<CapsuleHit>, Doubt> {
    let Some(line) = Line::new(ray, capsule)? else { return Ok(None) };
    let Some(enter) = line.crossing(Bounded::exact(-1.0))? else { return Ok(None) };
    let (t, part) = if enter.0.sign().ok_or(Doubt)? > 0 {
        enter
    } else {
        let Some(leave) = line.crossing(Bounded::exact(1.0))? else { return Ok(None) };
        if leave.0.sign().ok_or(Doubt)? < 0 {
            return Ok(None);
        }
        leave
    };
    if t.error > t.value * COARSE {
        return Err(Doubt);
    }
    // An error of 0 would call it a given number.
    let error = t.error.max(f64::MIN_POSITIVE);
    Ok(Some(CapsuleHit { root: Root { t: t.value, error, exact: false }, part }))
}

/// A line, and the infinite cylinder about a capsule's axis.
struct Line<'a> {
    ray: &'a ExactRay,
    capsule: &'a Capsule,
    direction: BoundedVector,
    /// As in the exact test: `n.n`, `-n.m` and the root of the discriminant; `F.v`, `d.v` and `v.v`. `None` for a capsule
    /// that is a sphere.
    cylinder: Option<[Bounded; 6]>,
}

impl<'a> Line<'a> {
    /// Returns `None` if the line misses the cylinder.
    fn new(ray: &'a ExactRay, capsule: &'a Capsule) -> Result<Option<Self>, Doubt> {
        let [start, end] = capsule.ends;
        let direction = BoundedVector::exact(ray.direction);
        if start == end {
            return Ok(Some(Self { ray, capsule, direction, cylinder: None }));
        }
        let (from, axis) =
            (BoundedVector::between(start, ray.origin), BoundedVector::between(start, end));
        let normal = direction.cross(&axis);
        let a = normal.dot(&normal);
        if a.sign().is_none() {
            // About parallel.
            return Err(Doubt);
        }
        let rest = a * Bounded::exact(capsule.radius).square() - from.dot(&normal).square();
        if rest.sign().ok_or(Doubt)? < 0 {
            return Ok(None);
        }
        let length2 = axis.dot(&axis);
        let p = -normal.dot(&from.cross(&axis));
        let root = (length2 * rest).sqrt();
        let cylinder = Some([a, p, root, from.dot(&axis), direction.dot(&axis), length2]);
        Ok(Some(Self { ray, capsule, direction, cylinder }))
    }

    /// Where the line enters (`sign` is -1) or leaves (1) the capsule; `None` if it misses it.
    #[inline(always)]
    fn crossing(&self, sign: Bounded) -> Result<Option<(Bounded, Part)>, Doubt> {
        let Some([a, p, root, start, slope, length2]) = self.cylinder else {
            return self.end(0, sign);
        };
        let t = (p + sign * root) / a;
        let height = start + t * slope;
        if height.sign().ok_or(Doubt)? < 0 {
            return self.end(0, sign);
        }
        if (height - length2).sign().ok_or(Doubt)? > 0 {
            return self.end(1, sign);
        }
        Ok(Some((t, Part::Body)))
    }

    /// Where the line enters or leaves the sphere about an end.
    #[inline(always)]
    fn end(&self, end: usize, sign: Bounded) -> Result<Option<(Bounded, Part)>, Doubt> {
        let from = BoundedVector::between(self.capsule.ends[end], self.ray.origin);
        let a = self.direction.dot(&self.direction);
        if a.sign().is_none() {
            return Err(Doubt);
        }
        let off = from.cross(&self.direction);
        let rest = a * Bounded::exact(self.capsule.radius).square() - off.dot(&off);
        if rest.sign().ok_or(Doubt)? < 0 {
            return Ok(None);
        }
        let t = (sign * rest.sqrt() - from.dot(&self.direction)) / a;
        Ok(Some((t, Part::End(end))))
    }
}
