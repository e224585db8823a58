//! Decides hits that another traversal has found, on another processor: it names the sphere that a ray hits first, or
//! does not know.
//!
//! Distances are computed here, as for hits of the traversals of this module, so they are the same. That a sphere which
//! was named is hit is tested as well, and what it is not certain of is traced as if nothing were known.

use super::Tree;
use super::nearest::NearestHit;
use super::query::Query;
use super::resolver::HitResolver;
use super::traversal::trace_unresolved;
use crate::conservative::{Chord, ConservativeRay};
use crate::lanes::bits;
use crate::ray::{CHUNK, Hits, MISS, Rays};
use crate::spheres::Spheres;

/// In place of a sphere's row, of a ray of which it is not known what it hits.
pub const UNKNOWN: u32 = u32::MAX - 2;

// No row of a sphere is so large.
const _: () = assert!(Spheres::MAX < UNKNOWN as usize);

/// Writes the hits of rays, of which `found` names the spheres: by row, the sphere that is hit first and before the
/// ray's bound, or one that is if any hit will do; [`MISS`] if none is; or [`UNKNOWN`]. Otherwise as
/// [`Tracer::closest`](super::Tracer::closest) and [`Tracer::occluded`](super::Tracer::occluded).
///
/// Returns how many decisions were made on integers.
pub fn decide_found<Q: Query>(
    tree: Tree,
    rays: &Rays,
    hits: &mut Hits,
    found: impl Fn(usize) -> u32,
) -> u64 {
    let mut resolver = HitResolver::<Q>::new(tree.spheres, rays, hits);
    for first in (0..rays.len()).step_by(CHUNK) {
        let rows = first..rays.len().min(first + CHUNK);
        resolver.hits.error[..rows.len()].fill(0.0);
        for row in rows {
            match found(row) {
                MISS => {}
                sphere if sphere as usize >= tree.spheres.len() => {
                    resolver.unresolved.push(row as u32);
                }
                sphere if Q::ANY => resolver.hits.sphere[row] = sphere,
                sphere => resolver.push_found(row, sphere as usize),
            }
        }
        resolver.flush_pending();
        trace_unresolved(tree.bvh, &mut resolver, false);
        resolver.round_distances();
    }
    resolver.exact
}

impl<Q: Query> HitResolver<'_, Q> {
    /// Adds a ray and the sphere that it hits first.
    fn push_found(&mut self, row: usize, sphere: usize) {
        let own = self.rays.own[row] as usize == sphere;
        if own || !self.is_single_precision() {
            self.unresolved.push(row as u32);
            return;
        }
        let ray = ConservativeRay::new(self.rays.origin.load(row), self.rays.direction.load(row));
        let center = self.spheres.center(sphere).into();
        let near = Chord::<f32>::new(&ray, center, self.spheres.radius(sphere)).near();
        if near >= 0.0 {
            let t_max = self.bounds(row).0;
            let nearest = NearestHit { sphere: bits(sphere as u32), near, t_max };
            self.push_pending(row as u32, &nearest, f32::INFINITY);
        } else if !self.test_sphere(row, sphere) {
            self.unresolved.push(row as u32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::builders::{Builder, build};
    use crate::bvh::{Any, Closest, ClosestRounded, Tracer};
    use crate::random::Random;

    /// Spheres, some of which contain others, and rays from anywhere.
    fn scene(count: usize) -> (Spheres, crate::bvh::Bvh, Rays) {
        let mut random = Random::new(3);
        let mut spheres = Spheres::with_capacity(2000);
        for id in 0..2000 {
            let radius = if id % 100 == 0 { 0.3 } else { 0.03 };
            spheres.push(random.in_cube().as_vec3() * 0.6, radius, id);
        }
        let bvh = build(&mut spheres, Builder::default());
        let mut rays = Rays::with_capacity(count);
        for _ in 0..count {
            let direction = random.direction();
            let longest = direction.abs().max_element();
            rays.push(random.in_cube().as_vec3(), (direction * (1.5 / longest)).as_vec3(), MISS);
        }
        (spheres, bvh, rays)
    }

    #[test]
    fn what_is_named_is_decided_as_if_it_was_traced() {
        let (spheres, bvh, rays) = scene(3 * CHUNK / 2);
        let tree = Tree { bvh: &bvh, spheres: &spheres };
        let mut expected = Hits::with_capacity(rays.len());
        Tracer::default().closest(tree, &rays, &mut expected);
        let mut rounded = Hits::with_capacity(rays.len());
        decide_found::<ClosestRounded>(tree, &rays, &mut rounded, |_| UNKNOWN);
        let hit = (0..rays.len()).filter(|&row| expected.sphere[row] != MISS).count();
        assert!(hit > rays.len() / 3 && hit < rays.len(), "{hit}");
        // Some are named, and some wrongly.
        for wrong in [false, true] {
            let named = |row: usize| match row % 5 {
                0 => UNKNOWN,
                1 if wrong && expected.sphere[row] != MISS => 7,
                _ => expected.sphere[row],
            };
            let mut hits = Hits::with_capacity(rays.len());
            decide_found::<Closest>(tree, &rays, &mut hits, named);
            let mut hits_rounded = Hits::with_capacity(rays.len());
            decide_found::<ClosestRounded>(tree, &rays, &mut hits_rounded, named);
            let mut hidden = Hits::with_capacity(rays.len());
            decide_found::<Any>(
                tree,
                &rays,
                &mut hidden,
                |row| if wrong { UNKNOWN } else { named(row) },
            );
            let mut differ = 0;
            for row in 0..rays.len() {
                differ += u32::from(hits.sphere[row] != expected.sphere[row]);
                if hits.sphere[row] == expected.sphere[row] {
                    assert_eq!(hits.t[row], expected.t[row], "row {row}");
                    assert_eq!(hits_rounded.t[row], rounded.t[row], "row {row}");
                }
                assert_eq!(hidden.sphere[row] == MISS, expected.sphere[row] == MISS);
            }
            // A sphere that is hit, but not first, cannot be told from the right one.
            assert!(differ < if wrong { 100 } else { 1 }, "{differ}");
        }
    }

    #[test]
    fn bounds_and_own_spheres_hold_for_what_is_named() {
        let (spheres, bvh, mut rays) = scene(500);
        let tree = Tree { bvh: &bvh, spheres: &spheres };
        let mut first = Hits::with_capacity(rays.len());
        Tracer::default().closest(tree, &rays, &mut first);
        let mut bounded = Hits::with_capacity(rays.len());
        for row in 0..rays.len() {
            match row % 3 {
                0 => bounded.t[row] = first.t[row] * 0.5,
                1 => rays.own[row] = first.sphere[row],
                _ => {}
            }
        }
        let mut expected = bounded.clone();
        Tracer::default().closest(tree, &rays, &mut expected);
        decide_found::<Closest>(tree, &rays, &mut bounded, |row| first.sphere[row]);
        let rows = 0..rays.len();
        let found = rows.clone().filter(|&row| expected.sphere[row] != MISS).count();
        assert!(found > 100, "{found}");
        for row in rows.filter(|&row| first.sphere[row] != MISS) {
            assert_eq!(bounded.sphere[row], expected.sphere[row], "row {row}");
            assert_eq!(bounded.t[row], expected.t[row], "row {row}");
        }
    }
}
