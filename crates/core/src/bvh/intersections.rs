//! All spheres that one ray intersects, not only the first.

use super::Tree;
use super::decision::Decision;
use super::one_ray::{STACK, Search, walk};
use super::query::Closest;
use super::single::chords;
use crate::conservative::ConservativeRay;
use crate::intersect::Root;
use crate::lanes::{F32x8, Mask, set_bits};
use crate::ray::ExactRay;
use crate::slabs::RaySlabs;
use crate::spheres::{LEAF, SphereBlock};
use std::ops::ControlFlow;

/// An intersection of a ray and a body.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Intersection {
    /// Row of the body.
    pub(crate) row: usize,
    /// The hit at which the ray enters it, or leaves it if it starts inside.
    pub(crate) root: Root,
    /// True if the ray starts inside.
    pub(crate) inside: bool,
}

/// Calls a function with each sphere that a ray intersects, in no order. The function returns a distance beyond which no sphere
/// matters any more, no more than before, or breaks; the first such distance is `t_far`. `own` and `target` as in
/// [`Rays`](crate::ray::Rays).
pub(crate) fn for_each_intersection(
    tree: Tree,
    ray: &ExactRay,
    [own, target]: [u32; 2],
    t_far: f32,
    visit: impl FnMut(Intersection) -> ControlFlow<(), f32>,
) {
    let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
    let decision = Decision::<Closest>::of_ray(tree.spheres, ray, f64::INFINITY);
    let mut search = IntersectionSearch {
        ray: ConservativeRay::new(origin.into(), direction.into()),
        decision: Decision { own, target, ..decision },
        t_far,
        visit,
    };
    // The stack has a place for every child that can wait.
    walk::<_, STACK>(
        tree.bvh,
        tree.spheres.blocks(),
        &RaySlabs::new(origin, direction),
        &mut search,
    );
}

/// A search that visits each sphere.
struct IntersectionSearch<'a, V> {
    ray: ConservativeRay<f32>,
    decision: Decision<'a, Closest>,
    t_far: f32,
    visit: V,
}

impl<V: FnMut(Intersection) -> ControlFlow<(), f32>> Search for IntersectionSearch<'_, V> {
    const ANY: bool = false;
    type Block = SphereBlock;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.t_far
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &SphereBlock) -> bool {
        let chord = chords(&self.ray, block, None);
        let enters = chord.near().to_array();
        for lane in set_bits(chord.may_hit(F32x8::splat(self.t_far)).bits()) {
            if enters[lane] > self.t_far {
                continue;
            }
            let row = index * LEAF + lane;
            let Some((root, inside)) = self.decision.intersects(row) else { continue };
            match (self.visit)(Intersection { row, root, inside }) {
                ControlFlow::Continue(t_far) => self.t_far = t_far,
                ControlFlow::Break(()) => return true,
            }
        }
        false
    }
}
