//! The light tree: chooses a light by its estimated contribution to a receiver.
//!
//! After Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting",
//! HPG 2018, with sixteen branches instead of two, all evaluated in one row of lanes. So up to sixteen
//! lights are chosen by their own unoccluded contributions, thousands by those of clusters, and a near
//! group of lights is split sooner than by a binary tree. Spheres emit in all directions: there are no
//! cones of emission.
//!
//! A light at infinity has bounds at the distance [`FAR`], and light from everywhere has bounds of that
//! radius around the scene: one formula serves all.

mod row;

use super::build::build_tree;
use crate::lanes::{F32x16, Lanes};
use crate::vec3;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Most branches of a node.
pub(in crate::world) const BRANCHES: usize = 16;

/// Distance of lights at infinity, in units of the scene's extent.
pub(super) const FAR: f64 = 1e6;

/// Weight of a light below the horizon, relative to the zenith: probabilities stay above 0, so that
/// rounding cannot lose a light.
const HIDDEN: f32 = 1e-2;

/// Least squared distance within a cluster, relative to its squared radius: the mean of the reciprocal
/// over a ball is that at a third from its center, and lights fill less than the ball. The best of
/// measured values.
pub(in crate::world) const WITHIN: f32 = 0.25;

/// Bounding sphere of a light or a cluster, with its power.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::world) struct LightBounds {
    pub(in crate::world) center: DVec3,
    pub(in crate::world) radius: f64,
    /// Irradiance on a plane that faces it, times the squared distance.
    pub(in crate::world) power: f64,
    /// Irradiance on a plane that faces it, of light without falloff.
    pub(in crate::world) steady: f64,
    /// True if light samples find nothing inside: an emissive sphere.
    pub(in crate::world) hollow: bool,
}

impl LightBounds {
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self {
            center: self.center * factor,
            radius: self.radius * factor,
            power: self.power * factor * factor,
            ..self
        }
    }
}

fn scale(column: &mut [f32], factor: f32) {
    for value in column {
        *value *= factor;
    }
}

/// A point that is lit.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// The point.
    pub point: Vec3,
    /// Unit normal of its surface, on the side that is lit.
    pub normal: Vec3,
    /// The sphere whose surface it is on.
    pub own: u32,
}

/// Clusters of lights, in columns. The children of a node are neighbors, and the root's are the first.
#[derive(Clone, Debug, Default)]
pub(in crate::world) struct Tree {
    pub(in crate::world) x: Vec<f32>,
    pub(in crate::world) y: Vec<f32>,
    pub(in crate::world) z: Vec<f32>,
    /// Radius of the bounds, negative if hollow.
    pub(in crate::world) radius: Vec<f32>,
    pub(super) power: Vec<f32>,
    pub(super) steady: Vec<f32>,
    /// First child; the light of a leaf.
    pub(in crate::world) child: Vec<u32>,
    /// Number of children; 0 for a leaf.
    pub(in crate::world) children: Vec<u8>,
    /// Parent node; [`ROOT`] for children of the root.
    pub(in crate::world) parent: Vec<u32>,
    /// Number of the root's children.
    pub(super) top: u8,
    /// Leaf of each light; [`ROOT`] for a light that is not luminous.
    pub(in crate::world) leaf: Vec<u32>,
}

/// The children of a node, which are neighbors.
#[derive(Clone, Copy, Debug)]
pub(in crate::world) struct Siblings {
    /// The first.
    pub(in crate::world) first: usize,
    /// Their number.
    pub(in crate::world) count: usize,
}

/// The root, which has no row.
pub(in crate::world) const ROOT: u32 = u32::MAX;

/// Range of sums that single precision resolves well.
const RESOLVED: Range<f64> = 1e-30..1e30;

/// Relative probabilities of sibling nodes.
pub(in crate::world) struct Chances {
    each: [f32; BRANCHES],
    pub(in crate::world) total: f64,
}

/// The part that a light's direction plays in the choice.
pub(super) trait Facing {
    /// Returns the factor on the irradiance of a light whose center is at this cosine to the normal, and
    /// whose bounds have this angular radius, as a sine.
    fn facing<L: Lanes>(cosine: L, sine: L) -> L;
}

/// A surface receives light from above its horizon.
pub(super) struct OneSided;

impl Facing for OneSided {
    #[inline(always)]
    fn facing<L: Lanes>(cosine: L, sine: L) -> L {
        horizon(cosine, sine)
    }
}

/// A point receives light from everywhere.
pub(super) struct AllAround;

impl Facing for AllAround {
    #[inline(always)]
    fn facing<L: Lanes>(_: L, _: L) -> L {
        L::splat(1.0)
    }
}

/// Returns the cosine of a disc's center; an approximation for the part that is above the horizon, for
/// a disc of this angular radius, as a sine, that crosses it.
#[inline(always)]
pub(in crate::world) fn horizon<L: Lanes>(cosine: L, sine: L) -> L {
    let above = (cosine + sine).max(L::splat(0.0));
    L::select(cosine.lt(sine), above * above / (sine * L::splat(4.0)), cosine)
}

impl Tree {
    /// Builds the tree of these lights; `None` if none is luminous.
    pub(in crate::world) fn new(lights: &[LightBounds]) -> Option<Self> {
        build_tree(lights)
    }

