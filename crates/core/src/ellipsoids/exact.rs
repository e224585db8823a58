//! Ray against ellipsoid in arithmetic without any rounding.
//!
//! The matrix `M` takes the ellipsoid to the unit sphere, `F` from the center to the origin to `M F`, and the direction `d` to
//! `M d`: sums of products, so dyadic numbers as well. Distances along the ray stay the same, so the rest is the encounter with a sphere of
//! radius 1.

use super::Ellipsoid;
use crate::exact::{Dyadic, Encounter, Quotient, dot};
use crate::ray::ExactRay;
use glam::DVec3;

/// Returns the distance at which a ray hits an ellipsoid; `None` if it does not.
pub(super) fn hit(ray: &ExactRay, ellipsoid: &Ellipsoid) -> Option<Quotient> {
    let exact = |v: DVec3| v.to_array().map(Dyadic::new);
    let (origin, center, direction) =
        (exact(ray.origin), exact(ellipsoid.center), exact(ray.direction));
    let from_center: [Dyadic; 3] = std::array::from_fn(|i| &origin[i] - &center[i]);
    let rows = ellipsoid.to_unit.map(exact);
    let to_unit = |v: &[Dyadic; 3]| std::array::from_fn(|i| dot(&rows[i], v));
    let encounter =
        Encounter::between(&to_unit(&from_center), &to_unit(&direction), &Dyadic::new(1.0));
    let sign = encounter.root()?;
    Some(encounter.distance(sign))
}
