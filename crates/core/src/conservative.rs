//! Ray against sphere in single precision, in lanes: what cannot be hit, what is hit for certain,
//! and bounds of the distance. What is left is for [`intersect`](crate::intersect).
//!
//! The form is Embree's: the chord's middle, relative to the center, so that the discriminant does
//! not cancel for spheres that are small or far (Haines, Günther, Akenine-Möller, "Precision
//! Improvements for Ray/Sphere Intersection", Ray Tracing Gems 2019).
//!
//! # Bounds
//!
//! With `u` = 2^-24: `f` is the center as seen from the origin, `d` the direction, `t = f.d / d.d`
//! the way to the middle of the chord and `T = |t||d|` its length, `p = |f - t d|` the line's distance
//! from the center, `r` the radius. So `|f| <= T + p`. All bounds are sums of magnitudes, by the
//! standard model of rounding (Higham, "Accuracy and Stability of Numerical Algorithms", 2002).
//!
//! - `f` is off by `u |f|`, `f.d` thereby and by its three roundings by `4 u |f||d|`, `1 / d.d` by
//!   `4 u` of itself and its product by `u`: `t` is off by at most `4 u |f| / |d| + 5 u |t|`.
//! - `f - t d` is off along the ray by at most `u |f|`, the error of `t` times `|d|`, and `u p` of its
//!   own rounding; at a right angle to it by `u (|f| + p)`; and in any direction by `u T` where the
//!   product is not fused with the difference. For `p <= r` that is together no more than
//!   `12 u T + 8 u r`, which moves `p` by no more.
//! - Squares, sums and the product with `K` add `5 u r`. So if the line meets the sphere, the computed
//!   `p` is less than the `reach` `r (1 + K) + K T` with `K = 16 u`, by `3 u r + 4 u T`: no hit is
//!   rejected.
//! - `reach^2 - p^2` is thereby too large by at least `6 u r^2`: from `x >= y` and `p <= r` follows
//!   `(r + x)^2 - (p + y)^2 >= r^2 - p^2 + 2 r (x - y)`. What the half chord `h` of the line has to
//!   outweigh is the error of `t`, `9 u |t| + 4 u r / |d|`, its own roundings, `6 u` of itself, and
//!   that of the difference, `u` of both. For the first `K |t|` is added, for the rest `2 K` of itself:
//!   `(1 + 25 u) sqrt(h^2 + 6 u r^2) > h + 4 u r` for every `h`. So the hit is not before `t - half`
//!   nor beyond `t + half`.
//! - With `r (1 - K) - K T` for the reach, if that is positive, all signs turn around: the line meets
//!   the sphere for certain, the near hit is not beyond `t - half` and the far one not before `t +
//!   half`. Squared errors help: `(r - x)^2 - (p - y)^2 <= r^2 - p^2` for `p <= r`, `0 <= y <= x <=
//!   r`.
//! - The near hit has an upper bound without another root. The squares `x` and `y` that belong to the
//!   two reaches differ by `4 K r (r + T)`, and by less than `5 K r (r + T)` with rounding. Their roots
//!   (0 for a negative `y`: the hit is not beyond the middle) therefore differ by no more than `sqrt(x -
//!   y)`, which is at most `r / 64 + 80 K (r + T)`, for a geometric mean is no more than the arithmetic
//!   one. The parts `2 K` and `K |t|` that halves and the middle are off add less than `8 K (r + T)`,
//!   what is left of `96 K (r + T)` is for rounding: so the hit is not beyond `t - half + (r / 64 + 96 K
//!   (r + T)) / |d|`, but for what may underflow: three of what follows, in the difference of squares.
//!
//! Every bound holds whether a product is fused with the sum that follows or rounded before
//! ([`Lanes::relaxed_mul_add`]). Fused, `f.d`, `d.d` and the square of `p` have as many roundings in their
//! longest chain: three, three and four. The products `K T`, `half (1 + 2 K)` and `f - t d` are counted
//! with theirs. That leaves the square of the reach, which is then off by `u (r + x)^2`: the difference
//! of squares is still too large by `5 u r^2`, as `x^2 - y^2` outweighs the rest, and the half chord's
//! inequality holds with that; where the signs turn around, `(x - y)(2 r - x - y)` is at least
//! `6 u (r - x)^2`.
//!
//! Underflow: worlds are scaled so that their largest coordinate is about 1, and origins are no
//! farther than 2^20, so nothing overflows, and what underflows is less than 2^-120 in squares.

use crate::lanes::{F32x16, Lanes, transpose};
use crate::vec3::Vec3;

/// Unit roundoff of `f32`.
const U: f32 = f32::EPSILON / 2.0;

/// Relative width of the band in which single precision cannot tell.
const K: f32 = 16.0 * U;

