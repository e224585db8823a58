//! Which light to sample: a choice that knows where the receiver is and how it is turned.
//!
//! After Conty Estevez and Kulla, "Importance Sampling of Many Lights with Adaptive Tree
//! Splitting", HPG 2018, with sixteen branches instead of two, all looked at in one row of lanes.
//! So sixteen lights are chosen by what each would give if nothing stood between, thousands by what
//! clusters would, and a crowd that is near is told apart sooner than by twos. Spheres shine in all
//! directions: no cones of emission are kept.
//!
//! What is infinitely far is a ball [`FAR`] away, and what shines from everywhere is a ball as large
//! as that about everything: one formula serves all.

mod row;

use super::grow::grow;
use crate::lanes::{F32x16, Lanes};
use crate::vec3;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Branches of a node, at most.
pub(super) const BRANCHES: usize = 16;

/// Distance of what is infinitely far, in units of which the spheres are about one wide.
pub(super) const FAR: f64 = 1e6;

/// What a light below the horizon counts, beside one at the zenith: chances stay above 0, so that
/// rounding cannot lose a light.
const HIDDEN: f32 = 1e-2;

/// Within a cluster, the least squared distance that counts, beside its squared radius: the mean of
/// the reciprocal over a ball is that of a third from its middle, and lights fill less than the ball.
/// Measured to be best.
const WITHIN: f32 = 0.25;

/// A light, or a cluster of them, as the choice sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// Irradiance on a plane that faces it, times the squared distance.
    pub(super) power: f64,
    /// Irradiance on a plane that faces it, of light that does not fall off.
    pub(super) steady: f64,
    /// Whether it is dark inside, as far as light samples go: an emissive sphere.
    pub(super) hollow: bool,
}

impl Ball {
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
    /// Where it is.
    pub point: Vec3,
    /// Unit normal of its surface, on the side that is lit.
    pub normal: Vec3,
    /// The sphere whose surface it is.
    pub own: u32,
}

/// Clusters of lights, in columns. The children of a node are neighbors, the root's are the first.
#[derive(Clone, Debug, Default)]
pub(super) struct Tree {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
    /// Negative for a hollow ball.
    pub(super) radius: Vec<f32>,
    pub(super) power: Vec<f32>,
    pub(super) steady: Vec<f32>,
    /// The first child; of a leaf, the light.
    pub(super) child: Vec<u32>,
    /// How many children; 0 for a leaf.
    pub(super) children: Vec<u8>,
    /// The node above; [`ROOT`] at the top.
    pub(super) parent: Vec<u32>,
    /// Number of the root's children.
    pub(super) top: u8,
    /// The leaf of each light; [`ROOT`] for one that does not shine.
    pub(super) leaf: Vec<u32>,
}

/// Instead of a node: what is above all.
pub(super) const ROOT: u32 = u32::MAX;

/// Sums of chances that are all well within single precision.
const RESOLVED: Range<f64> = 1e-30..1e30;

/// The chances of neighbors, up to a factor.
struct Chances {
    each: [f32; BRANCHES],
    total: f64,
}

impl Tree {
    /// The tree of these lights; `None` if none of them shines.
    pub(super) fn new(lights: &[Ball]) -> Option<Self> {
        grow(lights)
    }