    /// Scales the unit of length.
    pub(super) fn scaled(mut self, factor: f32) -> Self {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            scale(column, factor);
        }
        scale(&mut self.power, factor * factor);
        self
    }

    /// Chooses a light by a random number in [0, 1): its index, the probability of the choice, and the
    /// place of the number in the light's share. The next random number chooses the same light or a
    /// neighbor.
    // Not inlined: the case of a single light should not have to jump around it.
    #[inline(never)]
    pub(super) fn choose<F: Facing>(&self, at: &Receiver, draw: f64) -> (usize, f32, f64) {
        self.descend::<F>(self.below(ROOT), at, draw, 1.0)
    }

    /// Chooses among nodes and their descendants, given the probability of reaching them.
    fn descend<F: Facing>(
        &self,
        mut nodes: Siblings,
        at: &Receiver,
        mut draw: f64,
        mut probability: f64,
    ) -> (usize, f32, f64) {
        loop {
            let chances = self.chances::<F>(nodes, at);
            let (lane, rest) = chances.pick(nodes.count, draw);
            probability *= chances.of(lane);
            let node = nodes.first + lane;
            let (first, count) = (self.child[node] as usize, usize::from(self.children[node]));
            if count == 0 {
                return (first, probability as f32, rest);
            }
            nodes = Siblings { first, count };
            draw = rest;
        }
    }

    /// Returns the probability with which a light is chosen.
    #[inline(never)]
    pub(super) fn probability<F: Facing>(&self, at: &Receiver, light: usize) -> f32 {
        let (mut node, mut probability) = (self.leaf[light], 1.0);
        if node == ROOT {
            return 0.0;
        }
        while node != ROOT {
            let above = self.parent[node as usize];
            let nodes = self.below(above);
            probability *= self.chances::<F>(nodes, at).of(node as usize - nodes.first);
            node = above;
        }
        probability as f32
    }

    /// Returns the children of a node or the [`ROOT`].
    pub(in crate::world) fn below(&self, node: u32) -> Siblings {
        if node == ROOT {
            return Siblings { first: 0, count: usize::from(self.top) };
        }
        let node = node as usize;
        Siblings { first: self.child[node] as usize, count: usize::from(self.children[node]) }
    }

    /// Returns the relative probabilities of nodes; by power alone if they leave the range of
    /// single precision.
    #[inline(always)]
    fn chances<F: Facing>(&self, nodes: Siblings, at: &Receiver) -> Chances {
        let Siblings { first, count } = nodes;
        let chances = Chances::new(self.irradiance::<F>(first, at), count);
        if RESOLVED.contains(&chances.total) {
            return chances;
        }
        let row = |column: &[f32]| F32x16::load(&column[first..]);
        Chances::new(row(&self.power) + row(&self.steady), count)
    }

    /// Estimates the unoccluded irradiance of each of the nodes from `first` on at a receiver.
    #[inline(always)]
    fn irradiance<F: Facing>(&self, first: usize, at: &Receiver) -> F32x16 {
        let row = |column: &[f32]| F32x16::load(&column[first..]);
        let splat = |v: Vec3| vec3::Vec3::splat(v.x, v.y, v.z);
        let nodes = Nodes {
            center: vec3::Vec3::new(row(&self.x), row(&self.y), row(&self.z)),
            radius: row(&self.radius),
            power: row(&self.power),
            steady: row(&self.steady),
        };
        nodes.irradiance::<F>(splat(at.point), splat(at.normal))
    }
}

/// A row of nodes, or one in every lane.
struct Nodes<L> {
    center: vec3::Vec3<L>,
    radius: L,
    power: L,
    steady: L,
}

impl<L: Lanes> Nodes<L> {
    /// Estimates the unoccluded irradiance of each node at the receiver in its lane.
    #[inline(always)]
    fn irradiance<F: Facing>(&self, point: vec3::Vec3<L>, normal: vec3::Vec3<L>) -> L {
        let zero = L::splat(0.0);
        let toward = self.center - point;
        let (radius, distance2) = (self.radius, toward.dot(toward));
        let radius2 = radius * radius;
        let near = L::splat(1.0) / distance2.max(radius2 * L::splat(WITHIN)).sqrt();
        let facing = F::facing(toward.dot(normal) * near, radius.abs() * near);
        let total = (near * near).mul_add(self.power, self.steady);
        // Light below the range of single precision keeps a positive probability.
        let given = (total * facing.max(L::splat(HIDDEN))).max(L::splat(f32::MIN_POSITIVE));
        L::select(radius.is_negative() & distance2.lt(radius2), zero, given)
    }
}

impl Chances {
    /// Creates the probabilities of the first `count` lanes.
    #[inline(always)]
    pub(in crate::world) fn new(chances: F32x16, count: usize) -> Self {
        let each = chances.to_array();
        Self { each, total: each[..count].iter().copied().map(f64::from).sum() }
    }

    /// Returns the probability of a lane.
    #[inline(always)]
    pub(in crate::world) fn of(&self, lane: usize) -> f64 {
        f64::from(self.each[lane]) / self.total
    }

    /// Returns the lane in whose share a random number falls, and its place in that share, in [0, 1).
    #[inline(always)]
    pub(in crate::world) fn pick(&self, count: usize, draw: f64) -> (usize, f64) {
        let (mut left, mut last) = (draw * self.total, (0, 0.0));
        for (lane, chance) in self.each[..count].iter().copied().map(f64::from).enumerate() {
            if chance > 0.0 {
                last = (lane, left / chance);
                if left < chance {
                    break;
                }
            }
            left -= chance;
        }
        // Rounding may leave a remainder past the last lane.
        (last.0, last.1.clamp(0.0, 1.0 - f64::EPSILON))
    }
}

#[cfg(test)]
mod tests;
