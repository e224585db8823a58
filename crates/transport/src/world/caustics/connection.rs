//! Connections of a receiver and a point of an emitter by a specular sphere, in space.

use super::specular_sphere::{Angle, Deflection, SpecularSphere};
use crate::lanes::Doubles;
use crate::vec3::Vec3;

/// Sine below which two directions from the center define no plane.
const LEAST_SINE: f64 = 1e-12;

/// A kind of path of light from an emitter to a receiver by a sphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CausticPath {
    /// Reflection on the outside.
    Reflected,
    /// Refraction through the sphere, across the axis from the receiver to the center.
    Crossed,
    /// Refraction on one side of the axis; of two such paths, the one that is nearer to the axis.
    Paraxial,
    /// Refraction on one side of the axis, farther from it.
    Marginal,
}

/// Masks of the kinds of a row of paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PathMasks<D: Doubles> {
    pub(crate) through: D::Mask,
    pub(crate) crosses: D::Mask,
    pub(crate) inner: D::Mask,
}

/// A path from a receiver to a point of an emitter by a sphere; points are relative to its center.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Connection<D: Doubles> {
    /// Unit vector from the receiver to the sphere.
    pub(crate) toward: Vec3<D>,
    /// Point where the path leaves the sphere.
    pub(crate) exit: Vec3<D>,
    /// Unit vector from there to the emitter.
    pub(crate) toward_emitter: Vec3<D>,
    /// Lengths of both segments.
    pub(crate) length: [D; 2],
    /// Angle of incidence.
    pub(crate) at: Angle<D>,
    /// Area across the ray at the emitter per steradian at the receiver, over the squared distance of
    /// the emitter from the center.
    pub(crate) spread: D,
    /// Mask of the paths that exist; other lanes are meaningless.
    pub(crate) found: D::Mask,
}

impl CausticPath {
    /// Number of kinds.
    pub(crate) const COUNT: u32 = 4;

    /// All kinds, in order.
    pub(crate) const ALL: [Self; Self::COUNT as usize] =
        [Self::Reflected, Self::Crossed, Self::Paraxial, Self::Marginal];

    /// Returns the kind of a code.
    #[inline(always)]
    pub(crate) fn of(code: u32) -> Self {
        Self::ALL[(code % Self::COUNT) as usize]
    }

    /// Returns the kind of the path of a ray that passes through the sphere with deflection `turn`.
    pub(crate) fn through(turn: &Deflection<f64>) -> Self {
        match (turn.angle.sine > 0.0, turn.rate > 0.0) {
            (true, _) => Self::Crossed,
            (false, false) => Self::Paraxial,
            (false, true) => Self::Marginal,
        }
    }
}

/// Connects a receiver and a point of an emitter by a sphere with this radius and index of refraction,
/// outside over inside. Both points are outside, and relative to the center.
#[inline(always)]
pub(crate) fn connect<D: Doubles>(
    radius: D,
    index: D,
    [receiver, emitter]: [Vec3<D>; 2],
    paths: PathMasks<D>,
) -> Connection<D> {
    let (zero, one, two) = (D::splat(0.0), D::splat(1.0), D::splat(2.0));
    let distance = [receiver, emitter].map(|place| place.dot_unfused(place).sqrt());
    let u = receiver * (one / distance[0]);
    let v = emitter * (one / distance[1]);
    let cosine = u.dot_unfused(v);
    let across = v - u * cosine;
    let sine = across.dot_unfused(across).sqrt();
    let stays = D::select(paths.through, -cosine, cosine);
    let turn =
        Angle { sine: D::select(paths.through & !paths.crosses, -sine, sine), cosine: stays };
    let edge = one - two * index * index;
    let edge = D::select(paths.crosses, -edge, edge);
    let reachable = !paths.through | edge.lt(stays);
    let sphere = SpecularSphere::new(radius, distance, D::select(paths.through, index, zero));
    let (at, found) = sphere.find(turn, paths.inner);
    let here = sphere.turn(at);
    let side = D::select(paths.crosses, -one, one) / sine;
    let length = sphere.lengths(at, &here);
    let exit_angle = sphere.exit_angle(at, &here);
    let exit = (v * exit_angle.cosine + (u - v * cosine) * (side * exit_angle.sine)) * radius;
    Connection {
        toward: across * (side * sphere.receiver_sine(at)) - u * here.slope[0],
        exit,
        toward_emitter: (emitter - exit) * (one / length[1]),
        length,
        at,
        spread: sphere.spread(at, &here),
        found: found & reachable & D::splat(LEAST_SINE).lt(sine) & zero.lt(at.cosine),
    }
}
