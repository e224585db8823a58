//! Ray against ellipsoids in single precision, in lanes: ellipsoids that cannot be hit are left out.
//!
//! # Bounds
//!
//! With `u` = 2^-24, `F` from the center to the origin, `d` the direction, `y = M F` and `w = M d`: a line meets the ellipsoid if
//! `|y x w| <= |w|`. Let `S` be the sum of all `|M_ij F_j|` and `W` that of all `|M_ij d_j|`; what cancels in `y` and `w` leaves
//! errors that are relative to these. `F` is off by `u` of itself, each of three products and two sums adds as much, so `y` is off by at
//! most `4 u S` in sum over its coordinates, and `w` by `3 u W`. As `|y| <= S` and `|w| <= W`, this moves `y x w` by `7 u S W`, and its own
//! rounding by less than `6 u S W`. Divided by `(1 + S) W`, so that no square overflows, `n = y/(1 + S) x w/W` is off by less than `20 u`,
//! quotients included, and `w/W` by less than `8 u`, `1/(1 + S)` times which is less than `8 u`. [`FilterRay::SLACK`] is twice both together. What underflows is
//! less than `u` of what has the size of 1.
//!
//! The ellipsoid is in the sphere about its center, whose radius is stored.

use super::EllipsoidBlock;
use crate::body_tree::{FilterRay, cross, magnitude};
use crate::lanes::{F32x8, Lanes, Mask};
use crate::vec3::Vec3;

/// Returns a bit for each ellipsoid of a block that a ray may hit no farther than `t_max`, and distances before which it does
/// not.
#[inline(always)]
pub(super) fn may_hit(ray: &FilterRay, block: &EllipsoidBlock, t_max: f32) -> (u32, F32x8) {
    let load =
        |[x, y, z]: &[[f32; 8]; 3]| Vec3::new(F32x8::new(*x), F32x8::new(*y), F32x8::new(*z));
    let (one, slack) = (F32x8::splat(1.0), F32x8::splat(FilterRay::SLACK));
    let reach = F32x8::new(block.reach);
    let from = ray.origin - load(&block.center);
    let rows = [load(&block.to_unit[0]), load(&block.to_unit[1]), load(&block.to_unit[2])];
    let (y, from_size) = apply(&rows, from);
    let (w, direction_size) = apply(&rows, ray.direction);
    let (far, scale) = (one / (one + from_size), one / direction_size);
    let w = w * scale;
    let n = cross(y * far, w);
    let length = |v: Vec3<F32x8>| v.relaxed_dot(v).sqrt();
    let meets = length(n).le(length(w) * far + slack);
    let doubt = slack * (magnitude(from) + reach);
    let (passes, near) = ray.passes(-from, reach, doubt, t_max);
    ((meets & passes).bits(), near)
}

/// Returns the product of matrices with vectors, and the sum of the magnitudes of all its terms.
#[inline(always)]
fn apply(rows: &[Vec3<F32x8>; 3], v: Vec3<F32x8>) -> (Vec3<F32x8>, F32x8) {
    let [x, y, z] = rows.map(|row| {
        let terms = Vec3::new(row.x * v.x, row.y * v.y, row.z * v.z);
        (terms.x + terms.y + terms.z, magnitude(terms))
    });
    (Vec3::new(x.0, y.0, z.0), x.1 + y.1 + z.1)
}