    /// The same tree where the unit of length is another.
    pub(super) fn scaled(mut self, factor: f32) -> Self {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            scale(column, factor);
        }
        scale(&mut self.power, factor * factor);
        self
    }

    /// Chooses a light by a draw in [0, 1): its index, and the probability of the choice. The next
    /// draw chooses the same light or a neighbor.
    // Not where a lone light would have to go round it.
    #[inline(never)]
    pub(super) fn choose(&self, at: &Receiver, draw: f64) -> (usize, f32) {
        self.descend((0, usize::from(self.top)), at, (draw, 1.0))
    }

    /// Chooses among the `count` nodes from `first` on and below, which came with a probability.
    fn descend(
        &self,
        (mut first, mut count): (usize, usize),
        at: &Receiver,
        (mut draw, mut probability): (f64, f64),
    ) -> (usize, f32) {
        loop {
            let chances = self.chances(first, count, at);
            let (lane, rest) = chances.pick(count, draw);
            probability *= chances.of(lane);
            let node = first + lane;
            count = usize::from(self.children[node]);
            if count == 0 {
                return (self.child[node] as usize, probability as f32);
            }
            (first, draw) = (self.child[node] as usize, rest);
        }
    }

    /// The probability with which a light is chosen.
    #[inline(never)]
    pub(super) fn probability(&self, at: &Receiver, light: usize) -> f32 {
        let (mut node, mut probability) = (self.leaf[light], 1.0);
        if node == ROOT {
            return 0.0;
        }
        while node != ROOT {
            let above = self.parent[node as usize];
            let (first, count) = self.below(above);
            probability *= self.chances(first, count, at).of(node as usize - first);
            node = above;
        }
        probability as f32
    }

    fn below(&self, node: u32) -> (usize, usize) {
        if node == ROOT {
            return (0, usize::from(self.top));
        }
        (self.child[node as usize] as usize, usize::from(self.children[node as usize]))
    }

    /// The chances of the `count` nodes from `first` on. Where they leave single precision, power
    /// alone decides.
    #[inline(always)]
    fn chances(&self, first: usize, count: usize, at: &Receiver) -> Chances {
        let chances = Chances::new(self.irradiance(first, at), count);
        if RESOLVED.contains(&chances.total) {
            return chances;
        }
        let row = |column: &[f32]| F32x16::load(&column[first..]);
        Chances::new(row(&self.power) + row(&self.steady), count)
    }

    /// About what each of the nodes from `first` on gives to a receiver, if nothing is in between.
    #[inline(always)]
    fn irradiance(&self, first: usize, at: &Receiver) -> F32x16 {
        let row = |column: &[f32]| F32x16::load(&column[first..]);
        let splat = |v: Vec3| vec3::Vec3::splat(v.x, v.y, v.z);
        let nodes = Nodes {
            center: vec3::Vec3::new(row(&self.x), row(&self.y), row(&self.z)),
            radius: row(&self.radius),
            power: row(&self.power),
            steady: row(&self.steady),
        };
        nodes.irradiance(splat(at.point), splat(at.normal))
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
    /// About what each gives to the receiver in its lane, if nothing is in between.
    #[inline(always)]
    fn irradiance(&self, point: vec3::Vec3<L>, normal: vec3::Vec3<L>) -> L {
        let (zero, four) = (L::splat(0.0), L::splat(4.0));
        let toward = self.center - point;
        let (radius, distance2) = (self.radius, toward.dot(toward));
        let radius2 = radius * radius;
        let near = L::splat(1.0) / distance2.max(radius2 * L::splat(WITHIN)).sqrt();
        let (cosine, sine) = (toward.dot(normal) * near, radius.abs() * near);
        // Of a disc that the horizon cuts, about what the part above gives.
        let above = (cosine + sine).max(zero);
        let facing = L::select(cosine.lt(sine), above * above / (sine * four), cosine);
        let whole = (near * near).mul_add(self.power, self.steady);
        // What is faint beyond single precision keeps a chance.
        let given = (whole * facing.max(L::splat(HIDDEN))).max(L::splat(f32::MIN_POSITIVE));
        L::select(radius.is_negative() & distance2.lt(radius2), zero, given)
    }
}

impl Chances {
    #[inline(always)]
    fn new(chances: F32x16, count: usize) -> Self {
        let each = chances.to_array();
        Self { each, total: each[..count].iter().copied().map(f64::from).sum() }
    }

    /// The probability of a lane.
    #[inline(always)]
    fn of(&self, lane: usize) -> f64 {
        f64::from(self.each[lane]) / self.total
    }

    /// The lane in whose share a draw falls, and where in that share, in [0, 1).
    #[inline(always)]
    fn pick(&self, count: usize, draw: f64) -> (usize, f64) {
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
        // Rounding may leave a little past the last lane.
        (last.0, last.1.clamp(0.0, 1.0 - f64::EPSILON))
    }
}

#[cfg(test)]
mod tests;
