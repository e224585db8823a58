//! What shines: spheres, points and suns, and how a point of a surface samples them.

use super::Tracer;
use super::random::{Cells, Random};
use super::shape::{EPSILON, Ray, Sphere};
use crate::scene::{self, Scene};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A light.
pub(super) enum Light {
    /// A row of the array of spheres.
    Sphere(usize),
    Point {
        position: DVec3,
        intensity: DVec3,
        falloff: bool,
    },
    /// `height` is 1 - cos of the angular radius; 0 for a sun without a disc, whose radiance is
    /// its irradiance then.
    Sun {
        direction: DVec3,
        radiance: DVec3,
        height: f64,
    },
}

/// Light from one direction: what a diffuse surface of albedo pi that faces it would send on.
struct Sample {
    direction: DVec3,
    distance: f64,
    light: DVec3,
}

impl Light {
    pub(super) fn all(scene: &Scene, spheres: &[Sphere]) -> Vec<Self> {
        let emits = |row: &usize| spheres[*row].surface.emitted != DVec3::ZERO;
        let emitters = (0..spheres.len()).filter(emits).map(Self::Sphere);
        emitters.chain(scene.lights.iter().map(Self::of)).collect()
    }

    fn of(light: &scene::Light) -> Self {
        match *light {
            scene::Light::Point { position, intensity, falloff } => {
                Self::Point { position, intensity: intensity.as_dvec3(), falloff }
            }
            scene::Light::Sun { direction, irradiance, angular_radius } => {
                let angle = angular_radius.to_radians();
                let share = if angle > 0.0 { PI * angle.sin().powi(2) } else { 1.0 };
                let radiance = irradiance.as_dvec3() / share;
                Self::Sun { direction, radiance, height: 2.0 * (angle / 2.0).sin().powi(2) }
            }
        }
    }

    /// What a ray sees that goes past all spheres.
    pub(super) fn seen(&self, toward: DVec3) -> DVec3 {
        match self {
            Self::Sun { direction, radiance, height }
                if *height > 0.0 && 1.0 - direction.dot(toward) <= *height =>
            {
                *radiance
            }
            _ => DVec3::ZERO,
        }
    }

    /// Whether it has an extent: if not, one sample tells all.
    fn is_wide(&self) -> bool {
        match self {
            Self::Sphere(_) => true,
            Self::Point { .. } => false,
            Self::Sun { height, .. } => *height > 0.0,
        }
    }

    /// Light that comes to a point; `None` from within a sphere that shines.
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

impl Tracer {
    /// Diffuse light of a point: from each light and from the environment, by one sample for each
    /// cell. The normal is on the side that is looked at.
    pub(super) fn direct(
        &self,
        (point, normal): (DVec3, DVec3),
        cells: &Cells,
        random: &mut Random,
        rays: &mut u64,
    ) -> DVec3 {
        let mut light = DVec3::ZERO;
        let mut reaches = |direction: DVec3, distance: f64| {
            *rays += 1;
            !self.occluded(&Ray { origin: point, direction }, distance - EPSILON)
        };
        for source in &self.lights {
            let count = if source.is_wide() { cells.count() } else { 1 };
            for index in 0..count {
                let u = cells.jitter(index, random);
                let Some(sample) = source.sample(&self.spheres, point, u) else { continue };
                let cosine = normal.dot(sample.direction);
                if cosine > 0.0 && reaches(sample.direction, sample.distance) {
                    light += sample.light * (cosine / PI / f64::from(count));
                }
            }
        }
        let sky = if self.environment.illuminates { cells.count() } else { 0 };
        for index in 0..sky {
            let [u, v] = cells.jitter(index, random);
            let direction = to_world(normal, v.sqrt(), (1.0 - v).sqrt(), u);
            if reaches(direction, f64::INFINITY) {
                light += self.sky(direction) / f64::from(sky);
            }
        }
        light
    }

    /// The environment's radiance.
    fn sky(&self, toward: DVec3) -> DVec3 {
        self.environment.radiance(toward.as_vec3()).as_dvec3()
    }

    /// What a ray sees that hits nothing.
    pub(super) fn background(&self, toward: DVec3) -> DVec3 {
        self.lights.iter().map(|light| light.seen(toward)).sum::<DVec3>() + self.sky(toward)
    }
}

/// A direction uniform by solid angle in a cone about `axis`; `height` is 1 - cos of its
/// half-angle.
fn in_cone(axis: DVec3, height: f64, [u, v]: [f64; 2]) -> DVec3 {
    let depth = height * v;
    to_world(axis, (depth * (2.0 - depth)).sqrt(), 1.0 - depth, u)
}

/// The unit vector with these parts across and along `axis`, at `turn` turns about it.
fn to_world(axis: DVec3, across: f64, along: f64, turn: f64) -> DVec3 {
    let (x, y) = axis.any_orthonormal_pair();
    let around = DVec2::from_angle(TAU * turn) * across;
    x * around.x + y * around.y + axis * along
}
