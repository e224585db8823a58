//! Depth range of the spheres of a scene.

use crate::world::World;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Spheres of a run: neighbors in the tree's order, and so in space.
const RUN: usize = 512;

/// What distances to balls may be rounded by, as a share: far more than they are.
const SLACK: f64 = 1e-9;

/// Balls about runs of a world's spheres: with them, [`Runs::depths`] of one camera after the other
/// are found by looking at a small part of the spheres.
///
/// They are of no use for a world that was built anew, but stay those of a world that another camera
/// looks at.
#[derive(Clone, Debug)]
pub struct Runs {
    /// Center and radius, in the world's unit; each ball holds all spheres of its run.
    balls: Vec<(DVec3, f64)>,
}

impl Runs {
    /// Those of a world.
    pub fn of(world: &World) -> Self {
        let ball = |run: usize| {
            let spheres = || rows(world, run).map(|row| world.spheres.exact(row));
            let low = spheres().fold(DVec3::INFINITY, |low, sphere| low.min(sphere.0));
            let high = spheres().fold(DVec3::NEG_INFINITY, |high, sphere| high.max(sphere.0));
            let center = low.midpoint(high);
            let reach = |(at, radius): (DVec3, f64)| at.distance(center) + radius;
            (center, spheres().map(reach).fold(0.0, f64::max))
        };
        Self { balls: (0..count(world)).into_par_iter().map(ball).collect() }
    }

    /// Between which distances from the camera all spheres are, in the scene's unit: what
    /// [`depths`] says, to the last bit.
    pub fn depths(&self, world: &World) -> [f64; 2] {
        let bounds: Vec<[f64; 2]> = self.balls.iter().map(|ball| bounds(world, *ball)).collect();
        let first = (0..bounds.len()).min_by(|&a, &b| bounds[a][0].total_cmp(&bounds[b][0]));
        let last = (0..bounds.len()).max_by(|&a, &b| bounds[a][1].total_cmp(&bounds[b][1]));
        let ends = first.into_iter().chain(last).map(|run| of_rows(world, rows(world, run)));
        let known = ends.fold(NONE, wider);
        let open = |run: &usize| bounds[*run][0] < known[0] || bounds[*run][1] > known[1];
        let rest = (0..bounds.len()).into_par_iter().filter(open);
        let depths = rest.map(|run| of_rows(world, rows(world, run))).reduce(|| known, wider);
        ahead(depths)
    }
}

/// Between which distances from the camera all spheres are, in the scene's unit; what is behind a
/// camera of parallel projection counts as 0.
pub fn depths(world: &World) -> [f64; 2] {
    let runs = (0..count(world)).into_par_iter();
    ahead(runs.map(|run| of_rows(world, rows(world, run))).reduce(|| NONE, wider))
}

/// Of no spheres.
const NONE: [f64; 2] = [f64::INFINITY, 0.0];

fn count(world: &World) -> usize {
    world.spheres.len().div_ceil(RUN)
}

fn rows(world: &World, run: usize) -> Range<usize> {
    run * RUN..world.spheres.len().min((run + 1) * RUN)
}

fn of_rows(world: &World, rows: Range<usize>) -> [f64; 2] {
    let ends = |row: usize| {
        let (center, radius) = world.spheres.exact(row);
        let distance = world.camera.distance(center) / world.frame.scale;
        let radius = radius / world.frame.scale;
        [distance - radius, distance + radius]
    };
    rows.map(ends).fold(NONE, wider)
}

/// What the distances of all spheres in a ball lie between: a distance changes by no more than the
/// way from one point to another.
fn bounds(world: &World, (center, radius): (DVec3, f64)) -> [f64; 2] {
    let distance = world.camera.distance(center);
    let slack = SLACK * (distance.abs() + radius);
    [distance - radius - slack, distance + radius + slack].map(|end| end / world.frame.scale)
}

fn wider(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

fn ahead([near, far]: [f64; 2]) -> [f64; 2] {
    [near.max(0.0), far]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Pose, Projection, Scene};
    use std::path::Path;

    #[test]
    fn runs_find_what_a_look_at_every_sphere_finds() {
        let text = "[[generate]]\nkind = \"volume\"\ncount = 20000";
        let mut scene = Scene::parse(text, "test", Path::new("")).unwrap();
        let mut world = World::build(&scene).unwrap();
        let runs = Runs::of(&world);
        for eye in [DVec3::new(30.0, 9.0, 4.0), DVec3::new(1.0, -2.0, 0.5), DVec3::Z * 1e3] {
            for projection in [
                Projection::Perspective { fov: 40.0 },
                Projection::Orthographic { height: Some(3.0) },
            ] {
                scene.camera.pose = Pose::LookAt { eye, target: DVec3::ONE };
                scene.camera.projection = projection;
                assert!(world.look(&scene).unwrap());
                assert_eq!(runs.depths(&world), depths(&world), "{eye} {projection:?}");
            }
        }
    }

    /// A sphere whose center is far away may begin nearest of all.
    #[test]
    fn large_spheres_reach_beyond_the_centers_of_their_run() {
        let mut scene = crate::scene::generate::default_scene(1);
        scene.camera.pose = Pose::LookAt { eye: DVec3::ZERO, target: DVec3::X };
        for place in 0..3 {
            scene.spheres = crate::scene::Spheres::default();
            for (middle, count) in
                [(DVec3::NEG_X * 100.0, 512), (DVec3::X * 130.0, 2048), (DVec3::Y * 200.0, 512)]
            {
                for i in 0..count {
                    let t = f64::from(i);
                    let spread = DVec3::new((t * 12.9).sin(), (t * 78.2).sin(), (t * 37.7).cos());
                    let is_large = count == 2048 && i == 300 + 600 * place;
                    let radius = if is_large { 40.0 } else { 0.01 };
                    scene.spheres.push(middle + spread, radius, 0, crate::scene::Rgb::ONE);
                }
            }
            let world = World::build(&scene).unwrap();
            let [near, far] = depths(&world);
            assert!((88.0..92.0).contains(&near) && (199.0..202.0).contains(&far), "{near} {far}");
            assert_eq!(Runs::of(&world).depths(&world), [near, far], "{place}");
        }
    }

    #[test]
    fn worlds_without_spheres_have_no_depth() {
        let scene = crate::scene::generate::default_scene(1);
        let world = World::build(&scene).unwrap().without_spheres();
        assert_eq!(depths(&world), NONE);
        assert_eq!(Runs::of(&world).depths(&world), NONE);
    }

    #[test]
    fn what_is_behind_a_parallel_camera_counts_as_0() {
        let mut scene = crate::scene::generate::default_scene(1);
        scene.spheres = crate::scene::Spheres::default();
        for z in [0.0, 10.0] {
            scene.spheres.push(DVec3::Z * z, 1.0, 0, crate::scene::Rgb::ONE);
        }
        scene.camera.projection = Projection::Orthographic { height: Some(3.0) };
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 5.0, target: DVec3::ZERO };
        let world = World::build(&scene).unwrap();
        assert_eq!(depths(&world), [0.0, 6.0]);
        assert_eq!(Runs::of(&world).depths(&world), [0.0, 6.0]);
    }
}
