//! Rays of four classes, made beforehand, from what a camera sees.

use super::spheres::SphereScene;
use crate::bvh::Bvh;
use crate::bvh::walk::{Closest, Method, trace};
use crate::lanes::F32x16;
use crate::ray::{Hits, MISS, Rays};
use crate::sampling::{Frame, cosine_hemisphere, mix, stream, unit_pair};
use crate::spheres::Spheres;
use glam::{DVec3, Vec2, Vec3};

/// A class of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// From a pinhole through every pixel, in squares of pixels: what is hit first.
    Camera,
    /// From what the camera sees toward one far light above its horizon: whether anything is hit.
    Shadow,
    /// From what the camera sees, cosine-distributed: whether anything is hit.
    Occlusion,
    /// The same: what is hit first.
    Diffuse,
}

impl Class {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Camera, Self::Shadow, Self::Occlusion, Self::Diffuse];

    /// Whether it is only asked whether anything is hit.
    pub fn is_any(self) -> bool {
        matches!(self, Self::Shadow | Self::Occlusion)
    }

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Shadow => "shadow",
            Self::Occlusion => "occlusion",
            Self::Diffuse => "diffuse",
        }
    }
}

/// Rays of each class, for one scene and one order of its spheres.
pub struct Views {
    rays: [Rays; 4],
}

impl Views {
    /// Looks at a scene with `side` x `side` pixels, a multiple of 4. Rays that start on spheres say
    /// on which, by its row.
    pub fn new(scene: SphereScene, (spheres, bvh): (&Spheres, &Bvh), side: u32) -> Self {
        let camera = camera(scene, spheres, side);
        let mut hits = Hits::with_capacity(camera.len());
        trace::<F32x16, Closest>(Method::Auto, bvh, spheres, &camera, &mut hits);
        let light = Vec3::new(0.5, 1.0, 0.3).normalize();
        let shadow = leaving(spheres, (&camera, &hits), |_, _| light);
        let scattered = |seed: u64| {
            leaving(spheres, (&camera, &hits), |row, normal| {
                let u = unit_pair(stream(mix(seed), row as u64));
                Frame::new(normal).to_world(cosine_hemisphere(u)).normalize()
            })
        };
        let (occlusion, diffuse) = (scattered(2), scattered(3));
        Self { rays: [camera, shadow, occlusion, diffuse] }
    }

    /// The rays of a class.
    pub fn rays(&self, class: Class) -> &Rays {
        &self.rays[class as usize]
    }
}

/// A ray from every point that is seen, in a direction that may depend on its row and normal; none
/// if that is below the horizon.
fn leaving(
    spheres: &Spheres,
    (camera, hits): (&Rays, &Hits),
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

/// Rays of a pinhole camera to which the whole scene is as large as fits, from a corner or from
/// above, in blocks of 4 x 4 pixels.
fn camera(scene: SphereScene, spheres: &Spheres, side: u32) -> Rays {
    let (low, high) = extent(spheres);
    let (middle, size) = ((low + high) / 2.0, (high - low).length());
    let toward = if scene.flat { [0.0, -1.0, -0.4] } else { [-0.5, -0.6, -0.6] };
    let forward = Vec3::from(toward).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let eye = middle - forward * (1.5 * size);
    let corners = (0..8).map(|corner| {
        let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
        let to = Vec3::new(pick(0), pick(1), pick(2)) - eye;
        Vec2::new(to.dot(right), to.dot(up)) / to.dot(forward)
    });
    let (least, greatest) = corners
        .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
    let (center, half) = ((least + greatest) / 2.0, (greatest - least).max_element() / 2.0);
    let mut rays = Rays::with_capacity((side * side) as usize);
    for i in 0..side * side {
        let (block, inside) = (i / 16, i % 16);
        let (x, y) = (block % (side / 4) * 4 + inside % 4, block / (side / 4) * 4 + inside / 4);
        let across = |pixel: u32| (pixel as f32 + 0.5) / side as f32 * 2.0 - 1.0;
        let at = center + Vec2::new(across(x), -across(y)) * half;
        rays.push(eye, (forward + right * at.x + up * at.y).normalize(), MISS);
    }
    rays
}

/// Corners of the box that holds the middle 98 percent of the centers on each axis, made larger by
/// 5 percent and the median radius: all of a scene but the strays of a cloud.
fn extent(spheres: &Spheres) -> (Vec3, Vec3) {
    let percentile = |value: &dyn Fn(usize) -> f32, share: f64| {
        let mut values: Vec<f32> = (0..spheres.len()).map(value).collect();
        let at = ((values.len() - 1) as f64 * share) as usize;
        *values.select_nth_unstable_by(at, f32::total_cmp).1
    };
    let corner = |share| {
        Vec3::from([0, 1, 2].map(|axis| percentile(&|row| spheres.center(row)[axis], share)))
    };
    let (low, high) = (corner(0.01), corner(0.99));
    let margin = (high - low) * 0.025 + percentile(&|row| spheres.radius(row), 0.5);
    (low - margin, high + margin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::build::{Builder, build};

    #[test]
    fn rays_leave_what_the_camera_sees() {
        let mut spheres = SphereScene::PAPER400.spheres().unwrap();
        let bvh = build(&mut spheres, Builder::default());
        let views = Views::new(SphereScene::PAPER400, (&spheres, &bvh), 32);
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
