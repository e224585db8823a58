//! The decision whether and where a ray hits a body, of the distances at which its line enters and leaves it.
//!
//! A kind of body computes these in double precision, with a bound of the error of every number ([`Bounded`]). A sign is taken from
//! them only where the value is beyond its bound; where one is not, [integers](crate::exact) decide all.

use super::Shape;
use crate::bounded::{Bounded, COARSE};
use crate::exact::Quotient;
use crate::intersect::Root;
use crate::ray::ExactRay;
use glam::DVec3;

/// A hit on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyHit {
    /// The distance.
    pub root: Root,
    /// The part of the surface that is hit.
    pub part: Part,
}

/// A part of a body's surface. A kind of body tells apart what it shares with others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// All that is no end.
    Body,
    /// The half sphere about the first or the second end of a capsule.
    End(usize),
}

/// Double precision cannot decide.
#[derive(Clone, Copy, Debug)]
pub struct Doubt;

/// The two points at which a line crosses the surface of a convex body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The nearer one.
    Enter,
    /// The farther one.
    Leave,
}

/// A line that may cross a body.
pub trait Line {
    /// Returns the distance at which the line enters or leaves the body, and the part of the surface there; `None` if it misses it.
    ///
    /// # Errors
    ///
    /// Fails where double precision cannot decide.
    fn crossing(&self, side: Side) -> Result<Option<(Bounded, Part)>, Doubt>;
}

/// The distances at which a line enters and leaves a body; for a surface without inside both are the same.
impl Line for [Bounded; 2] {
    #[inline(always)]
    fn crossing(&self, side: Side) -> Result<Option<(Bounded, Part)>, Doubt> {
        let [enter, leave] = *self;
        Ok(Some((if side == Side::Enter { enter } else { leave }, Part::Body)))
    }
}

impl Side {
    /// The sign with which the root of a discriminant enters the distance: -1 or 1.
    #[inline(always)]
    pub(crate) fn sign(self) -> i32 {
        if self == Self::Enter { -1 } else { 1 }
    }
}

/// The certain sign of a number: -1 or 1.
#[inline(always)]
pub(crate) fn sign(number: Bounded) -> Result<i32, Doubt> {
    number.sign().ok_or(Doubt)
}

/// [`Shape::intersect`].
#[inline(always)]
pub(crate) fn intersect<S: Shape>(ray: &ExactRay, body: &S) -> Option<BodyHit> {
    if ray.origin_error > 0.0
        && let Some((enters, part)) = body.enters_at_origin(ray)
    {
        let root = Root { t: 0.0, error: 0.0, exact: false };
        return enters.then_some(BodyHit { root, part });
    }
    decide(ray, body).unwrap_or_else(|Doubt| decide_exactly(ray, body))
}

/// [`Shape::exit_distance`].
pub(crate) fn exit_distance<S: Shape>(ray: &ExactRay, body: &S) -> f64 {
    let leave = |line: S::Line| line.crossing(Side::Leave);
    let t = match body.line(ray).and_then(|line| line.map_or(Ok(None), leave)) {
        Ok(crossing) => crossing.map_or(0.0, |(t, _)| t.value),
        Err(Doubt) if is_finite(ray, body) => {
            body.exact_exit(ray).map_or(0.0, |exit| exit.nearest())
        }
        Err(Doubt) => 0.0,
    };
    t.max(0.0)
}

#[inline(always)]
fn decide<S: Shape>(ray: &ExactRay, body: &S) -> Result<Option<BodyHit>, Doubt> {
    let Some(line) = body.line(ray)? else { return Ok(None) };
    let Some(enter) = line.crossing(Side::Enter)? else { return Ok(None) };
    let (t, part) = if sign(enter.0)? > 0 {
        enter
    } else {
        let Some(leave) = line.crossing(Side::Leave)? else { return Ok(None) };
        if sign(leave.0)? < 0 {
            return Ok(None);
        }
        leave
    };
    if t.error > t.value * COARSE {
        return Err(Doubt);
    }
    // An error of 0 would call it a given number.
    let error = t.error.max(f64::MIN_POSITIVE);
    Ok(Some(BodyHit { root: Root { t: t.value, error, exact: false }, part }))
}

#[cold]
#[inline(never)]
fn decide_exactly<S: Shape>(ray: &ExactRay, body: &S) -> Option<BodyHit> {
    let (distance, part) = is_finite(ray, body).then(|| body.exact_hit(ray)).flatten()?;
    let t = distance.nearest();
    // Rounded once.
    Some(BodyHit { root: Root { t, error: t * f64::EPSILON, exact: true }, part })
}

fn is_finite<S: Shape>(ray: &ExactRay, body: &S) -> bool {
    [ray.origin, ray.direction].into_iter().all(DVec3::is_finite) && body.is_finite()
}

/// Returns the first of two distances that is ahead of the origin: where a line enters and leaves a body.
pub(crate) fn first_ahead(crossings: [Quotient; 2]) -> Option<Quotient> {
    crossings.into_iter().find(|t| t.sign() > 0)
}

/// Returns a normal, or that against the ray for a body that is thinner than rounding: nothing else is known.
pub(crate) fn normal_or_against(ray: &ExactRay, normal: DVec3) -> DVec3 {
    if normal == DVec3::ZERO { -ray.direction.normalize() } else { normal }
}
