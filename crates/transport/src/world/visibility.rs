//! Visibility of a world's spheres in a picture, by geometry alone: a picture without spheres is
//! usually a mistake.

use super::World;
use crate::body_rows::{BodyKind, BodyRow};
use crate::body_tree::Sphere;
use crate::film::Region;
use crate::shade::MaterialKind;
use glam::DVec2;
use rayon::prelude::*;

/// Visibility of a world's spheres in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Visibility {
    /// A sphere is in the picture.
    Visible,
    /// No sphere is in the picture, or the ground hides those that are.
    OutOfView,
    /// Spheres in the picture are so small that its samples most likely miss them all.
    TooSmall {
        /// Spheres in the picture.
        spheres: u64,
        /// Pixels that they cover in total.
        pixels: f64,
    },
}

impl World {
    /// Returns the visibility of the spheres in a region of the picture with this many samples per
    /// pixel. Spheres hide only each other; the ground may hide all of them.
    pub fn visibility(&self, region: Region, samples: u32) -> Visibility {
        let spheres =
            self.camera_visible.as_ref().map_or(&self.spheres, |visible| &visible.spheres);
        if self.other_bodies_in_view(region) {
            return Visibility::Visible;
        }
        let low = DVec2::new(f64::from(region.x), f64::from(region.y));
        let high = low + DVec2::new(f64::from(region.width), f64::from(region.height));
        let rows = || (0..spheres.len()).into_par_iter();
        let coverage = |row: usize| {
            let (center, radius) = (spheres.center(row).as_dvec3(), f64::from(spheres.radius(row)));
            let hidden = self.is_under_ground(center, radius);
            if hidden { 0.0 } else { self.camera.coverage((center, radius), low, high) }
        };
        if rows().any(|row| coverage(row) >= 1.0) {
            return Visibility::Visible;
        }
        let add =
            |(count, sum): (u64, f64), (more, pixels): (u64, f64)| (count + more, sum + pixels);
        let (spheres, pixels) = rows()
            .map(coverage)
            .map(|pixels| (u64::from(pixels > 0.0), pixels))
            .reduce(|| (0, 0.0), add);
        if spheres == 0 {
            Visibility::OutOfView
        } else if pixels * f64::from(samples) < 1.0 {
            Visibility::TooSmall { spheres, pixels }
        } else {
            Visibility::Visible
        }
    }

    /// Returns whether the surroundings of a body that is no sphere are in a region of the picture.
    fn other_bodies_in_view(&self, region: Region) -> bool {
        let low = DVec2::new(f64::from(region.x), f64::from(region.y));
        let high = low + DVec2::new(f64::from(region.width), f64::from(region.height));
        let trees = self.visible_trees();
        let in_view = |body: BodyRow| {
            trees.around(body).any(|Sphere { center, radius }| {
                self.camera.coverage((center, radius), low, high) > 0.0
            })
        };
        BodyKind::ALL.into_iter().skip(1).any(|kind| {
            let rows = (0..trees.rows().count(kind)).into_par_iter();
            rows.any(|row| in_view(BodyRow::new(kind, row)))
        })
    }

    /// Returns the number of spheres whose centers are outside of the picture.
    pub fn centers_out_of_view(&self) -> u64 {
        let size = DVec2::new(f64::from(self.camera.width), f64::from(self.camera.height));
        let outside = |&row: &usize| {
            let seen = self.camera.view(self.spheres.center(row).as_dvec3());
            let pixel = self.camera.pixel(seen);
            let ahead = seen.z > self.camera.near();
            !(ahead && pixel.cmpge(DVec2::ZERO).all() && pixel.cmple(size).all())
        };
        (0..self.spheres.len()).into_par_iter().filter(outside).count() as u64
    }

