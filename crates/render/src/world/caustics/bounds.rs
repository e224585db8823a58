//! Bounds of the number of caustic samples in the cells of a grid.
//!
//! Most points expect few samples, so that most random numbers choose none: a bound tells this without
//! the estimates that a choice needs. It limits the number of samples, too, so that it need not be exact.

use super::CausticCasters;
use crate::elementary::cbrtf;
use crate::ray::MISS;
use crate::world::lights::Receiver;
use glam::{UVec3, Vec3};
use rayon::prelude::*;

/// Approximate number of cells.
const CELLS: f32 = 16384.0;

/// Cells beyond the spheres on each side, as a fraction of their extent.
const MARGIN: f32 = 0.25;

/// Ratio of the bound of a cell to the largest estimate at its corners, along the axes: estimates are
/// larger by up to the square root of 3 in other directions, and between the corners.
const SLACK: f64 = 1.5;

/// Most emitters for which there are bounds: each is estimated at each corner.
const MAX_EMITTERS: usize = 4;

/// A grid of bounds; without cells, there is no bound anywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct SampleBounds {
    low: Vec3,
    cells_per_length: f32,
    cells: UVec3,
    /// By cell, x first.
    bound: Vec<f32>,
}

impl SampleBounds {
    /// Computes the bounds around the spheres.
    pub(super) fn build(casters: &CausticCasters) -> Self {
        let corner = |sign: f64| {
            move |caster: &super::Caster| (caster.center + sign * caster.radius).as_vec3()
        };
        let low = casters.casters.iter().map(corner(-1.0)).reduce(Vec3::min);
        let high = casters.casters.iter().map(corner(1.0)).reduce(Vec3::max);
        let (Some(low), Some(high)) = (low, high) else { return Self::default() };
        let margin = (high - low).max_element() * MARGIN;
        let (low, high) = (low - margin, high + margin);
        let size = high - low;
        let length = cbrtf(size.x * size.y * size.z / CELLS);
        let cells_per_length = 1.0 / length;
        let cells = (size * cells_per_length).ceil().as_uvec3().max(UVec3::ONE);
        let numbers_fit = cells.as_vec3().element_product() < 8.0 * CELLS;
        if casters.emitters.len() > MAX_EMITTERS || !cells_per_length.is_normal() || !numbers_fit {
            return Self::default();
        }
        let corners = cells + UVec3::ONE;
        let count = corners.element_product() as usize;
        let at_corner = |index: usize| {
            let place = unflatten(index as u32, corners).as_vec3();
            largest_estimate(casters, low + place * length)
        };
        let estimates: Vec<f64> = (0..count).into_par_iter().map(at_corner).collect();
        let bound = (0..cells.element_product()).map(|cell| {
            let cell = unflatten(cell, cells);
            let around = (0..8).map(|i| cell + UVec3::new(i & 1, i >> 1 & 1, i >> 2));
            let around = around.map(|corner| estimates[flatten(corner, corners)]);
            (SLACK * around.fold(0.0, f64::max)) as f32
        });
        Self { low, cells_per_length, cells, bound: bound.collect() }
    }

    /// Returns the bound of the number of samples at a point; infinite where there is none.
    #[inline(always)]
    pub(super) fn at(&self, point: Vec3) -> f64 {
        let place = (point - self.low) * self.cells_per_length;
        if place.cmpge(Vec3::ZERO).all() && place.cmplt(self.cells.as_vec3()).all() {
            f64::from(self.bound[flatten(place.as_uvec3(), self.cells)])
        } else {
            f64::INFINITY
        }
    }
}

fn flatten(place: UVec3, size: UVec3) -> usize {
    (place.x + size.x * (place.y + size.y * place.z)) as usize
}

fn unflatten(index: u32, size: UVec3) -> UVec3 {
    UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y))
}

/// Returns the largest expected number of samples at a point, for normals along the axes.
fn largest_estimate(casters: &CausticCasters, point: Vec3) -> f64 {
    let normals = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let at = |normal| Receiver { point, normal, own: MISS };
    let emitters = 0..casters.emitters.len();
    let each = emitters.flat_map(|emitter| normals.map(|normal| (emitter, normal)));
    each.map(|(emitter, normal)| casters.samples(emitter, &at(normal))).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::default_scene;
    use crate::world::World;

    #[test]
    fn bounds_of_cells_are_found_at_their_points() {
        let world = World::build(&default_scene(1)).unwrap();
        let bounds = SampleBounds::build(&world.caustic_casters);
        let cells = bounds.cells.element_product();
        assert_eq!(cells as usize, bounds.bound.len());
        assert!((CELLS / 4.0..8.0 * CELLS).contains(&(cells as f32)), "{cells}");
        for cell in 0..cells {
            let middle = unflatten(cell, bounds.cells).as_vec3() + 0.5;
            let point = bounds.low + middle / bounds.cells_per_length;
            assert_eq!(bounds.at(point), f64::from(bounds.bound[cell as usize]));
        }
        assert_eq!(bounds.at(bounds.low - 0.1), f64::INFINITY);
        assert_eq!(bounds.at(Vec3::splat(1e6)), f64::INFINITY);
        assert_eq!(SampleBounds::default().at(Vec3::ZERO), f64::INFINITY);
    }
}
