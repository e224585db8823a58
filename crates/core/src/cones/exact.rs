//! Ray against cone in arithmetic without any rounding.
//!
//! With `F` from the apex to the origin, the direction `d`, the axis `v` from the apex to the base, `H = v.v`, `L = H + r^2`, `f = F.v` and
//! `g = d.v`: a point of the line is within the infinite double cone where `a t^2 - 2 b t + c <= 0`, with
//!
//! ```text
//! a = H^2 d.d - L g^2     b = L f g - H^2 d.F     c = H^2 F.F - L f^2
//! ```
//!
//! and `b^2 - a c = H^2 E`, `E = r^2 |v x N|^2 - H (v.N)^2`, `N = d x F`. Its height, in units of the axis, is `(f + t g)/H`: it is between 0 and 1
//! within the cone. All these are sums of products of dyadic numbers.

use super::Cone;
use crate::exact::{Dyadic, Quotient, cross, dot};
use crate::ray::ExactRay;
use glam::DVec3;
use std::cmp::Ordering;

/// The distances at which a line enters and leaves a cone; `None` if it misses it.
pub(super) fn crossings(ray: &ExactRay, cone: &Cone) -> Option<[Quotient; 2]> {
    let exact = |v: DVec3| v.to_array().map(Dyadic::new);
    let (origin, d) = (exact(ray.origin), exact(ray.direction));
    let (apex, base) = (exact(cone.apex), exact(cone.base));
    let from: [Dyadic; 3] = std::array::from_fn(|i| &origin[i] - &apex[i]);
    let axis: [Dyadic; 3] = std::array::from_fn(|i| &base[i] - &apex[i]);
    let (height2, radius2) = (dot(&axis, &axis), Dyadic::new(cone.radius).square());
    let (start, slope) = (dot(&from, &axis), dot(&d, &axis));
    let (scale, slant2) = (height2.square(), &height2 + &radius2);
    let a = &(&scale * &dot(&d, &d)) - &(&slant2 * &slope.square());
    let b = &(&slant2 * &(&start * &slope)) - &(&scale * &dot(&d, &from));
    let moment = cross(&d, &from);
    let across = cross(&axis, &moment);
    let rest = &(&radius2 * &dot(&across, &across)) - &(&height2 * &dot(&axis, &moment).square());
    let discriminant = &scale * &rest;
    let zero = || Dyadic::new(0.0);
    // `(f + t g)` is at 0 or at `H`.
    let at_height = |height: Dyadic| Quotient::ratio(&height - &start, slope.clone());
    let (apex_plane, base_plane) = (at_height(zero()), at_height(height2.clone()));
    let root = |sign: i32| Quotient { p: b.clone(), sign, q: discriminant.clone(), a: a.clone() };
    // Parts of the line that are within the double cone, as far as they go; then those between both planes.
    let (mut enter, mut leave) = match a.sign() {
        1 if rest.sign() < 0 => return None,
        1 => (Some(root(-1)), Some(root(1))),
        0 if b.sign() == 0 => {
            // In the plane that touches the cone along a line through the apex: on this line, if it goes through the apex.
            let touches = slope.sign() != 0 && dot(&moment, &moment).sign() == 0;
            if !touches {
                return None;
            }
            (None, None)
        }
        0 => {
            let c = &(&scale * &dot(&from, &from)) - &(&slant2 * &start.square());
            let only = Quotient::ratio(c, &b + &b)?;
            if b.sign() != slope.sign() {
                return None;
            }
            if b.sign() > 0 { (Some(only), None) } else { (None, Some(only)) }
        }
        // Within one half before the first root, within the other after the second.
        _ => {
            let second = |sign: i32| Quotient {
                p: -b.clone(),
                sign,
                q: discriminant.clone(),
                a: -a.clone(),
            };
            if slope.sign() > 0 { (Some(second(1)), None) } else { (None, Some(second(-1))) }
        }
    };
    if slope.sign() == 0 {
        // In a plane across the axis.
        if start.sign() < 0 || (&start - &height2).sign() > 0 {
            return None;
        }
    } else {
        let planes = [apex_plane?, base_plane?];
        let [near, far] = if slope.sign() > 0 {
            planes
        } else {
            let [apex, base] = planes;
            [base, apex]
        };
        if enter.as_ref().is_none_or(|enter| enter.compare(&near) == Ordering::Less) {
            enter = Some(near);
        }
        if leave.as_ref().is_none_or(|leave| leave.compare(&far) == Ordering::Greater) {
            leave = Some(far);
        }
    }
    let (enter, leave) = (enter?, leave?);
    (enter.compare(&leave) != Ordering::Greater).then_some([enter, leave])
}
