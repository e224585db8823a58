//! One ray alone: nothing is allocated, and no more is set up than it needs.
//!
//! [`interleaved`](super::interleaved) takes its time to set up many rays; the time of one is less than that.
//!
//! The child whose box is entered first is visited next, and the others of a node in the order of
//! [`child_order`](super::child_order): first hits take a fifth of the nodes and a third of the leaves less than in that order
//! alone, and hardly more than in the order of all distances.
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
use super::query::Query;
use super::resolver::rounded_out;
use super::single::{certainly_hits, chords};
use super::{Bvh, Child, DEPTH, Tree, WIDTH};
use crate::conservative::ConservativeRay;
use crate::lanes::{F32x8, Lanes, Mask, least_lane, set_bits, shuffle, shuffle_numbers};
use crate::ray::{ExactRay, MISS};
use crate::slabs::{RaySlabs, Slabs};
use crate::spheres::{LEAF, SphereBlock};

/// Capacity of a stack that every tree needs: the children still to visit, and a whole row of them after the last.
pub(crate) const STACK: usize = DEPTH * (WIDTH - 1) + 2 * WIDTH;

/// Capacity of a stack that suffices for about all rays: what is not there is not zeroed.
pub(crate) const SMALL_STACK: usize = 64;

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
    let hit = decide::<Q, SMALL_STACK, false>(tree, ray, &near, bound);
    hit.unwrap_or_else(|| decide_deeply::<Q, false>(tree, ray, &near, bound))
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
    decide_deeply::<Q, true>(tree, ray, &moved, bound)
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
fn decide_deeply<Q: Query, const MOVED: bool>(
    tree: Tree,
    ray: &ExactRay,
    moved: &MovedRay,
    bound: f64,
) -> OneHit {
    let miss = OneHit { t: bound, sphere: MISS, exact: 0 };
    decide::<Q, STACK, MOVED>(tree, ray, moved, bound).unwrap_or(miss)
}

/// Finds a hit with a stack of so many places; `None` if they do not suffice.
#[inline(always)]
fn decide<Q: Query, const PLACES: usize, const MOVED: bool>(
    tree: Tree,
    ray: &ExactRay,
    moved: &MovedRay,
    bound: f64,
) -> Option<OneHit> {
    let direction = ray.direction.as_vec3();
    let mut slabs = RaySlabs::new(moved.origin, direction);
    if MOVED {
        slabs = slabs.widened(moved.slack as f32);
    }
    let mut search = DecidedSearch::<Q, MOVED> {
        ray: ConservativeRay::new(moved.origin.into(), direction.into()),
        moved,
        decision: Decision::of_ray(tree.spheres, ray, bound),
        t_far: 0.0,
    };
    search.update_bound();
    walk::<_, PLACES>(tree.bvh, tree.spheres.blocks(), &slabs, &mut search)?;
    let Nearest { t, sphere, .. } = search.decision.nearest;
    Some(OneHit { t, sphere, exact: search.decision.exact })
}

/// A search for the hit of a ray, block by block.
pub(crate) trait Search {
    /// True if the search ends at the first hit: until then its bound does not change.
    const ANY: bool;

    /// Bodies of a leaf.
    type Block;

    /// Returns the distance beyond which nothing counts.
    fn t_far(&self) -> f32;

    /// Tests the bodies of the block at `index`. Returns whether the search has ended.
    fn test_block(&mut self, index: usize, block: &Self::Block) -> bool;
}

/// Passes the tree with a stack of so many places; `None` if they do not suffice.
#[inline(always)]
pub(crate) fn walk<S: Search, const PLACES: usize>(
    bvh: &Bvh,
    blocks: &[S::Block],
    slabs: &RaySlabs,
    search: &mut S,
) -> Option<()> {
    let nodes = bvh.nodes();
    if nodes.is_empty() {
        return Some(());
    }
    let (mut child, mut near) = ([Child::NONE; PLACES], [0.0_f32; PLACES]);
    let (mut next, mut top) = (Child::node(0), 0);
    loop {
        if next.kind() == Child::NODE {
            let node = &nodes[next.index()];
            let (entered, enters) = slabs.entered(&node.planes, search.t_far());
            let hit = entered.bits();
            if hit != 0 {
                if top + WIDTH > PLACES {
                    return None;
                }
                // The nearest is not read from the stack, which would wait for what was just written.
                let nearest = least_lane(enters, entered);
                next = node.child[nearest];
                let rest = hit & !(1 << nearest);
                let order = farthest_first(slabs.octant(), rest);
                let row = shuffle_numbers(bytemuck::cast_ref(&node.child), order);
                let row: [Child; WIDTH] = bytemuck::cast(row);
                child[top..top + WIDTH].copy_from_slice(&row);
                if !S::ANY {
                    shuffle(enters, order).store(&mut near[top..top + WIDTH]);
                }
                top += rest.count_ones() as usize;
                continue;
            }
        } else if search.test_block(next.index(), &blocks[next.index()]) {
            return Some(());
        }
        loop {
            if top == 0 {
                return Some(());
            }
            top -= 1;
            if S::ANY || near[top] <= search.t_far() {
                break;
            }
        }
        next = child[top];
    }
}

/// A search that decides each candidate at once.
struct DecidedSearch<'a, Q, const MOVED: bool> {
    ray: ConservativeRay<f32>,
    moved: &'a MovedRay,
    decision: Decision<'a, Q>,
    t_far: f32,
}

impl<Q: Query, const MOVED: bool> DecidedSearch<'_, Q, MOVED> {
    /// Computes the distance beyond which nothing counts, from the moved origin.
    #[inline(always)]
    fn update_bound(&mut self) {
        let Nearest { t, error, .. } = self.decision.nearest;
        let MovedRay { shift, slack, .. } = self.moved;
        self.t_far = if MOVED {
            rounded_out((t + error - shift + slack) as f32).1
        } else {
            self.decision.nearest.bounds().1
        };
    }
}

impl<Q: Query, const MOVED: bool> Search for DecidedSearch<'_, Q, MOVED> {
    const ANY: bool = Q::ANY;
    type Block = SphereBlock;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.t_far
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &SphereBlock) -> bool {
        let spheres = self.decision.spheres;
        let chord = chords(&self.ray, block, MOVED.then_some(self.moved.slack as f32));
        let enters = chord.near().to_array();
        for lane in set_bits(chord.may_hit(F32x8::splat(self.t_far)).bits()) {
            if enters[lane] > self.t_far {
                continue;
            }
            let row = index * LEAF + lane;
            let (ray, decision) = (&self.ray, &mut self.decision);
            let certain =
                |before: f32| certainly_hits(ray, spheres.center(row), spheres.radius(row), before);
            if !MOVED && Q::ANY && certain(decision.bounds().0) {
                decision.nearest.sphere = row as u32;
                return true;
            }
            let nearer =
                if MOVED { decision.test_sphere_from_afar(row) } else { decision.test_sphere(row) };
            if nearer {
                if Q::ANY {
                    return true;
                }
                self.update_bound();
            }
        }
        false
    }
}