    /// Returns whether the ground is between a sphere and a pinhole camera in perspective.
    fn is_under_ground(&self, center: glam::DVec3, radius: f64) -> bool {
        let opaque = self.features.ground_kind.is_some_and(|kind| kind != MaterialKind::Dielectric);
        let Some(ground) = self.ground.filter(|_| opaque) else { return false };
        if self.camera.is_orthographic() || self.camera.has_lens() {
            return false;
        }
        let above = |point: glam::DVec3| ground.normal.dot(point) - ground.height;
        let eye = above(self.camera.eye);
        eye != 0.0 && above(center) * eye.signum() <= -radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::Particles;
    use crate::scene::{Ground, Pose, Projection, Rgb, Scene, Settings, Slice, SliceMode};
    use glam::DVec3;

    /// Spheres about the origin, viewed from the z axis.
    fn scene(radius: f64) -> Scene {
        let mut scene = Scene::of_particles(Particles::default(), "");
        for x in [-1.0, 0.0, 1.0] {
            scene.spheres.push(DVec3::X * x, radius, 0, Rgb::ONE);
        }
        scene.settings = Settings { width: 40, height: 20, spp: 4, ..Settings::default() };
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 10.0, target: DVec3::ZERO };
        scene
    }

    fn visibility(scene: &Scene) -> Visibility {
        let region = Region { x: 0, y: 0, width: 40, height: 20 };
        World::build(scene).unwrap().visibility(region, 4)
    }

    fn aimed(projection: Projection, target: DVec3) -> Scene {
        let mut scene = scene(0.5);
        scene.camera.projection = projection;
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 10.0, target };
        scene
    }

    #[test]
    fn spheres_in_the_picture_are_distinguished_from_others() {
        for projection in
            [Projection::Perspective { fov: 30.0 }, Projection::Orthographic { height: Some(4.0) }]
        {
            assert_eq!(visibility(&aimed(projection, DVec3::ZERO)), Visibility::Visible);
            let away = aimed(projection, DVec3::Z * 20.0);
            assert_eq!(visibility(&away), Visibility::OutOfView);
            assert_eq!(World::build(&away).unwrap().centers_out_of_view(), 3);
        }
        let aside = aimed(Projection::Perspective { fov: 30.0 }, DVec3::new(10.0, 0.0, 0.0));
        assert_eq!(visibility(&aside), Visibility::OutOfView);
        assert_eq!(World::build(&scene(0.5)).unwrap().centers_out_of_view(), 0);
    }

    #[test]
    fn a_region_counts_and_so_do_edges() {
        let world = World::build(&scene(0.5)).unwrap();
        let at = |x, width| world.visibility(Region { x, y: 8, width, height: 4 }, 4);
        assert_eq!((at(0, 8), at(18, 4)), (Visibility::OutOfView, Visibility::Visible));
        // The camera is inside a sphere.
        let mut inside = scene(0.5);
        inside.spheres.push(DVec3::new(0.0, 0.0, 10.5), 0.6, 0, Rgb::ONE);
        inside.camera.pose = Pose::LookAt { eye: DVec3::Z * 10.0, target: DVec3::Z * 20.0 };
        assert_eq!(visibility(&inside), Visibility::Visible);
    }

    #[test]
    fn spheres_that_samples_miss_are_counted() {
        assert_eq!(visibility(&scene(0.1)), Visibility::Visible);
        let Visibility::TooSmall { spheres: 3, pixels } = visibility(&scene(1e-4)) else {
            panic!("they are tiny");
        };
        assert!(pixels > 0.0 && pixels < 1e-3, "{pixels}");
    }

    #[test]
    fn ground_and_slices_hide_spheres() {
        let mut under = scene(0.5);
        under.ground = Some(Ground { normal: DVec3::Z, height: 0.4, material: 0 });
        assert_eq!(visibility(&under), Visibility::Visible);
        under.ground = Some(Ground { normal: DVec3::NEG_Z, height: -0.6, material: 0 });
        assert_eq!(visibility(&under), Visibility::OutOfView);
        let mut hidden = scene(0.5);
        hidden.slices.push(Slice { normal: DVec3::X, distance: -9.0, mode: SliceMode::Hide });
        assert_eq!(visibility(&hidden), Visibility::OutOfView);
    }
}
