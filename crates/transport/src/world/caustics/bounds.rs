//! Bounds of the number of caustic samples in the cells of a grid.
//!
//! Most points expect few samples, so that most random numbers choose none: a bound tells this without
//! the estimates that a choice needs. It limits the number of samples, too, so that it need not be exact.

use super::CausticCasters;
use crate::bvh::Bounds;
use crate::elementary::cbrtf;
use crate::ray::MISS;
use crate::world::Ground;
use crate::world::lights::Receiver;
use glam::{DVec3, UVec3, Vec3};
use rayon::prelude::*;

/// Approximate number of cells.
const CELLS: f32 = 16384.0;

/// Cells beyond the spheres on each side, as a fraction of their extent.
const MARGIN: f32 = 0.25;

/// Ratio of the bound of a cell to the largest estimate at its corners: estimates between the corners are larger.
const SLACK: f64 = 1.25;

/// Most emitters for which there are bounds: each is estimated at each corner.
const MAX_EMITTERS: usize = 4;

/// Bounds for the normals +x, +y, +z, -x, -y and -z.
pub(super) type ByAxis = [f32; 6];

/// A grid of bounds; without cells, there is no bound anywhere.
#[derive(Clone, Debug, Default)]
pub(super) struct SampleBounds {
    low: Vec3,
    cells_per_length: f32,
    cells: UVec3,
    /// By cell, x first.
    bound: Vec<ByAxis>,
}

impl SampleBounds {
    /// Computes the bounds for those of all bodies' surfaces, and of the ground, that are around the specular spheres.
    pub(super) fn build(
        casters: &CausticCasters,
        bodies: Option<Bounds>,
        ground: Option<&Ground>,
    ) -> Self {
        let Some((low, high)) = bodies.and_then(|bodies| extent(casters, bodies, ground)) else {
            return Self::default();
        };
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
            largest_estimates(casters, low + place * length)
        };
        let estimates: Vec<ByAxis> = (0..count).into_par_iter().map(at_corner).collect();
        let bound = (0..cells.element_product()).map(|cell| {
            let cell = unflatten(cell, cells);
            let around = (0..8).map(|i| cell + UVec3::new(i & 1, i >> 1 & 1, i >> 2));
            let around = around.map(|corner| estimates[flatten(corner, corners)]);
            let largest = around.reduce(greater).unwrap_or_default();
            largest.map(|estimate| SLACK as f32 * estimate)
        });
        Self { low, cells_per_length, cells, bound: bound.collect() }
    }

    /// Returns the lower corner, the reciprocal of a cell's edge, the number of cells, and their bounds.
    pub(super) fn for_devices(&self) -> (Vec3, f32, UVec3, &[ByAxis]) {
        (self.low, self.cells_per_length, self.cells, &self.bound)
    }

    /// Returns the bound of the number of samples at a point with this unit normal; infinite where there is none.
    ///
    /// The light that falls on a surface is at most the sum of what falls on the sides of a box, each in proportion to the
    /// normal's component along it.
    #[inline(always)]
    pub(super) fn at(&self, point: Vec3, normal: Vec3) -> f64 {
        let place = (point - self.low) * self.cells_per_length;
        if place.cmpge(Vec3::ZERO).all() && place.cmplt(self.cells.as_vec3()).all() {
            let [x, y, z, minus_x, minus_y, minus_z] =
                self.bound[flatten(place.as_uvec3(), self.cells)];
            let along = Vec3::select(
                normal.cmpge(Vec3::ZERO),
                Vec3::new(x, y, z),
                Vec3::new(minus_x, minus_y, minus_z),
            );
            f64::from(along.dot(normal.abs()))
        } else {
            f64::INFINITY
        }
    }
}

/// Returns the corners of a box around the surfaces that are around the specular spheres.
fn extent(
    casters: &CausticCasters,
    bodies: Bounds,
    ground: Option<&Ground>,
) -> Option<(Vec3, Vec3)> {
    let corner =
        |sign: f64| move |caster: &super::Caster| (caster.center + sign * caster.radius).as_vec3();
    let low = casters.casters.iter().map(corner(-1.0)).reduce(Vec3::min)?;
    let high = casters.casters.iter().map(corner(1.0)).reduce(Vec3::max)?;
    let margin = (high - low).max_element() * MARGIN;
    let (low, high) = (low - margin, high + margin);
    let (mut least, mut most) = (bodies.low, bodies.high);
    if let Some(ground) = ground {
        for i in 0..8 {
            let far = |axis: usize| if i >> axis & 1 == 0 { low[axis] } else { high[axis] };
            let corner = DVec3::new(far(0).into(), far(1).into(), far(2).into());
            let above = ground.normal.dot(corner) - ground.height;
            let below = (corner - ground.normal * above).as_vec3();
            (least, most) = (least.min(below), most.max(below));
        }
    }
    // So that points on a plane side of the box are inside.
    let rounding = margin * 1e-3;
    Some((low.max(least - rounding), high.min(most + rounding)))
}

fn flatten(place: UVec3, size: UVec3) -> usize {
    (place.x + size.x * (place.y + size.y * place.z)) as usize
}

fn unflatten(index: u32, size: UVec3) -> UVec3 {
    UVec3::new(index % size.x, index / size.x % size.y, index / (size.x * size.y))
}

fn greater(a: ByAxis, b: ByAxis) -> ByAxis {
    std::array::from_fn(|axis| a[axis].max(b[axis]))
}

/// Returns the largest expected number of samples at a point, for normals along the axes.
fn largest_estimates(casters: &CausticCasters, point: Vec3) -> ByAxis {
    let normals = [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z];
    let emitters = 0..casters.emitters.len();
    normals.map(|normal| {
        let at = Receiver { point, normal, own: MISS };
        emitters.clone().map(|emitter| casters.samples(emitter, &at) as f32).fold(0.0, f32::max)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::generate::default_scene;
    use crate::world::World;

    #[test]
    fn bounds_of_cells_are_found_at_their_points() {
        let world = World::build(&default_scene(1)).unwrap();
        let bounds = SampleBounds::build(&world.caustic_casters, world.bvh.bounds(), None);
        let cells = bounds.cells.element_product();
        assert_eq!(cells as usize, bounds.bound.len());
        assert!((CELLS / 4.0..8.0 * CELLS).contains(&(cells as f32)), "{cells}");
        for cell in 0..cells {
            let middle = unflatten(cell, bounds.cells).as_vec3() + 0.5;
            let point = bounds.low + middle / bounds.cells_per_length;
            for axis in 0..6 {
                let normal = if axis < 3 { Vec3::AXES[axis] } else { -Vec3::AXES[axis - 3] };
                let bound = f64::from(bounds.bound[cell as usize][axis]);
                assert_eq!(bounds.at(point, normal), bound);
            }
        }
        assert_eq!(bounds.at(bounds.low - 0.1, Vec3::X), f64::INFINITY);
        assert_eq!(bounds.at(Vec3::splat(1e6), Vec3::X), f64::INFINITY);
        assert_eq!(SampleBounds::default().at(Vec3::ZERO, Vec3::X), f64::INFINITY);
    }
}
