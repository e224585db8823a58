//! Rays of four classes, from the points that a camera sees.

use super::{LIGHT, SphereScene, View, above};
use glam::{DVec3, Vec3};
use spherule_render::bvh::{Tracer, Tree};
use spherule_render::ray::{Hits, MISS, Rays};
use spherule_render::spheres::Spheres;

/// A class of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Closest hit of rays from a pinhole through every pixel, in blocks of pixels.
    Camera,
    /// Any hit of rays from visible points toward one distant light above their horizon.
    Shadow,
    /// Any hit of cosine-distributed rays from visible points.
    Occlusion,
    /// Closest hit of cosine-distributed rays from visible points.
    Diffuse,
}

impl Class {
    /// All classes.
    pub const ALL: [Self; 4] = [Self::Camera, Self::Shadow, Self::Occlusion, Self::Diffuse];

    /// Returns whether the query is for any hit, not the closest.
    pub fn is_any(self) -> bool {
        matches!(self, Self::Shadow | Self::Occlusion)
    }

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Shadow => "shadow",
            Self::Occlusion => "occlusion",
            Self::Diffuse => "diffuse",
        }
    }
}

/// Rays of each class, for one scene in one order of its spheres.
pub struct Views {
    rays: [Rays; 4],
}

impl Views {
    /// Generates rays for an image of `side` x `side` pixels, a multiple of 4. Rays that start on a
    /// sphere know its row.
    pub fn new(scene: SphereScene, tree: Tree, side: u32) -> Self {
        let spheres = tree.spheres;
        let camera = camera(scene, spheres, side);
        let mut hits = Hits::with_capacity(camera.len());
        Tracer::default().closest(tree, &camera, &mut hits);
        let light = LIGHT.normalize();
        let shadow = leaving(spheres, &camera, &hits, |_, _| light);
        let scattered = |seed: u64| {
            leaving(spheres, &camera, &hits, |row, normal| above(normal, seed, row as u64))
        };
        let (occlusion, diffuse) = (scattered(2), scattered(3));
        Self { rays: [camera, shadow, occlusion, diffuse] }
    }

    /// Returns the rays of a class.
    pub fn rays(&self, class: Class) -> &Rays {
        &self.rays[class as usize]
    }
}

/// Returns a ray from each visible point, in a direction that depends on its row and normal. Rays below
/// the horizon are omitted.
fn leaving(
    spheres: &Spheres,
    camera: &Rays,
    hits: &Hits,
    toward: impl Fn(usize, Vec3) -> Vec3,
) -> Rays {
    let mut rays = Rays::with_capacity(camera.len());
    for row in (0..camera.len()).filter(|&row| hits.sphere[row] != MISS) {
        let sphere = hits.sphere[row] as usize;
        let center: DVec3 = spheres.center(sphere).as_dvec3();
        let normal = camera.exact(row).at_from(center, hits.t[row]).normalize();
        let point = (center + normal * f64::from(spheres.radius(sphere))).as_vec3();
        let direction = toward(row, normal.as_vec3());
        if direction.as_dvec3().dot(normal) > 0.0 {
            rays.push(point, direction, sphere as u32);
        }
    }
    rays
}

/// Returns rays through all pixels, in blocks of 4 x 4.
fn camera(scene: SphereScene, spheres: &Spheres, side: u32) -> Rays {
    let column = |axis: usize| (0..spheres.len()).map(|row| spheres.center(row)[axis]).collect();
    let [x, y, z]: [Vec<f32>; 3] = [0, 1, 2].map(column);
    let radius: Vec<f32> = (0..spheres.len()).map(|row| spheres.radius(row)).collect();
    let view = View::new([&x, &y, &z, &radius], scene.flat);
    let mut rays = Rays::with_capacity((side * side) as usize);
    for i in 0..side * side {
        let (eye, direction) = view.ray(View::in_blocks(i, side), side);
        rays.push(eye, direction, MISS);
    }
    rays
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::bvh::builders::{Builder, build};

    #[test]
    fn rays_start_on_visible_spheres() {
        let mut spheres = SphereScene::PAPER400.spheres().unwrap();
        let bvh = build(&mut spheres, Builder::default());
        let tree = Tree { bvh: &bvh, spheres: &spheres };
        let views = Views::new(SphereScene::PAPER400, tree, 32);
        assert_eq!(views.rays(Class::Camera).len(), 32 * 32);
        for class in [Class::Shadow, Class::Occlusion, Class::Diffuse] {
            let rays = views.rays(class);
            assert!(rays.len() > 200, "{class:?} {}", rays.len());
            for row in 0..rays.len() {
                let (center, radius) = spheres.exact(rays.own[row] as usize);
                let ray = rays.exact(row);
                let from = ray.origin - center;
                assert!((from.length() / radius - 1.0).abs() < 1e-4, "{class:?}");
                assert!(ray.direction.dot(from) > 0.0, "{class:?}");
            }
        }
    }
}
