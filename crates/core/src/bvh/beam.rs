//! Frustum culling: whether any ray of a beam may hit a sphere.

use super::{Bvh, Child, Node};
use crate::lanes::{F32x8, Lanes, Mask, set_bits};
use crate::spheres::{SphereBlock, Spheres};
use glam::DVec3;

/// Planes of a beam.
const SIDES: usize = 5;

/// A bound of the rounding of rays, planes and spheres together, relative to their coordinates.
const ROUNDING: f32 = 4e-6;

/// A convex region that holds rays, origins and all that lies ahead of them.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    sides: [Side; SIDES],
    /// Distance by which the region is widened, in the unit of the scene.
    margin: f32,
}

/// A plane: points of the region have at least `offset` along the normal, which is a unit vector or 0.
#[derive(Clone, Copy, Debug)]
struct Side {
    normal: [f32; 3],
    offset: f32,
}

impl Beam {
    /// The points `p` with `normal.dot(p) >= offset` for all of the planes. Normals may have any length,
    /// 0 where there is no plane. No ray starts farther than `reach` from the world's origin.
    pub fn new(planes: [(DVec3, f64); SIDES], reach: f64) -> Self {
        let sides = planes.map(|(normal, offset)| {
            let length = normal.length();
            if length > 0.0 {
                let normal = (normal / length).as_vec3().to_array();
                Side { normal, offset: (offset / length) as f32 }
            } else {
                Side { normal: [0.0; 3], offset: f32::NEG_INFINITY }
            }
        });
        Self { sides, margin: reach as f32 * ROUNDING }
    }

    /// Returns which of eight convex bodies reach into the region, or nearly. `most` gives the support of
    /// each body along a direction, and the largest sum of coordinates of its points.
    #[inline(always)]
    fn meets(&self, most: impl Fn([f32; 3]) -> (F32x8, F32x8)) -> u32 {
        let mut met = !0;
        for side in &self.sides {
            let (reach, size) = most(side.normal);
            let slack = size.relaxed_mul_add(F32x8::splat(ROUNDING), F32x8::splat(self.margin));
            // False for what is nowhere, whose coordinates are infinite or no numbers.
            met &= Lanes::lt(F32x8::splat(side.offset), reach + slack).bits();
        }
        met
    }

    /// The children whose boxes the region meets.
    fn meets_boxes(&self, node: &Node) -> u32 {
        self.meets(|normal| {
            let (mut reach, mut size) = (F32x8::splat(0.0), F32x8::splat(0.0));
            for (planes, along) in node.planes.iter().zip(normal) {
                let corner = F32x8::load(&planes[usize::from(along >= 0.0)]);
                reach = corner.relaxed_mul_add(F32x8::splat(along), reach);
                size += Lanes::abs(corner);
            }
            (reach, size)
        })
    }

    /// The spheres of a block that the region meets.
    fn meets_spheres(&self, block: &SphereBlock) -> u32 {
        let radius = F32x8::load(&block.radius);
        self.meets(|normal| {
            let (mut reach, mut size) = (radius, radius);
            for (center, along) in [&block.x, &block.y, &block.z].into_iter().zip(normal) {
                let center = F32x8::load(center);
                reach = center.relaxed_mul_add(F32x8::splat(along), reach);
                size += Lanes::abs(center);
            }
            (reach, size)
        })
    }
}

impl Bvh {
    /// Returns whether any ray in a beam may hit a sphere: never false if one does.
    pub fn may_be_hit(&self, spheres: &Spheres, beam: &Beam) -> bool {
        self.may_meet(beam, |block| beam.meets_spheres(&spheres.blocks()[block]) != 0)
    }

    /// Returns whether a beam meets the box of a block that `meets` accepts.
    pub(crate) fn may_meet(&self, beam: &Beam, meets: impl Fn(usize) -> bool) -> bool {
        let mut open = Vec::new();
        if !self.is_empty() {
            open.push(Child::node(0));
        }
        while let Some(child) = open.pop() {
            if child.kind() == Child::BLOCK {
                if meets(child.index()) {
                    return true;
                }
                continue;
            }
            let node = &self.nodes[child.index()];
            open.extend(set_bits(beam.meets_boxes(node)).map(|i| node.child[i]));
        }
        false
    }
}
