//! The way of light by a ball, in space.

use super::ball::{Angle, Ball, Turn};
use crate::lanes::Doubles;
use crate::vec3::Vec3;

/// Points whose directions from the center are closer to one line than that have no plane.
const LEAST_SINE: f64 = 1e-12;

/// How light goes by a ball from a receiver to a lamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// It is reflected on the outside.
    Reflected,
    /// It passes through, and across the axis from the receiver to the center.
    Crossed,
    /// It passes through and stays on its side of the axis; of two such ways, the one that is nearer to
    /// the axis.
    Paraxial,
    /// The other of the two.
    Marginal,
}

/// A way, or a row of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ways<D: Doubles> {
    pub(crate) through: D::Mask,
    pub(crate) crosses: D::Mask,
    pub(crate) inner: D::Mask,
}

/// The way of light from a receiver to a lamp by a ball; places are from its center.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<D: Doubles> {
    /// Unit vector from the receiver to the ball.
    pub(crate) toward: Vec3<D>,
    /// Where it leaves the ball.
    pub(crate) exit: Vec3<D>,
    /// Unit vector from there to the lamp.
    pub(crate) onward: Vec3<D>,
    /// Lengths of both.
    pub(crate) length: [D; 2],
    /// The angle of incidence.
    pub(crate) at: Angle<D>,
    /// Area across the ray at the lamp for each steradian at the receiver.
    pub(crate) spread: D,
    /// Where there is one; the rest means nothing elsewhere.
    pub(crate) found: D::Mask,
}

impl Way {
    /// How many there are.
    pub(crate) const COUNT: u32 = 4;

    /// All of them, in order.
    pub(crate) const ALL: [Self; Self::COUNT as usize] =
        [Self::Reflected, Self::Crossed, Self::Paraxial, Self::Marginal];

    /// The one that a code stands for.
    #[inline(always)]
    pub(crate) fn of(code: u32) -> Self {
        Self::ALL[(code % Self::COUNT) as usize]
    }

    /// The way of a ray through the ball that becomes of its incidence what `turn` tells.
    pub(crate) fn through(turn: &Turn<f64>) -> Self {
        match (turn.angle.sine > 0.0, turn.rate > 0.0) {
            (true, _) => Self::Crossed,
            (false, false) => Self::Paraxial,
            (false, true) => Self::Marginal,
        }
    }
}

/// Finds the way of light by a ball of this radius and index of refraction, that outside over that
/// inside, from a receiver to a lamp; both are outside, told from the center.
#[inline(always)]
pub(crate) fn link<D: Doubles>(
    (radius, index): (D, D),
    [receiver, lamp]: [Vec3<D>; 2],
    ways: Ways<D>,
) -> Link<D> {
    let (zero, one, two) = (D::splat(0.0), D::splat(1.0), D::splat(2.0));
    let distance = [receiver, lamp].map(|place| place.dot_unfused(place).sqrt());
    let u = receiver * (one / distance[0]);
    let v = lamp * (one / distance[1]);
    let cosine = u.dot_unfused(v);
    let across = v - u * cosine;
    let sine = across.dot_unfused(across).sqrt();
    let stays = D::select(ways.through, -cosine, cosine);
    let turn = Angle { sine: D::select(ways.through & !ways.crosses, -sine, sine), cosine: stays };
    let edge = one - two * index * index;
    let edge = D::select(ways.crosses, -edge, edge);
    let reachable = !ways.through | edge.lt(stays);
    let ball = Ball::new(radius, distance, D::select(ways.through, index, zero));
    let (at, found) = ball.find(turn, ways.inner);
    let here = ball.turn(at);
    let side = D::select(ways.crosses, -one, one) / sine;
    let length = ball.lengths(at, &here);
    let foot = ball.foot(at, &here);
    let exit = (v * foot.cosine + (u - v * cosine) * (side * foot.sine)) * radius;
    Link {
        toward: across * (side * ball.leaning(at)) - u * here.slope[0],
        exit,
        onward: (lamp - exit) * (one / length[1]),
        length,
        at,
        spread: ball.spread(at, &here),
        found: found & reachable & D::splat(LEAST_SINE).lt(sine) & zero.lt(at.cosine),
    }
}
