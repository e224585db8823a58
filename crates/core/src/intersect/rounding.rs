//! Distances rounded to the nearest double.
//!
//! A distance that is about right becomes the double that is nearest to the true one, by a step of Newton's
//! kind from a number with few digits: so products are exact, and what cancels leaves no error. A bound
//! tells whether rounding is certain. Where it is not, more digits are taken along, and at last
//! [`exact::nearest_distance`] decides. So a distance depends on nothing but ray and sphere: all ways to
//! compute it give the same bits. Nothing here is fused, so it costs the same with and without
//! instructions for that.
//!
//! # The step
//!
//! Coordinates, radius and direction are numbers of single precision, times powers of two: 24 digits. The
//! largest coordinate of the direction `d` is in `1..2`, so `|d| < 3.47` and `a = d.d < 12`. With `s` the
//! start of the step, `P = F + d s` the point there, as seen from the center, `f = P.P - r^2` and `g = P.d`,
//! the line meets the sphere at `s + x` with `a x^2 + 2 g x + f = 0`. Of the two `x` the one of less magnitude
//! is
//!
//! ```text
//! x = -f / (g + sign(g) sqrt(g^2 - a f))
//! ```
//!
//! If `g < 0` the ray enters the sphere there, and has started outside. So this is the hit, whatever `s` was.
//! If `g > 0` the ray leaves the sphere. That is the hit if it has started inside, and it has: `s` is either
//! a distance before which the hit is not, and then `s` is beyond the middle of the chord only if the near
//! end is no hit; or it is so close to the hit that the near end, more than `2^-14 s` away, is not the hit.
//!
//! # Digits
//!
//! `s` has at most 29 digits, so `d s` is exact. Adding and subtracting a number that is about `2^28 r` leaves
//! of `P` its part `u` on a grid: the multiples of `q`, a power of two between `2^-25 r` and `2^-24 r`, or of
//! `2 q`. Squares of `u` and `r` are multiples of `q^2`, and so are the sums in
//! `(u_x^2 - r^2) + u_y^2 + u_z^2`. In this order no sum is larger than `r^2` or the last one. Where
//! `|P| < 1.42 r`, as is required below, that is less than `2^53 q^2`: so `u.u - r^2` is exact. (Where it is
//! not, `f` is off by too little to meet the requirement nevertheless.) The rest `w = P - u` is at most
//! `2^-24 r` in each coordinate, and `f = (u.u - r^2) + w.(2 u + w)`.
//!
//! With `E` = 2^-53:
//!
//! - [`nearest_quickly`] knows that `F` is exact, and so is `F - u`. Added to `d s` this gives `w`, rounded
//!   once, with an error of at most `E 2^-24 r`. Products and sums of `w.(2 u + w)`, with `u + P` for `2 u +
//!   w`, are off by at most `2^-71.3 r^2`.
//! - [`nearest_closely`] takes along what rounding loses. `F = o - c` and `P = F + d s` lose `e`, which is at most
//!   `3 E (r + s)` in each coordinate, and is rounded. `P - u` is `v`, which splits into `m` on the grid of
//!   `2^-25 q`, and `l`, and `e`. As `u.u - r^2` is exact, so is `u.m`, whose terms are multiples of `2^-25
//!   q^2`. What else there is, `v.v + 2 u.l + 2 P.e`, is at most `2^-45 r (r + s)`. It is off by at most
//!   `2^-95 r (r + s)`, for six roundings of each term, and by `2^-101 (r + s)^2`, the square of `e` that is
//!   left out.
//! - `g` is off by at most `20 E r`: `15 E r` by its roundings, and `5 E r` by that of `P`, or of the sum of `P.d`
//!   and `e.d`.
//!
//! # The bound
//!
//! Required is `2 |a f| < g^2`. As `g^2 <= a |P|^2`, this gives `|P| < 1.42 r` and `|g| < 5 r`; and the root is
//! between `0.7 |g|` and `1.23 |g|`, so that `|g| i` is between `0.44` and `0.59`, with `i` one over the sum
//! of `|g|` and root. An error of `f` then counts at most `1.58 i`, and one of `g` at most `3.15 |x| i`, which
//! is `63 E r |x| i`. The roundings of `f` and of all that follows are at most `9.3 E |x|`, no more than `104 E r
//! |x| i`. So the error of `x` is at most `(2^-70.6 r^2 + 2^-45.6 r |x|) i` for the quick step, and
//! `((2^-94.3 r + 2^-100.3 (r + s)) (r + s) + 2^-45.6 r |x|) i` for the close one. The code's constants are
//! at least 1.5 times these, which leaves room for second order and for its own rounding.
//!
//! If all numbers no farther from `s + x` than this bound round to the same double, that is the nearest one to
//! the distance. The bound is then at most `E (s + x)`. From this follows that `|g|` is at least `2^-44 r`, for
//! the quick step is taken for distances below `2^25 r` only: more than 16 times its error. So its sign is
//! certain, and so is the root.
//!
//! Nothing underflows that counts: see the [module's documentation](super).

