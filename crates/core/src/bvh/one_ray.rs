//! One ray alone: nothing is allocated, and no more is set up than it needs.
//!
//! [`interleaved`](super::interleaved) takes its time to set up many rays; the time of one is less than that.
//!
//! # Rays from far away
//!
//! Bounds of the conservative tests grow with the distance of the origin ([`Slabs`],
//! [`conservative`](crate::conservative)): from a million times the size of the scene they rule out nothing. So the
//! tests get a ray that starts nearer, on about the same line, and boxes and radii that are larger by as much as the
//! two lines may be apart. If the largest coordinates of the origin and of the moved origin are `o` and `m`, double
//! precision puts the moved origin less than `2^-50 o` beside the line, and single precision moves it by less than
//! `2^-23 m`. By so much each point of the ray is off from the moved ray's. The decision gets the ray as it is.

use super::child_order::farthest_first;
use super::decision::{Decision, Nearest};
use super::resolver::rounded_out;
use super::single::{certainly_hits, chords};
use super::traversal::Query;
use super::{Child, DEPTH, Tree, WIDTH};
use crate::conservative::ConservativeRay;
use crate::lanes::{F32x8, Lanes, Mask, set_bits, shuffle, shuffle_numbers};
use crate::ray::{ExactRay, MISS};
use crate::slabs::{RaySlabs, Slabs};
use crate::spheres::LEAF;
use std::marker::PhantomData;

/// Capacity of a stack that every tree needs: the children still to visit, and a whole row of them after the last.
const STACK: usize = DEPTH * (WIDTH - 1) + 2 * WIDTH;

/// Capacity of a stack that suffices for about all rays: what is not there is not zeroed.
const SMALL_STACK: usize = 64;

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
#[inline(always)]
pub fn trace_one<Q: Query>(tree: Tree, ray: &ExactRay, bound: f64) -> OneHit {
    let near = MovedRay { origin: ray.origin.as_vec3(), shift: 0.0, slack: 0.0 };
    let hit = walk::<Q, SMALL_STACK, false>(tree, ray, &near, bound);
    hit.unwrap_or_else(|| walk_deeply::<Q, false>(tree, ray, &near, bound))
}

/// Finds what [`trace_one`] does for a ray whose origin is far from the scene, which lies in the cube from -1 to 1: its
/// coordinates are at most 2^40.
pub fn trace_far<Q: Query>(tree: Tree, ray: &ExactRay, bound: f64) -> OneHit {
    let direction2 = ray.direction.length_squared();
    // Two units before the point that is nearest to the scene's middle, where the ray is outside of the cube.
    let shift = -ray.origin.dot(ray.direction) / direction2 - 2.0 / direction2.sqrt();
    let shift = shift.max(0.0);
    let origin = ray.at(shift);
    let slack = (ray.origin.abs().max_element() + 1.0) * (1.0 / (1_u64 << 48) as f64)
        + (origin.abs().max_element() + 1.0) * (1.0 / (1 << 22) as f64);
    let moved = MovedRay { origin: origin.as_vec3(), shift, slack };
    walk_deeply::<Q, true>(tree, ray, &moved, bound)
}

/// The start of a ray for the conservative tests.
struct MovedRay {
    /// The origin, moved along the ray.
    origin: glam::Vec3,
    /// How far, in units of the direction's length.
    shift: f64,
    /// No point of the ray is farther than half of this from that of the moved ray.
    slack: f64,
}

#[inline(never)]
fn walk_deeply<Q: Query, const MOVED: bool>(
    tree: Tree,
    ray: &ExactRay,
    moved: &MovedRay,
    bound: f64,
) -> OneHit {
    let miss = OneHit { t: bound, sphere: MISS, exact: 0 };
    walk::<Q, STACK, MOVED>(tree, ray, moved, bound).unwrap_or(miss)
}

/// Passes the tree with a stack of so many places; `None` if they do not suffice.
#[inline(always)]
fn walk<Q: Query, const PLACES: usize, const MOVED: bool>(
    tree: Tree,
    ray: &ExactRay,
    moved: &MovedRay,
    bound: f64,
) -> Option<OneHit> {
    let direction = ray.direction.as_vec3();
    let single = ConservativeRay::new(moved.origin.into(), direction.into());
    let mut slabs = RaySlabs::new(moved.origin, direction);
    if MOVED {
        slabs = slabs.widened(moved.slack as f32);
    }
    let mut decision = Decision::<Q> {
        spheres: tree.spheres,
        ray: *ray,
        own: MISS,
        target: MISS,
        nearest: Nearest { t: bound, error: 0.0, sphere: MISS },
        exact: 0,
        query: PhantomData,
    };
    // The distance beyond which nothing counts, from the moved origin.
    let bound_of = |nearest: Nearest| {
        let Nearest { t, error, .. } = nearest;
        if MOVED {
            rounded_out((t + error - moved.shift + moved.slack) as f32).1
        } else {
            nearest.bounds().1
        }
    };
    let mut t_far = bound_of(decision.nearest);
    let (mut child, mut near) = ([Child::NONE; PLACES], [0.0_f32; PLACES]);
    child[0] = Child::node(0);
    let mut top = usize::from(!tree.bvh.is_empty());
    while top > 0 {
        top -= 1;
        let next = child[top];
        if near[top] > t_far {
            continue;
        }
        if next.kind() == Child::NODE {
            if top + WIDTH > PLACES {
                return None;
            }
            let node = &tree.bvh.nodes()[next.index()];
            let (hit, enters) = slabs.enters(&node.planes, t_far);
            let order = farthest_first(slabs.octant(), hit);
            let row: [u32; WIDTH] = shuffle_numbers(bytemuck::cast_ref(&node.child), order);
            child[top..top + WIDTH].copy_from_slice(bytemuck::cast_ref::<_, [Child; WIDTH]>(&row));
            shuffle(enters, order).store(&mut near[top..top + WIDTH]);
            top += hit.count_ones() as usize;
            continue;
        }
        let block = &tree.spheres.blocks()[next.index()];
        let chord = chords(&single, block, MOVED.then_some(moved.slack as f32));
        let enters = chord.near().to_array();
        for lane in set_bits(chord.may_hit(F32x8::splat(t_far)).bits()) {
            if enters[lane] > t_far {
                continue;
            }
            let row = next.index() * LEAF + lane;
            let sphere = || (tree.spheres.center(row), tree.spheres.radius(row));
            if !MOVED && Q::ANY && certainly_hits(&single, sphere(), decision.bounds().0) {
                return Some(OneHit { t: bound, sphere: row as u32, exact: decision.exact });
            }
            let nearer =
                if MOVED { decision.test_sphere_from_afar(row) } else { decision.test_sphere(row) };
            if nearer {
                if Q::ANY {
                    return Some(OneHit { t: bound, sphere: row as u32, exact: decision.exact });
                }
                t_far = bound_of(decision.nearest);
            }
        }
    }
    let Nearest { t, sphere, .. } = decision.nearest;
    Some(OneHit { t, sphere, exact: decision.exact })
}
