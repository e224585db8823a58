//! Features of a pixel, in full precision: what layers show, and what the denoiser predicts radiance from.

use crate::ray::{GROUND, MISS};
use bytemuck::Zeroable;
use serde::{Deserialize, Serialize};

/// The id of a pixel whose center shows no surface.
pub const NOTHING: u32 = MISS;

/// The id of a pixel whose center shows the ground plane.
pub const GROUND_PLANE: u32 = GROUND;

/// Features of a pixel: of the first hits of its rays, for any material.
#[derive(Clone, Copy, Debug, PartialEq, Zeroable, Serialize, Deserialize)]
pub struct Features {
    /// Mean of [`World::albedo`](crate::World::albedo), linear RGB, 0..=1; rays that hit nothing count as black.
    pub albedo: [f32; 3],
    /// Mean of the unit normals on the visible side, in the scene's axes; rays that hit nothing count
    /// as 0, so that it is shorter at edges.
    pub normal: [f32; 3],
    /// Mean distance from the camera, in the scene's unit, of the rays that hit: from the eye in
    /// perspective, from the plane through the eye in parallel projection. Infinite if none hits.
    pub depth: f32,
    /// Fraction of the rays that hit a sphere or the ground, 0..=1.
    pub coverage: f32,
    /// Fraction of the rays that hit the ground, 0..=1, included in `coverage`.
    pub ground: f32,
    /// The sphere at the pixel's center, through the center of the lens: its index in the scene, from
    /// 0, or the number of spheres plus the index of a stick; or else [`NOTHING`] or [`GROUND_PLANE`].
    pub id: u32,
}

impl Features {
    /// Features of a pixel without hits, or of an unknown one.
    pub const NONE: Self = Self {
        albedo: [0.0; 3],
        normal: [0.0; 3],
        depth: f32::INFINITY,
        coverage: 0.0,
        ground: 0.0,
        id: NOTHING,
    };
}