use super::Pairs;
use crate::elementary::power_of_two;
use crate::exact;
use crate::lanes::Doubles;
use crate::ray::ExactRay;
use crate::vec3::Vec3;
use glam::DVec3;

/// Rounds the distances at which rays hit spheres to the nearest doubles, in lanes in which that is certain,
/// which are the first result. In these, the ray does hit the sphere there.
///
/// `start` has 29 digits or less. It is either a distance before which the ray does not hit the sphere, or within
/// 2^-18 of the hit. Origin and center are [coarse](Vec3::is_coarse).
#[inline(always)]
pub fn nearest_quickly<D: Doubles>(pairs: &Pairs<D>, start: D) -> (D::Mask, D) {
    let Pairs { origin, direction, center, radius, .. } = *pairs;
    let from_center = origin - center;
    let way = direction * start;
    let point = from_center + way;
    let (high, _) = split(point, radius * D::splat(MAGIC));
    let rest = (from_center - high) + way;
    let excess = square_excess(high, radius) + rest.dot_unfused(high + point);
    // Coordinates of `F - u` are at most `3 r + 2 s`, and multiples of 2^-46 and of the grid.
    let exact = start.lt(D::splat(16.0)) & start.lt(D::splat(power_of_two(25)) * radius);
    let step = Step { start, excess, slope: point.dot_unfused(direction), direction };
    let (certain, t) = step.rounded(D::splat(power_of_two(-70)) * radius * radius, radius);
    (exact & certain, t)
}

/// Does what [`nearest_quickly`] does for any coordinates, with more digits. `t` is within 2^-18 of the hit.
#[inline(always)]
pub fn nearest_closely<D: Doubles>(pairs: &Pairs<D>, t: D) -> (D::Mask, D) {
    let Pairs { origin, direction, center, radius, .. } = *pairs;
    let start = shortened(t);
    let (from_center, lost) = two_sums(origin, -center);
    let (point, also_lost) = two_sums(from_center, direction * start);
    let lost = lost + also_lost;
    let magic = radius * D::splat(MAGIC);
    let (high, rest) = split(point, magic);
    let (middle, low) = split(rest, magic * D::splat(power_of_two(-25)));
    let mixed = high.dot_unfused(middle);
    let small = high.dot_unfused(low) + point.dot_unfused(lost);
    let excess = (square_excess(high, radius) + (mixed + mixed))
        + (rest.dot_unfused(rest) + (small + small));
    let span = radius + start;
    let error = (D::splat(power_of_two(-93)) * radius + D::splat(power_of_two(-96)) * span) * span;
    let slope = point.dot_unfused(direction) + lost.dot_unfused(direction);
    Step { start, excess, slope, direction }.rounded(error, radius)
}

/// Rounds the distance at which a ray hits a sphere, which it does, to the nearest double; `t` is within 2^-18
/// of it. `coarse` says that origin and center are, as [`nearest_quickly`] needs them.
#[inline(always)]
pub fn nearest(ray: &ExactRay, center: DVec3, radius: f64, t: f64, coarse: bool) -> f64 {
    let pairs = Pairs::one(ray, center, radius);
    if coarse {
        let (certain, rounded) = nearest_quickly(&pairs, shortened(t));
        if certain {
            return rounded;
        }
    }
    nearest_or_exact(&pairs, ray, t)
}

