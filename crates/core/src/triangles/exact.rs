//! Ray against triangle in arithmetic without any rounding.
//!
//! With `F` from the origin to the first corner, the direction `d`, the edges `e1` and `e2` from that corner, `N = e1 x e2` and `M = F x d`: the
//! line meets the plane at `F.N / d.N`, and the volumes
//!
//! ```text
//! v2 = e2.M     v3 = -e1.M     v1 = d.N - v2 - v3
//! ```
//!
//! are those of the line with the edges across from the second, the third and the first corner, and `d.N` times the barycentric coordinates
//! of the point. The volume of an edge is the same for both triangles that share it, but for its sign. So a line between two triangles meets
//! at least one of them.

use super::Triangle;
use crate::body_tree::first_ahead;
use crate::exact::{Dyadic, Quotient, cross, dot};
use crate::ray::ExactRay;
use glam::DVec3;
use std::cmp::Ordering;

fn exact(v: DVec3) -> [Dyadic; 3] {
    v.to_array().map(Dyadic::new)
}

fn minus(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> [Dyadic; 3] {
    std::array::from_fn(|i| &a[i] - &b[i])
}

/// [`Triangle::area_normal`], each coordinate but for one unit of its last place.
#[cold]
pub(super) fn area_normal(triangle: &Triangle) -> DVec3 {
    let [first, second, third] = triangle.corners.map(exact);
    let normal = cross(&minus(&second, &first), &minus(&third, &first));
    DVec3::from(normal.map(|x| x.to_f64()))
}

/// The distance at which a ray hits a triangle; `None` if it does not.
pub(super) fn hit(ray: &ExactRay, triangle: &Triangle) -> Option<Quotient> {
    let (origin, d, corners) =
        (exact(ray.origin), exact(ray.direction), triangle.corners.map(exact));
    let [first, second, third] = &corners;
    let (from, edges) = (minus(first, &origin), [minus(second, first), minus(third, first)]);
    let normal = cross(&edges[0], &edges[1]);
    let (height, slope) = (dot(&from, &normal), dot(&d, &normal));
    if slope.sign() == 0 {
        return if height.sign() == 0 {
            hit_in_plane(&origin, &d, &corners, &normal)
        } else {
            None
        };
    }
    let moment = cross(&from, &d);
    let (volume2, volume3) = (dot(&edges[1], &moment), -dot(&edges[0], &moment));
    let volume1 = &(&slope - &volume2) - &volume3;
    if [volume1, volume2, volume3].iter().any(|volume| volume.sign() * slope.sign() < 0) {
        return None;
    }
    Quotient::ratio(height, slope).filter(|t| t.sign() > 0)
}

/// The distance at which a ray in the plane of a triangle enters it, or leaves it if it starts there.
fn hit_in_plane(
    origin: &[Dyadic; 3],
    d: &[Dyadic; 3],
    corners: &[[Dyadic; 3]; 3],
    normal: &[Dyadic; 3],
) -> Option<Quotient> {
    let (mut enter, mut leave) = (None::<Quotient>, None::<Quotient>);
    for (i, start) in corners.iter().enumerate() {
        let inward = cross(normal, &minus(&corners[(i + 1) % 3], start));
        let (inside, slope) = (dot(&inward, &minus(origin, start)), dot(&inward, d));
        let (bound, later) = match slope.sign() {
            0 if inside.sign() < 0 => return None,
            0 => continue,
            1 => (&mut enter, Ordering::Greater),
            _ => (&mut leave, Ordering::Less),
        };
        let t = Quotient::ratio(-inside, slope)?;
        if bound.as_ref().is_none_or(|bound| t.compare(bound) == later) {
            *bound = Some(t);
        }
    }
    let (enter, leave) = (enter?, leave?);
    if enter.compare(&leave) == Ordering::Greater {
        return None;
    }
    first_ahead([enter, leave])
}
