//! One plain ray: single precision holds the ray and all spheres, as it does for almost all rays.
//!
//! The first hit is decided at the end of the traversal, as it is for rays of a batch ([`DeferredHit`]); any hit at the first
//! sphere that single precision is certain of.

use super::Tree;
use super::decision::Decision;
use super::one_ray::{SMALL_STACK, Search, walk};
use super::query::{Any, ClosestRounded};
use super::resolver::rounded_out;
use super::single::{DeferredHit, chords};
use crate::conservative::ConservativeRay;
use crate::intersect::{self, CLEAR, Pairs};
use crate::lanes::{F32x4, F32x8, Lanes, Mask, set_bits};
use crate::ray::{ExactRay, MISS};
use crate::slabs::RaySlabs;
use crate::spheres::{LEAF, SphereBlock, Spheres};
use crate::vec3::Vec3;

/// A ray that single precision holds, in a tree's units. Its origin is exact, and the largest coordinate of its
/// direction is in `1..2`.
#[derive(Clone, Copy, Debug)]
pub struct PlainRay {
    /// The origin, in the first three lanes.
    pub origin: F32x4,
    /// The direction, in the first three lanes.
    pub direction: F32x4,
}

/// The first hit of a plain ray.
#[derive(Clone, Copy, Debug)]
pub struct PlainHit {
    /// The sphere's row.
    pub sphere: usize,
    /// The double that is nearest to the distance.
    pub t: f64,
    /// Ray and sphere.
    pub pair: Pairs<f64>,
}

/// The first hit of a plain ray among spheres that single precision holds.
#[derive(Clone, Copy, Debug)]
pub enum PlainAnswer {
    /// Nothing is hit.
    Miss,
    /// A sphere is hit.
    Hit(PlainHit),
    /// The traversal did not tell: candidates must be decided one by one.
    Undecided,
}

impl PlainRay {
    /// The ray in double precision.
    #[inline(always)]
    pub fn exact(&self) -> ExactRay {
        ExactRay::new(vector(self.origin).into(), vector(self.direction).into(), false)
    }

    #[inline(always)]
    fn conservative(&self) -> ConservativeRay<f32> {
        ConservativeRay::new(vector(self.origin), vector(self.direction))
    }

    #[inline(always)]
    fn slabs(&self) -> RaySlabs {
        RaySlabs::of_row(self.origin, self.direction)
    }

    /// Finds the first hit at a distance less than `bound`.
    #[inline(always)]
    pub fn intersect(&self, tree: Tree, bound: f64) -> PlainAnswer {
        let mut search = DeferredSearch {
            spheres: tree.spheres,
            ray: self.conservative(),
            hit: DeferredHit::new::<ClosestRounded>(rounded_out(bound as f32)),
        };
        match walk::<_, SMALL_STACK>(tree.bvh, tree.spheres.blocks(), &self.slabs(), &mut search) {
            Some(()) => search.decide(self),
            None => PlainAnswer::Undecided,
        }
    }

    /// Returns whether anything is hit at a distance less than `bound`; `None` if the traversal did not tell.
    #[inline(always)]
    pub fn occluded(&self, tree: Tree, bound: f64) -> Option<bool> {
        let mut search = AnySearch {
            spheres: tree.spheres,
            plain: self,
            ray: self.conservative(),
            bound,
            bounds: rounded_out(bound as f32),
            found: false,
        };
        walk::<_, SMALL_STACK>(tree.bvh, tree.spheres.blocks(), &self.slabs(), &mut search)?;
        Some(search.found)
    }
}

/// The coordinates of a row.
#[inline(always)]
fn vector(row: F32x4) -> Vec3<f32> {
    let [x, y, z, _] = row.to_array();
    Vec3::new(x, y, z)
}

/// A search for the first hit.
struct DeferredSearch<'a> {
    spheres: &'a Spheres,
    ray: ConservativeRay<f32>,
    hit: DeferredHit,
}

impl Search for DeferredSearch<'_> {
    const ANY: bool = false;
    type Block = SphereBlock;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.hit.nearest.t_max
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &SphereBlock) -> bool {
        let chord = chords(&self.ray, block, None);
        let lanes = chord.may_hit(F32x8::splat(self.hit.nearest.t_max)).bits();
        if lanes != 0 {
            let (first, near) = (index * LEAF, chord.near().to_array());
            let Self { spheres, ray, hit } = self;
            hit.test_spheres::<ClosestRounded>(ray, MISS, spheres, first, lanes, &near);
        }
        false
    }
}

impl DeferredSearch<'_> {
    /// Decides whether the candidate is hit, and before all other spheres.
    #[inline(always)]
    fn decide(&self, ray: &PlainRay) -> PlainAnswer {
        let DeferredHit { nearest, runner_up } = self.hit;
        let sphere = nearest.sphere.to_bits();
        if sphere == MISS {
            return PlainAnswer::Miss;
        }
        let sphere = sphere as usize;
        let (center, radius) = (self.spheres.center(sphere), self.spheres.radius(sphere));
        let exact = ray.exact();
        let pair = Pairs::one(&exact, center.as_dvec3(), f64::from(radius));
        // Nothing beyond `t_max` was tested; until there is a runner-up, its distance is no more than the bound.
        let other = f64::from(runner_up.min(nearest.t_max));
        let is_first = |t: f64| t * (1.0 + CLEAR) < other;
        let coarse = vector(ray.origin).is_coarse() && Vec3::from(center).is_coarse();
        if coarse {
            let (certain, t) = intersect::nearest_quickly(&pair, f64::from(nearest.near));
            if certain && is_first(t) {
                return PlainAnswer::Hit(PlainHit { sphere, t, pair });
            }
        }
        let (plain, t) = intersect::confirm_either(&pair);
        if !(plain && is_first(t)) {
            return PlainAnswer::Undecided;
        }
        let t = intersect::nearest_or_exact(&pair, &exact, t);
        PlainAnswer::Hit(PlainHit { sphere, t, pair })
    }
}

