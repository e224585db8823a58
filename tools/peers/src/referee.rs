//! Who is right where the systems differ: arithmetic without rounding over the spheres in question.

use crate::rays::Rays;
use crate::scenes::Columns;
use glam::{DVec3, Vec3};
use serde::Serialize;
use spherule::exact::{self, Distance};
use spherule::query::NOTHING;
use spherule::ray::ExactRay;
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
            let (center, radius) = self.sphere(sphere);
            exact::hit(&self.ray(ray), center, radius).is_some()
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
