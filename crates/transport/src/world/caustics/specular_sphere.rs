//! Paths of light between two points by a sphere: one reflection, or refraction in and out.
//!
//! Such a path lies in the plane of both points and the center. One number determines it: its angle of
//! incidence a, which is the same wherever it meets the sphere. Along the path, the direction from the
//! center turns by
//!
//! acos(R/X sin a) + acos(R/Y sin a) - 2 acos(sin a) + 2 acos(sin a / n)
//!
//! from a point at distance X to one at distance Y; without the last term for a reflection (Alhazen's
//! problem). Each of the arc cosines is convex in a for ratios less than 1, and the third is linear: so
//! the sum is convex, and every turn belongs to at most two angles of incidence. Newton's method from
//! the outer side of a root never leaves that side. Angles are stored as sine and cosine, which square
//! roots and products give: no trigonometric function is needed.

use crate::lanes::{Doubles, Mask};

/// Maximum number of Newton's steps. Ten suffice except for points that nearly touch the sphere, and
/// near the edge of a caustic, where the two angles of incidence meet.
const STEPS: u32 = 24;

/// Tolerance of the turn, in radians.
const RESOLVED: f64 = 1e-11;

/// A sphere and the distances of two points outside of it, or a row of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpecularSphere<D> {
    pub(crate) radius: D,
    /// Distances of the receiver and of the emitter's point from the center.
    pub(crate) distance: [D; 2],
    /// Index of refraction outside over that inside; 0 for a reflection.
    pub(crate) index: D,
    /// Radius over distance, and 1 minus its square.
    ratio: [D; 2],
    gap: [D; 2],
    index_gap: D,
}

/// An angle, as sine and cosine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angle<D> {
    pub(crate) sine: D,
    pub(crate) cosine: D,
}

/// The deflection of a ray that meets a sphere at some angle of incidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deflection<D> {
    /// Turn of the direction from the center, minus half a turn if the ray passes through: 0 for a ray
    /// along the axis.
    pub(crate) angle: Angle<D>,
    /// Sine of the turn over the sine of the incidence.
    gain: D,
    /// Derivative of the turn by the incidence.
    pub(crate) rate: D,
    /// Cosines of the ray to the axes from receiver and emitter to the center.
    pub(crate) slope: [D; 2],
}

impl<D: Doubles> Angle<D> {
    /// Subtracts a small angle in radians, or a little less.
    #[inline(always)]
    fn less(self, step: D) -> Self {
        let half = step * D::splat(0.5);
        let square = half * half;
        let scale = D::splat(1.0) / (D::splat(1.0) + square);
        let (sine, cosine) = (step * scale, (D::splat(1.0) - square) * scale);
        Self {
            sine: self.sine * cosine - self.cosine * sine,
            cosine: self.cosine * cosine + self.sine * sine,
        }
    }

    /// Subtracts another angle.
    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self {
            sine: self.sine * other.cosine - self.cosine * other.sine,
            cosine: self.cosine * other.cosine + self.sine * other.sine,
        }
    }

    #[inline(always)]
    fn select(mask: D::Mask, yes: Self, no: Self) -> Self {
        Self {
            sine: D::select(mask, yes.sine, no.sine),
            cosine: D::select(mask, yes.cosine, no.cosine),
        }
    }
}

impl<D: Doubles> SpecularSphere<D> {
    /// Creates a sphere; `index` is that of refraction outside over that inside, less than 1, or 0 for
    /// a reflection.
    #[inline(always)]
    pub(crate) fn new(radius: D, distance: [D; 2], index: D) -> Self {
        let one = D::splat(1.0);
        let ratio = distance.map(|distance| radius / distance);
        let gap = |i: usize| {
            let distance: D = distance[i];
            (distance - radius) / distance * (one + ratio[i])
        };
        let gap = [gap(0), gap(1)];
        Self { radius, distance, index, ratio, gap, index_gap: one - index * index }
    }