/// Above every absolute error of a square that underflow can cause, and far below the square of any
/// radius that counts.
const UNDERFLOW: f32 = 1.0 / (1_u128 << 120) as f32;

/// The square root of [`UNDERFLOW`].
const ROOT_OF_UNDERFLOW: f32 = 1.0 / (1_u64 << 60) as f32;

/// Rays prepared for the conservative test.
#[derive(Clone, Copy, Debug)]
pub struct ConservativeRay<L> {
    origin: Vec3<L>,
    direction: Vec3<L>,
    /// `1 / |direction|^2`.
    inverse_length2: L,
    /// `K |direction|`.
    band: L,
}

/// Margins beyond which the test is certain of a hit.
#[derive(Clone, Copy, Debug)]
pub struct Margin<L> {
    /// `K / |direction|`.
    inverse_band: L,
    /// The bound that the product of the distances to near and far hit must exceed, for a radius of 0.
    least: L,
    /// The increase of that bound with the radius.
    per_radius: L,
}

impl<L: Lanes> ConservativeRay<L> {
    /// `direction` is neither zero nor so long or short that its square overflows or underflows.
    #[inline(always)]
    pub fn new(origin: Vec3<L>, direction: Vec3<L>) -> Self {
        let length2 = direction.relaxed_dot(direction);
        Self {
            origin,
            direction,
            inverse_length2: L::splat(1.0) / length2,
            band: length2.sqrt() * L::splat(K),
        }
    }

    /// Origins.
    #[inline(always)]
    pub fn origin(&self) -> Vec3<L> {
        self.origin
    }

    /// Directions.
    #[inline(always)]
    pub fn direction(&self) -> Vec3<L> {
        self.direction
    }

    /// Maximum error of the origin if it is a rounded point of a surface: as
    /// [`ExactRay::origin_error`](crate::ray::ExactRay::origin_error), and no less.
    #[inline(always)]
    pub fn origin_error(&self) -> L {
        let span = self.origin.x.abs() + self.origin.y.abs() + self.origin.z.abs();
        span * L::splat(f32::EPSILON * (1.0 + 4.0 * f32::EPSILON))
    }

    /// The margin of rays that may start on surfaces, where origins are off by
    /// [`ConservativeRay::origin_error`]: the product of the distances to near and far hit, times the
    /// direction's length squared, is the squared distance of the origin from the center less the
    /// square of the radius.
    #[inline(always)]
    pub fn margin(&self) -> Margin<L> {
        let error = self.origin_error();
        let scaled = error * self.inverse_length2 * L::splat(1.0 + 16.0 * K);
        Margin {
            inverse_band: self.band * self.inverse_length2,
            least: scaled * error,
            per_radius: scaled + scaled,
        }
    }
}

impl ConservativeRay<F32x16> {
    /// Each on its own, to be kept.
    #[inline(always)]
    pub fn rows(&self, rows: &mut [ConservativeRow; 16]) {
        let (origin, direction) = (self.origin, self.direction);
        let ([a, b, c], [d, e, f]) =
            ([origin.x, origin.y, origin.z], [direction.x, direction.y, direction.z]);
        let columns = [a, b, c, d, e, f, self.inverse_length2, self.band];
        for first in [0, 8] {
            let lanes = transpose(columns, first);
            for i in 0..8 {
                rows[first + i] = ConservativeRow(lanes[i].to_array());
            }
        }
    }
}

/// A [`ConservativeRay`] to be kept: its numbers in their order.
#[derive(Clone, Copy, Debug)]
pub struct ConservativeRow([f32; 8]);

impl ConservativeRow {
    /// In place of one where there is none.
    pub const NONE: Self = Self([0.0; 8]);
}

impl From<ConservativeRow> for ConservativeRay<f32> {
    #[inline(always)]
    fn from(ConservativeRow([a, b, c, d, e, f, inverse_length2, band]): ConservativeRow) -> Self {
        let (origin, direction) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
        Self { origin, direction, inverse_length2, band }
    }
}

impl ConservativeRay<f32> {
    /// In place of a ray where there is none.
    pub const IDLE: Self = Self {
        origin: Vec3::new(0.0, 0.0, 0.0),
        direction: Vec3::new(1.0, 0.0, 0.0),
        inverse_length2: 1.0,
        band: K,
    };

    /// Returns the ray in every lane.
    #[inline(always)]
    pub fn splat<L: Lanes>(&self) -> ConservativeRay<L> {
        ConservativeRay {
            origin: Vec3::splat(self.origin.x, self.origin.y, self.origin.z),
            direction: Vec3::splat(self.direction.x, self.direction.y, self.direction.z),
            inverse_length2: L::splat(self.inverse_length2),
            band: L::splat(self.band),
        }
    }
}

