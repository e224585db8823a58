//! Where a ball sends light from one point to another: by one reflection on it, or in and out.
//!
//! Such a way lies in the plane of both points and the center. There it is known by one number, its
//! angle of incidence a, which is the same wherever it meets the ball. Going along it, the direction
//! from the center turns by
//!
//! acos(R/X sin a) + acos(R/Y sin a) - 2 acos(sin a) + 2 acos(sin a / n)
//!
//! from a point at distance X to one at distance Y, or for a reflection by that without the last
//! term (Alhazen's problem). Each of the arc cosines is convex in a for ratios less than 1, and the
//! third is linear: so is the whole, and every turn belongs to two angles of incidence at most.
//! Newton's method from the outer side of a root never leaves that side. All angles are held as sine
//! and cosine, which square roots and products give: nothing here needs the function of an angle.

use crate::lanes::{Doubles, Mask};

/// Newton's steps, at most. Ten are enough but for points that nearly touch the ball, and next to
/// the edge of a caustic, where the two angles of incidence meet.
const STEPS: u32 = 24;

/// A turn that is nearer to the one that is looked for, in radians, is the same.
const RESOLVED: f64 = 1e-11;

/// A ball and the distances of two points outside of it, or a row of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball<D> {
    pub(crate) radius: D,
    /// Of the receiver and of the lamp's point from the center.
    pub(crate) distance: [D; 2],
    /// Index of refraction outside over that inside; 0 for a reflection.
    pub(crate) index: D,
    /// Radius over distance, and 1 less the square of that.
    ratio: [D; 2],
    gap: [D; 2],
    index_gap: D,
}

/// An angle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angle<D> {
    pub(crate) sine: D,
    pub(crate) cosine: D,
}

/// What becomes of a ray that meets a ball at a certain angle of incidence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn<D> {
    /// By how much the direction from the center turns, less half a turn if the ray passes through:
    /// 0 for a ray along the axis.
    pub(crate) angle: Angle<D>,
    /// The sine of that over the sine of the incidence.
    gain: D,
    /// How fast it grows with the incidence.
    pub(crate) rate: D,
    /// Cosines of the ray to the axes from receiver and lamp to the center.
    pub(crate) slope: [D; 2],
}

impl<D: Doubles> Angle<D> {
    /// This angle less a small one in radians, or less than that.
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

    /// The difference to another angle.
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

impl<D: Doubles> Ball<D> {
    /// `index` is that of refraction outside over that inside, less than 1, or 0 for a reflection.
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

    /// What becomes of a ray of this incidence.
    #[inline(always)]
    pub(crate) fn turn(&self, Angle { sine, cosine }: Angle<D>) -> Turn<D> {
        let (sine2, cosine2) = (sine * sine, cosine * cosine);
        let other = |gap: D| (cosine2 + gap * sine2).sqrt();
        let ([k, l], m) = (self.ratio, self.index);
        let (a, b, w) = (other(self.gap[0]), other(self.gap[1]), other(self.index_gap));
        // The sum of the first two arc cosines; its sine is over that of the incidence.
        let (ends_cosine, ends) = (k * l * sine2 - a * b, k * b + l * a);
        // Half the others, less a right angle: so that it is along +i for a ray along the axis.
        let (half, up) = (m * cosine - w, m * sine2 + cosine * w);
        let both = half * half * sine2 - up * up;
        let two = D::splat(2.0);
        let gain = two * ends_cosine * half * up + ends * both;
        let turned = ends_cosine * both - two * ends * half * up * sine2;
        let (ab, scale) = (a * b, cosine / (a * b * w));
        Turn {
            angle: Angle { sine: gain * sine, cosine: turned },
            gain,
            rate: two - scale * ((k * b + l * a) * w + two * m * ab),
            slope: [a, b],
        }
    }

    /// The incidence at which a ray turns by `turn`, and where there is one. Outer rays turn by
    /// -2 asin `index` to 2 acos `index`, and `turn` must be in that range.
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
            // From the start, past the least turn or past the axis: there is none.
            let this_side = !at.sine.lt(zero);
            let ahead = zero.lt(rest.sine) & zero.lt(here.rate * sign) & this_side;
            found = found | open & near & this_side;
            open = open & ahead & !near;
            if open.bits() == 0 {
                break;
            }
            // The angle by its sine and cosine, or less (Cusa's bound).
            let two = D::splat(2.0);
            let step = D::splat(3.0) * rest.sine / ((two + rest.cosine) * here.rate);
            at = Angle::select(open, at.less(step), at);
        }
        (at, found)
    }

    /// Area across the ray at the lamp for each steradian at the receiver.
    #[inline(always)]
    pub(crate) fn spread(&self, at: Angle<D>, turn: &Turn<D>) -> D {
        let [x, y] = self.distance;
        let across = x * y / self.radius;
        let [a, b] = turn.slope;
        across * across * (turn.gain * turn.rate).abs() * a * b / at.cosine
    }

    /// Lengths of the ray outside of the ball.
    #[inline(always)]
    pub(crate) fn lengths(&self, at: Angle<D>, turn: &Turn<D>) -> [D; 2] {
        let inside = self.radius * at.cosine;
        [self.distance[0] * turn.slope[0] - inside, self.distance[1] * turn.slope[1] - inside]
    }

    /// The angle at the center between the lamp and where the ray leaves the ball toward it.
    #[inline(always)]
    pub(crate) fn foot(&self, at: Angle<D>, turn: &Turn<D>) -> Angle<D> {
        let (ratio, slope) = (self.ratio[1], turn.slope[1]);
        Angle {
            cosine: ratio * at.sine * at.sine + slope * at.cosine,
            sine: at.sine * (slope - ratio * at.cosine),
        }
    }

    /// Sine of the ray to the axis from the receiver.
    #[inline(always)]
    pub(crate) fn leaning(&self, at: Angle<D>) -> D {
        self.ratio[0] * at.sine
    }
}
