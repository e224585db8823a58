//! All bodies of one kind that one ray intersects, not only the first.

use super::{BodyHit, BodyTree, FilterRay, Shape};
use crate::bvh::{Intersection, STACK, Search, walk};
use crate::lanes::set_bits;
use crate::ray::ExactRay;
use crate::slabs::RaySlabs;
use crate::spheres::LEAF;
use std::ops::ControlFlow;

/// Calls a function with each body that a ray intersects, in no order. The function returns a distance beyond which no body
/// matters any more, no more than before, or breaks; the first such distance is `t_far`. Bodies in `ends` are left out.
pub(crate) fn for_each_intersection<S: Shape>(
    tree: &BodyTree<S>,
    ray: &ExactRay,
    ends: [Option<usize>; 2],
    t_far: f32,
    visit: impl FnMut(Intersection) -> ControlFlow<(), f32>,
) {
    let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
    let filter = FilterRay::new(origin, direction);
    let mut search = IntersectionSearch { tree, filter, ray, ends, t_far, visit };
    let (blocks, bvh) = tree.parts();
    walk::<_, STACK>(bvh, blocks, &RaySlabs::new(origin, direction), &mut search);
}

/// A search that visits each body.
struct IntersectionSearch<'a, S: Shape, V> {
    tree: &'a BodyTree<S>,
    filter: FilterRay,
    ray: &'a ExactRay,
    ends: [Option<usize>; 2],
    t_far: f32,
    visit: V,
}

impl<S: Shape, V: FnMut(Intersection) -> ControlFlow<(), f32>> Search
    for IntersectionSearch<'_, S, V>
{
    const ANY: bool = false;
    type Block = S::Block;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.t_far
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &S::Block) -> bool {
        let (lanes, near) = S::may_hit(&self.filter, block, self.t_far);
        let near = near.to_array();
        for lane in set_bits(lanes) {
            let row = index * LEAF + lane;
            if near[lane] > self.t_far || self.ends.contains(&Some(row)) {
                continue;
            }
            let body = self.tree.body(row);
            let Some(BodyHit { root, .. }) = body.intersect(self.ray) else { continue };
            let inside = body.contains(self.ray.origin);
            match (self.visit)(Intersection { row, root, inside }) {
                ControlFlow::Continue(t_far) => self.t_far = t_far,
                ControlFlow::Break(()) => return true,
            }
        }
        false
    }
}
