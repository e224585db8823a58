//! Depth range of the bodies of a scene.

use crate::body_tree::Sphere;
use crate::world::World;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Number of bodies in a run: neighbors in the tree's order, and so in space.
const RUN: usize = 512;

/// Relative tolerance of distances to bounding spheres, far above their rounding error.
const SLACK: f64 = 1e-9;

/// Bounding spheres of runs of a world's bodies, for computing [`RunBounds::depths`] of many cameras
/// from a small part of the bodies.
///
/// They are invalid for a world that was built anew, but stay valid if the world's camera changes.
#[derive(Clone, Debug)]
pub struct RunBounds {
    /// Center and radius, in the world's unit; each contains all spheres of its run, and those in place of other bodies.
    bounding_spheres: Vec<(DVec3, f64)>,
}

impl RunBounds {
    /// Computes the bounding spheres of a world.
    pub fn of(world: &World) -> Self {
        let bounding_sphere = |run: usize| {
            let spheres = || rows(world, run).map(|row| sphere_of(world, row));
            let low = spheres().fold(DVec3::INFINITY, |low, sphere| low.min(sphere.0));
            let high = spheres().fold(DVec3::NEG_INFINITY, |high, sphere| high.max(sphere.0));
            let center = low.midpoint(high);
            let reach = |(at, radius): (DVec3, f64)| at.distance(center) + radius;
            (center, spheres().map(reach).fold(0.0, f64::max))
        };
        Self { bounding_spheres: (0..count(world)).into_par_iter().map(bounding_sphere).collect() }
    }

    /// Returns the range of distances of all bodies from the camera, in the scene's unit: equal to
    /// [`depths`] to the last bit.
    pub fn depths(&self, world: &World) -> [f64; 2] {
        let bounds: Vec<[f64; 2]> = self
            .bounding_spheres
            .iter()
            .map(|bounding_sphere| bounds(world, *bounding_sphere))
            .collect();
        let first = (0..bounds.len()).min_by(|&a, &b| bounds[a][0].total_cmp(&bounds[b][0]));
        let last = (0..bounds.len()).max_by(|&a, &b| bounds[a][1].total_cmp(&bounds[b][1]));
        let ends = first.into_iter().chain(last).map(|run| of_rows(world, rows(world, run)));
        let known = ends.fold(NONE, union);
        let open = |run: &usize| bounds[*run][0] < known[0] || bounds[*run][1] > known[1];
        let rest = (0..bounds.len()).into_par_iter().filter(open);
        let depths = rest.map(|run| of_rows(world, rows(world, run))).reduce(|| known, union);
        clamp_near(depths)
    }
}

/// Returns the range of distances of all bodies from the camera, in the scene's unit; distances behind
/// a camera of parallel projection count as 0. Ellipsoids and cones count as spheres that are as wide as the box around them.
pub fn depths(world: &World) -> [f64; 2] {
    let runs = (0..count(world)).into_par_iter();
    clamp_near(runs.map(|run| of_rows(world, rows(world, run))).reduce(|| NONE, union))
}

/// The depth range of no bodies.
const NONE: [f64; 2] = [f64::INFINITY, 0.0];

fn count(world: &World) -> usize {
    body_count(world).div_ceil(RUN)
}

/// Returns the number of bodies, of which each half of a stick is one.
fn body_count(world: &World) -> usize {
    world.body_count()
}

/// Returns a sphere in place of a body, by the number of its hits.
fn sphere_of(world: &World, hit: usize) -> (DVec3, f64) {
    let body = world.body(hit as u32).expect("a hit on a body");
    let Sphere { center, radius } = world.trees().like_sphere(body);
    (center, radius)
}

fn rows(world: &World, run: usize) -> Range<usize> {
    run * RUN..body_count(world).min((run + 1) * RUN)
}

fn of_rows(world: &World, rows: Range<usize>) -> [f64; 2] {
    let ends = |row: usize| {
        let (center, radius) = sphere_of(world, row);
        let distance = world.camera.distance(center) / world.transform.scale;
        let radius = radius / world.transform.scale;
        [distance - radius, distance + radius]
    };
    rows.map(ends).fold(NONE, union)
}

