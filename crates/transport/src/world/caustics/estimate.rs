//! Estimates of the light that specular spheres bring to a receiver, for the choice of a sphere and of a
//! kind of path.
//!
//! The estimates take few operations, since every point needs them: they affect the noise, not the
//! expected image. A node of the tree is treated as one sphere at its center, with the spread of its
//! spheres as an uncertainty of directions and distances.

use super::connection::CausticPath;
use crate::lanes::Lanes;
use crate::vec3::Vec3;
use crate::world::lights::{WITHIN, horizon};

/// Least divergence of rays that is assumed: a focus is not sharper than that.
const LEAST_RATE: f32 = 0.2;

/// Contributions by kind of path, in the order of [`CausticPath::ALL`].
pub(super) type ByPath<L> = [L; CausticPath::COUNT as usize];

/// A row of nodes: specular spheres, or clusters of them.
pub(super) struct CasterNodes<L> {
    pub(super) center: Vec3<L>,
    /// Distance from `center` within which the spheres' centers are.
    pub(super) extent: L,
    /// Radius of a sphere; of several, the root of the mean square.
    pub(super) radius: L,
    /// Index of refraction outside over that inside; of several, a mean.
    pub(super) index: L,
    /// Sum of squared radii times reflectance at normal incidence.
    pub(super) reflected: L,
    /// Sum of squared radii times the rise of the reflectance toward grazing angles.
    pub(super) rise: L,
    /// Sum of squared radii of spheres that light passes through.
    pub(super) transmitted: L,
}

/// An emitter, and how it lights the receiver.
#[derive(Clone, Copy, Debug)]
pub(super) enum EmitterView {
    /// A sphere: its center, squared radius, and squared distance from the receiver.
    Near { center: glam::Vec3, radius2: f32, distance2: f32 },
    /// A sun: the direction toward it, and its squared angular radius.
    Far { direction: glam::Vec3, sine2: f32 },
}

/// An emitter as seen from a row of nodes.
struct Axis<L> {
    /// Vector toward the emitter, of at most unit length.
    toward: Vec3<L>,
    /// Inverse distance.
    inverse: L,
    /// Irradiance relative to that at the receiver.
    irradiance: L,
    /// Squared angular radius.
    sine2: L,
}

impl EmitterView {
    /// Returns the emitter as seen from each node.
    #[inline(always)]
    fn axes<L: Lanes>(&self, nodes: &CasterNodes<L>) -> Axis<L> {
        let splat = |v: glam::Vec3| Vec3::<L>::splat(v.x, v.y, v.z);
        match *self {
            Self::Far { direction, sine2 } => Axis {
                toward: splat(direction),
                inverse: L::splat(0.0),
                irradiance: L::splat(1.0),
                sine2: L::splat(sine2),
            },
            Self::Near { center, radius2, distance2 } => {
                let toward = splat(center) - nodes.center;
                let least = nodes.extent * nodes.extent * L::splat(WITHIN);
                let inverse2 = L::splat(1.0) / toward.dot(toward).max(least);
                let inverse = inverse2.sqrt();
                Axis {
                    toward: toward * inverse,
                    inverse,
                    irradiance: inverse2 * L::splat(distance2),
                    sine2: inverse2 * L::splat(radius2),
                }
            }
        }
    }
}

/// Estimates for a row of nodes.
pub(super) struct Contributions<L: Lanes> {
    /// Unoccluded irradiance that each kind of path brings, relative to the emitter's own irradiance.
    pub(super) paths: ByPath<L>,
    /// Lanes that contain the receiver and may have a focus there: the estimate is that of a mean.
    pub(super) vague: L::Mask,
}

impl<L: Lanes> CasterNodes<L> {
    /// Estimates the contributions of each kind of path to a point with this normal.
    #[inline(always)]
    pub(super) fn contributions(
        &self,
        point: Vec3<L>,
        normal: Vec3<L>,
        emitter: &EmitterView,
    ) -> Contributions<L> {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let axis = emitter.axes(self);
        let toward = self.center - point;
        let distance2 = toward.dot(toward);
        let extent2 = self.extent * self.extent;
        let inverse = one / distance2.max(extent2 * L::splat(WITHIN)).sqrt();
        let near = self.radius * inverse;
        let sine = (self.extent + self.radius) * inverse;
        let facing = horizon(toward.dot(normal) * inverse, sine).min(one);
        let level = facing * (inverse * inverse * axis.irradiance);
        let ends = near + self.radius * axis.inverse;
        // Cosine of the angle at the sphere between the emitter and the direction away from the point.
        let forward = (toward.dot(axis.toward) * inverse).min(one).max(-one);
        let side = (one - forward) * L::splat(0.5);
        // Reciprocal of the divergence, 2 - 2 x, squared: the first terms of its series.
        let x = (ends * side * L::splat(0.5)).min(one);
        let parted = x.mul_add(x.mul_add(L::splat(0.75), L::splat(0.5)), L::splat(0.25));
        let grazing = one - side;
        let reflectance = (grazing * grazing * grazing).mul_add(self.rise, self.reflected);
        let reflected = level * reflectance * parted;
        let spread = (self.extent * (inverse + axis.inverse)).min(one);
        let through = self.through(ends, forward, spread, level * self.transmitted, axis.sine2);
        // A leaf that contains the point has no light for it.
        let outside = near.lt(one) | zero.lt(self.extent);
        let paths = [reflected, through[0], through[1], through[2]];
        Contributions {
            paths: paths.map(|path| L::select(outside, path, zero)),
            vague: distance2.lt(extent2) & zero.lt(self.transmitted),
        }
    }

    /// Estimates the contributions of the paths through glass.
    #[inline(always)]
    fn through(&self, ends: L, forward: L, spread: L, level: L, sine2: L) -> [L; 3] {
        let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
        // The direction to the sphere of a cluster that is turned most favorably.
        let along = (one - spread * spread).sqrt();
        let across = (one - forward * forward).sqrt();
        let turned = forward.mul_add(along, across * spread);
        let forward = L::select(along.lt(forward), one, turned);
        let index2 = self.index * self.index;
        // Divergence of rays near the axis: 0 if a focus lies between both points.
        let straight = two - two * self.index;
        let rate = straight - ends;
        let diverges = zero.lt(rate);
        let parting = one / rate.abs().max(L::splat(LEAST_RATE));
        let parting2 = parting * parting;
        // Of a sphere with the index of refraction 1.5, within a factor of four for 1.2 to 2.4.
        let wide = L::splat(2.25);
        let edge = two * index2 - one;
        let beam = ((forward - edge) * L::splat(1.125)).max(zero).min(one);
        let crossed = level * (beam * beam * beam) * L::select(diverges, parting2, wide);
        // An approximation of the least turn on this side of the focus.
        let depth = (-rate).max(zero);
        let least_turn2 = depth * depth * depth * L::splat(6.0 * 4.0 / 27.0 / 1.44);
        let reach = least_turn2 + sine2;
        let within = (one - forward).lt(reach) & zero.lt(depth);
        // Of the spheres of a cluster, this part is within reach.
        let part = reach / (reach + spread * spread);
        let paraxial = L::select(within, level * part * parting2, zero);
        [crossed, paraxial, paraxial * L::splat(0.5)]
    }
}