/// The chord that a ray's line cuts out of a sphere, if it does.
#[derive(Clone, Copy, Debug)]
pub struct Chord<L> {
    /// Distance to the chord's middle.
    middle: L,
    /// Squared distance of the line from the center, no larger than it is.
    distance2: L,
    /// Half the chord, no shorter than it is, by which also `middle` is bounded; NaN where the line
    /// misses.
    half: L,
    /// `K |middle|`.
    slack: L,
}

impl<L: Lanes> Chord<L> {
    /// The chord of a ray, in units of its direction's length; useless for a radius that is NaN.
    #[inline(always)]
    pub fn new(ray: &ConservativeRay<L>, center: Vec3<L>, radius: L) -> Self {
        let to_center = center - ray.origin;
        let middle = to_center.relaxed_dot(ray.direction) * ray.inverse_length2;
        let perpendicular = to_center.relaxed_along(ray.direction, -middle);
        let distance2 = perpendicular.relaxed_dot_add(perpendicular, L::splat(-UNDERFLOW));
        let reach = middle.abs().relaxed_mul_add(ray.band, radius * L::splat(1.0 + K));
        let chord2 = reach.relaxed_mul_add(reach, -distance2);
        let slack = middle.abs() * L::splat(K);
        let half =
            (chord2 * ray.inverse_length2).sqrt().relaxed_mul_add(L::splat(1.0 + 2.0 * K), slack);
        Self { middle, distance2, half, slack }
    }

    /// The lanes whose ray may hit the sphere at a distance in `0..=t_max`: never without one that
    /// does.
    #[inline(always)]
    pub fn may_hit(&self, t_max: L) -> L::Mask {
        let zero = L::splat(0.0);
        // Neither is true of NaN.
        self.near().le(t_max) & zero.le(self.middle + self.half)
    }

    /// A distance before which the line does not enter the sphere.
    #[inline(always)]
    pub fn near(&self) -> L {
        self.middle - self.half
    }

    /// A distance beyond which the line does not enter the sphere, if it does.
    #[inline(always)]
    pub fn near_at_most(&self, radius: L, margin: &Margin<L>) -> L {
        const ERRORS: f32 = 96.0;
        let per_radius = L::splat(ERRORS + 1.0 / (64.0 * K));
        let part = radius.relaxed_mul_add(per_radius, L::splat(4.0 * ROOT_OF_UNDERFLOW / K));
        self.slack.relaxed_mul_add(
            L::splat(ERRORS),
            part.relaxed_mul_add(margin.inverse_band, self.near()),
        )
    }

    /// The lanes whose ray starts outside the sphere and enters it, for certain. Outside is also beyond
    /// the margin about the surface.
    #[inline(always)]
    pub fn enters(&self, ray: &ConservativeRay<L>, radius: L, margin: &Margin<L>) -> L::Mask {
        let zero = L::splat(0.0);
        // The far hit is not before the middle, which is off by at most this.
        let error = radius.relaxed_mul_add(margin.inverse_band, self.slack);
        let outside = self.near() * (self.middle - error);
        zero.lt(self.least_chord2(ray, radius))
            & zero.lt(self.near())
            & margin.about(radius).lt(outside)
    }

    /// The lanes whose ray starts inside the sphere for certain, and not within the margin, and bounds
    /// of the distance at which it leaves.
    #[inline(always)]
    pub fn leaves(
        &self,
        ray: &ConservativeRay<L>,
        radius: L,
        margin: &Margin<L>,
    ) -> (L::Mask, [L; 2]) {
        let zero = L::splat(0.0);
        let root = (self.least_chord2(ray, radius) * ray.inverse_length2).sqrt();
        let half = root * L::splat(1.0 - 2.0 * K) - self.slack;
        let (before, beyond) = (half - self.middle.abs(), half + self.middle.abs());
        let certain = zero.lt(before) & margin.about(radius).lt(before * beyond);
        (certain, [self.middle + half, self.middle + self.half])
    }

    /// As `chord2`, but no larger than it is; not positive where it is not certain that the line meets
    /// the sphere.
    #[inline(always)]
    fn least_chord2(&self, ray: &ConservativeRay<L>, radius: L) -> L {
        let reach = radius * L::splat(1.0 - K) - self.middle.abs() * ray.band;
        let reach = reach.max(L::splat(0.0));
        reach.relaxed_mul_add(reach, -(self.distance2 + L::splat(2.0 * UNDERFLOW)))
    }
}

impl Margin<f32> {
    /// Returns the margin in every lane.
    #[inline(always)]
    pub fn splat<L: Lanes>(&self) -> Margin<L> {
        Margin {
            inverse_band: L::splat(self.inverse_band),
            least: L::splat(self.least),
            per_radius: L::splat(self.per_radius),
        }
    }
}

impl<L: Lanes> Margin<L> {
    #[inline(always)]
    fn about(&self, radius: L) -> L {
        radius.relaxed_mul_add(self.per_radius, self.least)
    }
}

#[cfg(test)]
mod tests;