/// Returns bounds of the distances of all bodies in a bounding sphere: by the triangle inequality, a
/// distance changes by at most the distance between two points.
fn bounds(world: &World, (center, radius): (DVec3, f64)) -> [f64; 2] {
    let distance = world.camera.distance(center);
    let slack = SLACK * (distance.abs() + radius);
    [distance - radius - slack, distance + radius + slack].map(|end| end / world.transform.scale)
}

fn union(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn clamp_near([near, far]: [f64; 2]) -> [f64; 2] {
    [near.max(0.0), far]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Pose, Projection, Rgb, Scene};
    use glam::DQuat;
    use std::path::Path;

    #[test]
    fn runs_give_the_range_of_all_bodies() {
        let text = "[[generate]]\nkind = \"volume\"\ncount = 20000";
        let mut scene = Scene::parse(text, "test", Path::new("")).unwrap();
        let semi_axes = DVec3::new(3.0, 1.0, 1.0);
        scene.ellipsoids.push(DVec3::X * -20.0, semi_axes, DQuat::IDENTITY, 0, Rgb::ONE);
        scene.sticks.push([DVec3::ZERO, DVec3::Y * 30.0], 0.5, 0, [Rgb::ONE; 2]);
        scene.cones.push(DVec3::Z * -25.0, DVec3::Z * -20.0, 2.0, 0, Rgb::ONE);
        let mut world = World::build(&scene).unwrap();
        let runs = RunBounds::of(&world);
        for eye in [DVec3::new(30.0, 9.0, 4.0), DVec3::new(1.0, -2.0, 0.5), DVec3::Z * 1e3] {
            for projection in [
                Projection::Perspective { fov: 40.0 },
                Projection::Orthographic { height: Some(3.0) },
            ] {
                scene.camera.pose = Pose::LookAt { eye, target: DVec3::ONE };
                scene.camera.projection = projection;
                assert!(world.set_camera(&scene).unwrap());
                assert_eq!(runs.depths(&world), depths(&world), "{eye} {projection:?}");
            }
        }
    }

    /// A sphere whose center is far away may be the nearest.
    #[test]
    fn large_spheres_reach_beyond_the_centers_of_their_run() {
        let mut scene = crate::scene::generate::default_scene(1);
        scene.camera.pose = Pose::LookAt { eye: DVec3::ZERO, target: DVec3::X };
        for index in 0..3 {
            scene.spheres = crate::scene::Spheres::default();
            for (middle, count) in
                [(DVec3::NEG_X * 100.0, 512), (DVec3::X * 130.0, 2048), (DVec3::Y * 200.0, 512)]
            {
                for i in 0..count {
                    let t = f64::from(i);
                    let spread = DVec3::new((t * 12.9).sin(), (t * 78.2).sin(), (t * 37.7).cos());
                    let is_large = count == 2048 && i == 300 + 600 * index;
                    let radius = if is_large { 40.0 } else { 0.01 };
                    scene.spheres.push(middle + spread, radius, 0, Rgb::ONE);
                }
            }
            let world = World::build(&scene).unwrap();
            let [near, far] = depths(&world);
            assert!((88.0..92.0).contains(&near) && (199.0..202.0).contains(&far), "{near} {far}");
            assert_eq!(RunBounds::of(&world).depths(&world), [near, far], "{index}");
        }
    }

    #[test]
    fn worlds_without_spheres_have_no_depth() {
        let scene = crate::scene::generate::default_scene(1);
        let world = World::build(&scene).unwrap().without_spheres();
        assert_eq!(depths(&world), NONE);
        assert_eq!(RunBounds::of(&world).depths(&world), NONE);
    }

    #[test]
    fn distances_behind_a_parallel_camera_count_as_0() {
        let mut scene = crate::scene::generate::default_scene(1);
        scene.spheres = crate::scene::Spheres::default();
        for z in [0.0, 10.0] {
            scene.spheres.push(DVec3::Z * z, 1.0, 0, Rgb::ONE);
        }
        scene.camera.projection = Projection::Orthographic { height: Some(3.0) };
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 5.0, target: DVec3::ZERO };
        let world = World::build(&scene).unwrap();
        assert_eq!(depths(&world), [0.0, 6.0]);
        assert_eq!(RunBounds::of(&world).depths(&world), [0.0, 6.0]);
    }
}
