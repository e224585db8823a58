//! Lights (emissive spheres, points and suns), and direct lighting.

use super::PaperTracer;
use super::random::{Cells, Random};
use super::shape::{EPSILON, Ray, Sphere};
use glam::{DVec2, DVec3};
use spherule_render::elementary::sin;
use spherule_render::scene::{self, Scene};
use std::f64::consts::{PI, TAU};

/// A light.
pub(super) enum Light {
    /// Index into the array of spheres.
    Sphere(usize),
    Point {
        position: DVec3,
        intensity: DVec3,
        falloff: bool,
    },
    /// `height` is 1 - cos of the angular radius. If it is 0, the sun has no disc, and `radiance` is
    /// its irradiance.
    Sun {
        direction: DVec3,
        radiance: DVec3,
        height: f64,
    },
}

/// A light sample: direction, distance, and the irradiance of a surface facing the light.
struct Sample {
    direction: DVec3,
    distance: f64,
    light: DVec3,
}

impl Light {
    pub(super) fn all(scene: &Scene, spheres: &[Sphere]) -> Vec<Self> {
        let is_emitter = |row: &usize| spheres[*row].surface.emitted != DVec3::ZERO;
        let emitters = (0..spheres.len()).filter(is_emitter).map(Self::Sphere);
        emitters.chain(scene.lights.iter().map(Self::new)).collect()
    }

    fn new(light: &scene::Light) -> Self {
        match *light {
            scene::Light::Point { position, intensity, falloff } => {
                Self::Point { position, intensity: intensity.as_dvec3(), falloff }
            }
            scene::Light::Sun { direction, irradiance, angular_radius } => {
                let angle = angular_radius.to_radians();
                let projected_angle = if angle > 0.0 { PI * sin(angle).powi(2) } else { 1.0 };
                let radiance = irradiance.as_dvec3() / projected_angle;
                Self::Sun { direction, radiance, height: 2.0 * sin(angle / 2.0).powi(2) }
            }
        }
    }

    /// Returns the radiance seen by a ray that hits nothing.
    pub(super) fn background(&self, toward: DVec3) -> DVec3 {
        match self {
            Self::Sun { direction, radiance, height }
                if *height > 0.0 && 1.0 - direction.dot(toward) <= *height =>
            {
                *radiance
            }
            _ => DVec3::ZERO,
        }
    }

    /// Returns whether the light has an extent. If not, one sample is enough.
    fn has_extent(&self) -> bool {
        match self {
            Self::Sphere(_) => true,
            Self::Point { .. } => false,
            Self::Sun { height, .. } => *height > 0.0,
        }
    }

    /// Samples the light at a point; `None` inside an emissive sphere.
    fn sample(&self, spheres: &[Sphere], point: DVec3, u: [f64; 2]) -> Option<Sample> {
        match *self {
            Self::Sphere(row) => {
                let sphere = &spheres[row];
                let toward = sphere.center - point;
                let cosine2 = 1.0 - sphere.radius.powi(2) / toward.length_squared();
                if cosine2 <= 0.0 {
                    return None;
                }
                let height = (1.0 - cosine2) / (1.0 + cosine2.sqrt());
                let direction = in_cone(toward.normalize(), height, u);
                let ray = Ray { origin: point, direction };
                let distance = sphere.hit(&ray, f64::INFINITY).unwrap_or(toward.dot(direction));
                let light = sphere.surface.emitted * (TAU * height);
                Some(Sample { direction, distance, light })
            }
            Self::Point { position, intensity, falloff } => {
                let distance = position.distance(point);
                let light = if falloff { intensity / (distance * distance) } else { intensity };
                Some(Sample { direction: (position - point) / distance, distance, light })
            }
            Self::Sun { direction, radiance, height } => Some(Sample {
                direction: in_cone(direction, height, u),
                distance: f64::INFINITY,
                light: if height > 0.0 { radiance * (TAU * height) } else { radiance },
            }),
        }
    }
}

impl PaperTracer {
    /// Estimates direct light at a point from each light and the environment, with one sample for each
    /// cell. The normal faces the viewer.
    pub(super) fn direct_light(
        &self,
        point: DVec3,
        normal: DVec3,
        cells: &Cells,
        random: &mut Random,
        rays: &mut u64,
    ) -> DVec3 {
        let mut light = DVec3::ZERO;
        let mut is_visible = |direction: DVec3, distance: f64| {
            *rays += 1;
            !self.occluded(&Ray { origin: point, direction }, distance - EPSILON)
        };
        for source in &self.lights {
            let count = if source.has_extent() { cells.count() } else { 1 };
            for index in 0..count {
                let u = cells.jitter(index, random);
                let Some(sample) = source.sample(&self.spheres, point, u) else { continue };
                let cosine = normal.dot(sample.direction);
                if cosine > 0.0 && is_visible(sample.direction, sample.distance) {
                    light += sample.light * (cosine / PI / f64::from(count));
                }
            }
        }
        let sky = if self.environment.illuminates { cells.count() } else { 0 };
        for index in 0..sky {
            let [u, v] = cells.jitter(index, random);
            let direction = to_world(normal, v.sqrt(), (1.0 - v).sqrt(), u);
            if is_visible(direction, f64::INFINITY) {
                light += self.sky(direction) / f64::from(sky);
            }
        }
        light
    }

    /// Returns the environment's radiance.
    fn sky(&self, toward: DVec3) -> DVec3 {
        self.environment.radiance(toward.as_vec3()).as_dvec3()
    }

    /// Returns the radiance seen by a ray that hits nothing.
    pub(super) fn background(&self, toward: DVec3) -> DVec3 {
        self.lights.iter().map(|light| light.background(toward)).sum::<DVec3>() + self.sky(toward)
    }
}

/// Maps the unit square to directions in a cone about `axis`, uniformly by solid angle; `height` is
/// 1 - cos of the half-angle.
fn in_cone(axis: DVec3, height: f64, [u, v]: [f64; 2]) -> DVec3 {
    let depth = height * v;
    to_world(axis, (depth * (2.0 - depth)).sqrt(), 1.0 - depth, u)
}

/// Returns the unit vector with components `across` and `along` an axis, at `turn` turns about it.
fn to_world(axis: DVec3, across: f64, along: f64, turn: f64) -> DVec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let around = DVec2::from_angle(TAU * turn) * across;
    x * around.x + y * around.y + axis * along
}