/// Does what [`nearest`] does for coordinates that are not coarse.
#[inline(never)]
pub fn nearest_or_exact(pairs: &Pairs<f64>, ray: &ExactRay, t: f64) -> f64 {
    let (certain, rounded) = nearest_closely(pairs, t);
    if certain {
        return rounded;
    }
    let Vec3 { x, y, z } = pairs.center;
    exact::nearest_distance(ray, DVec3::new(x, y, z), pairs.radius).unwrap_or(t)
}

/// Times the radius, a number whose last place is the grid of the first digits of `P`. It is 1.5 times a power of
/// two, so that sums with it have that grid or half of it.
const MAGIC: f64 = 1.5 * power_of_two(28);

/// `u.u - r^2` for `u` on the grid, without rounding.
#[inline(always)]
fn square_excess<D: Doubles>(u: Vec3<D>, radius: D) -> D {
    (u.x * u.x - radius * radius) + u.y * u.y + u.z * u.z
}

/// The nearest number with 29 digits (Veltkamp's splitting).
#[inline(always)]
fn shortened<D: Doubles>(t: D) -> D {
    let long = t * D::splat(power_of_two(24) + 1.0);
    long - (long - t)
}

/// `x + y`, rounded, and what rounding has taken from it, exactly (Knuth's `TwoSum`).
#[inline(always)]
fn two_sum<D: Doubles>(x: D, y: D) -> (D, D) {
    let sum = x + y;
    let rest = sum - x;
    (sum, (x - (sum - rest)) + (y - rest))
}

/// [`two_sum`] of each coordinate.
#[inline(always)]
fn two_sums<D: Doubles>(p: Vec3<D>, q: Vec3<D>) -> (Vec3<D>, Vec3<D>) {
    let ((x, dx), (y, dy), (z, dz)) = (two_sum(p.x, q.x), two_sum(p.y, q.y), two_sum(p.z, q.z));
    (Vec3::new(x, y, z), Vec3::new(dx, dy, dz))
}

/// The part of each coordinate on the grid of `magic`'s last place, and the rest, exactly.
#[inline(always)]
fn split<D: Doubles>(p: Vec3<D>, magic: D) -> (Vec3<D>, Vec3<D>) {
    let part = p.map(|x| (x + magic) - magic);
    (part, p - part)
}

/// The step from `start` to the hit.
struct Step<D> {
    start: D,
    /// `f`.
    excess: D,
    /// `g`.
    slope: D,
    direction: Vec3<D>,
}

impl<D: Doubles> Step<D> {
    /// Returns where the step leads to, and the lanes in which it is certain how to round that. The error of
    /// the step is at most `error + 2^-45 radius |step|`, over the sum of slope and root.
    #[inline(always)]
    fn rounded(self, error: D, radius: D) -> (D::Mask, D) {
        let Self { start, excess, slope, direction } = self;
        let zero = D::splat(0.0);
        let a = direction.dot_unfused(direction);
        let (product, slope2) = (a * excess, slope * slope);
        let inverse = D::splat(1.0) / (slope.abs() + (slope2 - product).sqrt());
        let enters = slope.lt(zero);
        let length = excess * inverse;
        let step = D::select(enters, length, -length);
        let error = (error + D::splat(power_of_two(-45)) * radius * length.abs()) * inverse;
        let rounded = start + step;
        let lost = step - (rounded - start);
        let (least, most) = (rounded + (lost - error), rounded + (lost + error));
        // False for anything NaN.
        let certain = (product + product).abs().lt(slope2)
            & (enters | (D::splat(power_of_two(-15)) * a * start).lt(slope))
            & (D::splat(power_of_two(10)) * length.abs()).lt(start)
            & !least.lt(most);
        (certain, rounded)
    }
}

#[cfg(test)]
mod tests;