    /// Returns the deflection of a ray of this incidence.
    #[inline(always)]
    pub(crate) fn turn(&self, Angle { sine, cosine }: Angle<D>) -> Deflection<D> {
        let (sine2, cosine2) = (sine * sine, cosine * cosine);
        let other = |gap: D| (cosine2 + gap * sine2).sqrt();
        let ([k, l], m) = (self.ratio, self.index);
        let (a, b, w) = (other(self.gap[0]), other(self.gap[1]), other(self.index_gap));
        // The sum of the first two arc cosines; its sine is divided by that of the incidence.
        let (ends_cosine, ends) = (k * l * sine2 - a * b, k * b + l * a);
        // Half of the other terms, minus a right angle: along +i for a ray along the axis.
        let (half, up) = (m * cosine - w, m * sine2 + cosine * w);
        let both = half * half * sine2 - up * up;
        let two = D::splat(2.0);
        let gain = two * ends_cosine * half * up + ends * both;
        let turned = ends_cosine * both - two * ends * half * up * sine2;
        let (ab, scale) = (a * b, cosine / (a * b * w));
        Deflection {
            angle: Angle { sine: gain * sine, cosine: turned },
            gain,
            rate: two - scale * ((k * b + l * a) * w + two * m * ab),
            slope: [a, b],
        }
    }

    /// Solves for the incidence at which a ray turns by `turn`; returns it with a mask of the
    /// solutions. Turns of outer rays are between -2 asin `index` and 2 acos `index`, and `turn` must
    /// be in that range.
    #[inline(always)]
    pub(crate) fn find(&self, turn: Angle<D>, inner: D::Mask) -> (Angle<D>, D::Mask) {
        let (zero, one) = (D::splat(0.0), D::splat(1.0));
        let mut at =
            Angle { sine: D::select(inner, zero, one), cosine: D::select(inner, one, zero) };
        let sign = D::select(inner, -one, one);
        let resolved = D::splat(RESOLVED);
        let mut open = zero.lt(one);
        let mut found = !open;
        for _ in 0..STEPS {
            let here = self.turn(at);
            let rest = here.angle.minus(turn);
            let near = rest.sine.abs().lt(resolved) & zero.lt(rest.cosine);
            // Past the least turn, or past the axis, there is no solution.
            let this_side = !at.sine.lt(zero);
            let ahead = zero.lt(rest.sine) & zero.lt(here.rate * sign) & this_side;
            found = found | open & near & this_side;
            open = open & ahead & !near;
            if open.bits() == 0 {
                break;
            }
            // A lower bound of the angle by its sine and cosine (Cusa's bound).
            let two = D::splat(2.0);
            let step = D::splat(3.0) * rest.sine / ((two + rest.cosine) * here.rate);
            at = Angle::select(open, at.less(step), at);
        }
        (at, found)
    }

    /// Returns the area across the ray at the emitter per steradian at the receiver, over the squared
    /// distance of the emitter from the center.
    #[inline(always)]
    pub(crate) fn spread(&self, at: Angle<D>, turn: &Deflection<D>) -> D {
        let across = self.distance[0] / self.radius;
        let [a, b] = turn.slope;
        across * across * (turn.gain * turn.rate).abs() * a * b / at.cosine
    }

    /// Returns the lengths of the ray outside of the sphere.
    #[inline(always)]
    pub(crate) fn lengths(&self, at: Angle<D>, turn: &Deflection<D>) -> [D; 2] {
        let inside = self.radius * at.cosine;
        [self.distance[0] * turn.slope[0] - inside, self.distance[1] * turn.slope[1] - inside]
    }

    /// Returns the angle at the center between the emitter and the point where the ray leaves the
    /// sphere toward it.
    #[inline(always)]
    pub(crate) fn exit_angle(&self, at: Angle<D>, turn: &Deflection<D>) -> Angle<D> {
        let (ratio, slope) = (self.ratio[1], turn.slope[1]);
        Angle {
            cosine: ratio * at.sine * at.sine + slope * at.cosine,
            sine: at.sine * (slope - ratio * at.cosine),
        }
    }

    /// Returns the sine of the ray to the axis from the receiver.
    #[inline(always)]
    pub(crate) fn receiver_sine(&self, at: Angle<D>) -> D {
        self.ratio[0] * at.sine
    }
}