/// A search for any hit.
struct AnySearch<'a> {
    spheres: &'a Spheres,
    plain: &'a PlainRay,
    ray: ConservativeRay<f32>,
    /// The distance at which the search ends, and its bounds.
    bound: f64,
    bounds: (f32, f32),
    found: bool,
}

impl Search for AnySearch<'_> {
    const ANY: bool = true;
    type Block = SphereBlock;

    #[inline(always)]
    fn t_far(&self) -> f32 {
        self.bounds.1
    }

    #[inline(always)]
    fn test_block(&mut self, index: usize, block: &SphereBlock) -> bool {
        let chord = chords(&self.ray, block, None);
        let may_hit = chord.may_hit(F32x8::splat(self.bounds.1));
        if may_hit.bits() == 0 {
            return false;
        }
        let (ray, margin) = (self.ray.splat(), self.ray.margin().splat());
        let radius = F32x8::load(&block.radius);
        let before = chord.near_at_most(radius, &margin).lt(F32x8::splat(self.bounds.0));
        let certain = may_hit & before & chord.enters(&ray, radius, &margin);
        self.found = certain.bits() != 0 || self.decide(index * LEAF, may_hit.bits());
        self.found
    }
}

impl AnySearch<'_> {
    /// Decides whether one of some spheres, from `first` on, is hit.
    #[inline(never)]
    fn decide(&self, first: usize, lanes: u32) -> bool {
        let ray = self.plain.exact();
        let mut decision = Decision::<Any>::of_ray(self.spheres, &ray, self.bound);
        set_bits(lanes).any(|lane| decision.test_sphere(first + lane))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::builders::{Builder, build};
    use crate::bvh::trace_one;
    use crate::random::Random;

    /// A ray of the tree's units.
    fn ray(origin: glam::DVec3, direction: glam::DVec3) -> PlainRay {
        let [x, y, z] = origin.as_vec3().to_array();
        let longest = direction.abs().max_element();
        let [dx, dy, dz] = (direction * (1.5 / longest)).as_vec3().to_array();
        PlainRay { origin: F32x4::new([x, y, z, 0.0]), direction: F32x4::new([dx, dy, dz, 1.0]) }
    }

    #[test]
    fn answers_are_those_of_decisions_one_by_one() {
        let mut random = Random::new(7);
        let mut spheres = Spheres::with_capacity(3000);
        for id in 0..3000 {
            // Some contain others.
            let radius = if id % 100 == 0 { 0.3 } else { 0.03 };
            spheres.push(random.in_cube().as_vec3() * 0.6, radius, id);
        }
        let bvh = build(&mut spheres, Builder::default());
        let tree = Tree { bvh: &bvh, spheres: &spheres };
        let (mut hits, mut undecided) = (0, 0);
        for i in 0..4000 {
            let far = if i % 2 == 0 { 1.0 } else { 4.0 };
            let plain = ray(random.in_cube() * far, random.in_cube());
            let exact = plain.exact();
            let expected = trace_one::<ClosestRounded>(tree, &exact, f64::INFINITY);
            match plain.intersect(tree, f64::INFINITY) {
                PlainAnswer::Miss => assert_eq!(expected.sphere, MISS),
                PlainAnswer::Undecided => undecided += 1,
                PlainAnswer::Hit(PlainHit { sphere, t, .. }) => {
                    let (center, radius) = spheres.exact(sphere);
                    let rounded = intersect::nearest(&exact, center, radius, expected.t, false);
                    assert_eq!((sphere as u32, t), (expected.sphere, rounded));
                    hits += 1;
                    for (bound, occluded) in [(t * 0.5, false), (t * 1.001, true)] {
                        assert_eq!(plain.occluded(tree, bound), Some(occluded));
                        match plain.intersect(tree, bound) {
                            PlainAnswer::Hit(hit) => assert!(occluded && hit.t == t),
                            PlainAnswer::Miss => assert!(!occluded),
                            PlainAnswer::Undecided => undecided += 1,
                        }
                    }
                }
            }
            let any = expected.sphere != MISS;
            assert_eq!(plain.occluded(tree, f64::INFINITY), Some(any));
        }
        assert!(hits > 1000, "{hits}");
        assert!(undecided < 20, "{undecided}");
    }

    #[test]
    fn nothing_is_hit_where_there_is_nothing() {
        let (spheres, bvh) = (Spheres::default(), crate::bvh::Bvh::default());
        let (tree, plain) =
            (Tree { bvh: &bvh, spheres: &spheres }, ray(glam::DVec3::ZERO, glam::DVec3::X));
        assert!(matches!(plain.intersect(tree, 1.0), PlainAnswer::Miss));
        assert_eq!(plain.occluded(tree, 1.0), Some(false));
    }
}
