//! Who is right where the systems differ: arithmetic without rounding over the spheres in question.

use crate::rays::Rays;
use crate::scenes::Columns;
use glam::{DVec3, Vec3};
use serde::Serialize;
use spherule_core::NOTHING;
use spherule_core::internals::exact::{self, Distance};
use spherule_core::internals::ray::ExactRay;
use std::cmp::Ordering;

/// Rays about which the systems differ, and who was wrong.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Verdicts {
    /// Rays for which they said different things.
    pub differ: usize,
    /// Of these, Embree was wrong.
    pub embree_wrong: usize,
    /// Of these, Spherule was wrong.
    pub spherule_wrong: usize,
    /// Of these, both spheres are hit at the same distance.
    pub ties: usize,
}

/// Knows rays and spheres.
#[derive(Clone, Copy)]
pub struct Referee<'a> {
    pub rays: &'a Rays,
    pub spheres: &'a Columns,
}

impl Referee<'_> {
    /// Judges what two systems hit first.
    pub fn closest(&self, embree: &[u32], spherule: &[u32]) -> Verdicts {
        let mut verdicts = Verdicts::default();
        for (ray, (&embree, &spherule)) in embree.iter().zip(spherule).enumerate() {
            if embree == spherule {
                continue;
            }
            verdicts.differ += 1;
            match self.nearer(ray, embree, spherule) {
                Ordering::Less => verdicts.spherule_wrong += 1,
                Ordering::Greater => verdicts.embree_wrong += 1,
                Ordering::Equal => verdicts.ties += 1,
            }
        }
        verdicts
    }

    /// Judges whether anything is hit. Of a ray about which they differ, `named` tells spheres that
    /// it may hit: what the systems say that it hits first.
    pub fn any(
        &self,
        embree: &[bool],
        spherule: &[bool],
        named: impl Fn(usize) -> [u32; 2],
    ) -> Verdicts {
        let mut verdicts = Verdicts::default();
        for ray in (0..embree.len()).filter(|&ray| embree[ray] != spherule[ray]) {
            let hit = named(ray).iter().any(|&sphere| self.hits(ray, sphere));
            verdicts.differ += 1;
            verdicts.embree_wrong += usize::from(embree[ray] != hit);
            verdicts.spherule_wrong += usize::from(spherule[ray] != hit);
        }
        verdicts
    }

    /// Which of two different answers is hit first; one that is not hit comes after [`NOTHING`].
    fn nearer(&self, ray: usize, one: u32, other: u32) -> Ordering {
        let rank = |sphere: u32| match sphere {
            NOTHING => 1,
            _ if self.hits(ray, sphere) => 0,
            _ => 2,
        };
        match (rank(one), rank(other)) {
            (0, 0) => {
                let distance = |sphere| {
                    let (center, radius) = self.sphere(sphere);
                    Distance::Hit(center, radius)
                };
                exact::compare(&self.ray(ray), &distance(one), &distance(other))
            }
            (rank, other_rank) => rank.cmp(&other_rank),
        }
    }

    fn hits(&self, ray: usize, sphere: u32) -> bool {
        sphere != NOTHING && {
            let ((center, radius), exact_ray) = (self.sphere(sphere), self.ray(ray));
            let bound = Distance::Number(f64::from(self.rays.bound(ray)));
            let is_before =
                || exact::compare(&exact_ray, &Distance::Hit(center, radius), &bound).is_lt();
            exact::hit(&exact_ray, center, radius).is_some()
                && (self.rays.bounds().is_empty() || is_before())
        }
    }

    fn ray(&self, ray: usize) -> ExactRay {
        let (origin, direction) = self.rays.row(ray);
        ExactRay::new(origin, direction, false)
    }

    fn sphere(&self, sphere: u32) -> (DVec3, f64) {
        let [x, y, z, radius] = self.spheres.row(sphere as usize);
        (Vec3::new(x, y, z).as_dvec3(), f64::from(radius))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A near sphere, one behind it, one beside both, and the near one's mirror image.
    fn spheres() -> Columns {
        Columns {
            x: vec![3.0, 9.0, 3.0, 3.0],
            y: vec![0.5, 0.0, 5.0, -0.5],
            z: vec![0.0; 4],
            radius: vec![1.0; 4],
        }
    }

    #[test]
    fn the_one_that_is_wrong_is_named() {
        let (mut rays, spheres) = (Rays::default(), spheres());
        (0..6).for_each(|_| rays.push(Vec3::ZERO, Vec3::X));
        let referee = Referee { rays: &rays, spheres: &spheres };
        let embree = [0, 1, 0, 2, NOTHING, 0];
        let spherule = [0, 0, 1, NOTHING, 1, 3];
        let verdicts = referee.closest(&embree, &spherule);
        assert_eq!((verdicts.differ, verdicts.ties), (5, 1));
        assert_eq!((verdicts.embree_wrong, verdicts.spherule_wrong), (3, 1));
    }

    #[test]
    fn what_is_beyond_the_bound_is_not_hit() {
        let (mut rays, spheres) = (Rays::default(), spheres());
        // The nearest is hit a bit after 2.
        for bound in [f32::INFINITY, 2.0, 2.5] {
            rays.push_bounded(Vec3::ZERO, Vec3::X, bound);
        }
        let verdicts = Referee { rays: &rays, spheres: &spheres }.closest(&[0; 3], &[NOTHING; 3]);
        assert_eq!((verdicts.embree_wrong, verdicts.spherule_wrong), (1, 2));
    }

    #[test]
    fn occlusion_is_what_a_named_sphere_does() {
        let (mut rays, spheres) = (Rays::default(), spheres());
        (0..3).for_each(|_| rays.push(Vec3::ZERO, Vec3::X));
        let referee = Referee { rays: &rays, spheres: &spheres };
        let named = |ray: usize| [[0, NOTHING], [2, NOTHING], [NOTHING, 1]][ray];
        let verdicts = referee.any(&[false, true, true], &[true, false, true], named);
        assert_eq!((verdicts.differ, verdicts.embree_wrong, verdicts.spherule_wrong), (2, 2, 0));
    }
}
