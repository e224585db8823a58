//! One ray alone: nothing is allocated, and no more is set up than it needs.
//!
//! [`interleaved`](super::interleaved) takes its time to set up many rays; the time of one is less than that.

use super::child_order::farthest_first;
use super::decision::{Decision, Nearest};
use super::single::{certainly_hits, chords};
use super::traversal::Query;
use super::{Child, DEPTH, Tree, WIDTH};
use crate::conservative::ConservativeRay;
use crate::lanes::{F32x8, Lanes, Mask, set_bits, shuffle, shuffle_numbers};
use crate::ray::{ExactRay, MISS};
use crate::slabs::Slabs;
use crate::spheres::LEAF;
use std::marker::PhantomData;

/// Capacity of a stack: the children still to visit, and a whole row of them after the last.
const STACK: usize = DEPTH * (WIDTH - 1) + 2 * WIDTH;

/// The hit of one ray.
#[derive(Clone, Copy, Debug)]
pub struct OneHit {
    /// Distance in units of the direction's length; unspecified if any hit was looked for.
    pub t: f64,
    /// Row of the sphere, or [`MISS`].
    pub sphere: u32,
    /// Number of decisions that were made on integers.
    pub exact: u64,
}

/// Finds the first hit of a ray, or any, at a distance less than `bound`, which is not NaN.
pub fn trace_one<Q: Query>(tree: Tree, ray: &ExactRay, bound: f64) -> OneHit {
    let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
    let slabs = Slabs::new(origin, direction);
    let single = ConservativeRay::new(origin.into(), direction.into());
    let mut decision = Decision::<Q> {
        spheres: tree.spheres,
        ray: *ray,
        own: MISS,
        target: MISS,
        nearest: Nearest { t: bound, error: 0.0, sphere: MISS },
        exact: 0,
        query: PhantomData,
    };
    let mut t_far = decision.bounds().1;
    let (mut child, mut near) = ([Child::NONE; STACK], [0.0_f32; STACK]);
    child[0] = Child::node(0);
    let mut top = usize::from(!tree.bvh.is_empty());
    while top > 0 {
        top -= 1;
        let next = child[top];
        if near[top] > t_far {
            continue;
        }
        if next.kind() == Child::NODE {
            let node = &tree.bvh.nodes()[next.index()];
            let (hit, enters) = slabs.enters(&node.planes, t_far);
            let order = farthest_first(slabs.octant, hit);
            let row: [u32; WIDTH] = shuffle_numbers(bytemuck::cast_ref(&node.child), order);
            child[top..top + WIDTH].copy_from_slice(bytemuck::cast_ref::<_, [Child; WIDTH]>(&row));
            shuffle(enters, order).store(&mut near[top..top + WIDTH]);
            top += hit.count_ones() as usize;
            continue;
        }
        let block = &tree.spheres.blocks()[next.index()];
        let chord = chords(&single, block);
        let enters = chord.near().to_array();
        for lane in set_bits(chord.may_hit(F32x8::splat(t_far)).bits()) {
            if enters[lane] > t_far {
                continue;
            }
            let row = next.index() * LEAF + lane;
            let sphere = || (tree.spheres.center(row), tree.spheres.radius(row));
            if Q::ANY && certainly_hits(&single, sphere(), decision.bounds().0) {
                return OneHit { t: bound, sphere: row as u32, exact: decision.exact };
            }
            if decision.test_sphere(row) {
                if Q::ANY {
                    return OneHit { t: bound, sphere: row as u32, exact: decision.exact };
                }
                t_far = decision.bounds().1;
            }
        }
    }
    OneHit { t: decision.nearest.t, sphere: decision.nearest.sphere, exact: decision.exact }
}
