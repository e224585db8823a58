//! Sums of the layers' samples of a pixel.

use super::{Features, NOTHING};
use crate::integrator::workspace::Workspace;
use crate::ray::{GROUND, MISS};
use crate::world::World;
use glam::DVec3;

/// Sums of the layers' samples of a pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    albedo: DVec3,
    normal: DVec3,
    depth: f64,
    hits: f64,
    ground: f64,
    pub(super) id: u32,
}

impl Default for Sums {
    fn default() -> Self {
        let zero = DVec3::ZERO;
        Self { albedo: zero, normal: zero, depth: 0.0, hits: 0.0, ground: 0.0, id: NOTHING }
    }
}

impl Sums {
    /// Adds the hit of row `row`, if any.
    pub(super) fn add(&mut self, world: &World, work: &Workspace, row: usize) {
        let hit = work.hits.sphere[row];
        if hit == MISS {
            return;
        }
        let (ray, normal) = (work.rays.exact(row), work.surface.normal.row(row));
        let coverage = f64::from(work.coverage(row));
        self.albedo += coverage * world.albedo(hit).as_dvec3();
        self.normal += coverage * if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        let depth = world.camera.distance(ray.at(work.hits.t[row])) / world.transform.scale;
        self.depth += coverage * depth;
        self.hits += coverage;
        self.ground += if hit == GROUND { coverage } else { 0.0 };
    }

    /// Returns the means over `samples` samples.
    pub(super) fn mean(&self, samples: u32) -> Features {
        let weight = 1.0 / f64::from(samples.max(1));
        let depth = if self.hits > 0.0 { self.depth / self.hits } else { f64::INFINITY };
        Features {
            albedo: (self.albedo * weight).as_vec3().to_array(),
            normal: (self.normal * weight).as_vec3().to_array(),
            depth: depth as f32,
            coverage: (self.hits * weight) as f32,
            ground: (self.ground * weight) as f32,
            id: self.id,
        }
    }
}
