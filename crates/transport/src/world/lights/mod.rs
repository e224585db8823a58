//! Lights that can be sampled: emissive spheres, points, suns and a picture of the sky.

mod build;
mod device;
mod point;
mod row;
mod sample;
mod sampler;
mod sphere_light;
mod sun;
mod tree;

pub use point::Point;
pub use row::{LANES, LightLanes, ReceiverRow};
pub(crate) use sample::MAX_MIDDLES;
pub(super) use sampler::LightSampler;
pub use sphere_light::Disc;
pub use sun::Sun;
pub use tree::Receiver;
pub(super) use tree::{BRANCHES, Chances, LightBounds, ROOT, Siblings, Tree, WITHIN, horizon};

use super::appearance::Appearance;
use super::environment::{Environment, Picture};
use super::{Cut, Transform};
use crate::ray::MISS;
use crate::scene::{self, LightChoice, Rgb, Scene};
use crate::shade::{MaterialKind, Materials};
use crate::spheres::Spheres;
use glam::Vec3;
use sphere_light::view_sphere;

/// Most emissive spheres that are tested against the direction of each mirrored ray.
const MAX_MIRRORED: usize = 16;

/// The lights. Unless the settings say otherwise, each is chosen in proportion to its estimated
/// unoccluded contribution at the receiver.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// Rows of emissive spheres, in the order of [`Spheres::key`]: samples do not depend on the tree.
    pub emitters: Vec<u32>,
    /// Radiance of each emissive sphere.
    pub(crate) radiance: Vec<Rgb>,
    /// Point lights.
    pub points: Vec<Point>,
    /// Suns.
    pub suns: Vec<Sun>,
    /// Number of parts of the environment's picture, which are sampled as well, as the last lights.
    pub sky_parts: usize,
    sampler: LightSampler,
    by: LightChoice,
    /// [`Transform::extent`].
    pub(super) unit: f64,
    /// Distance from its center, in radii, within which an emissive sphere is close.
    reach: f64,
}

/// A light sample: light that arrives from a direction, if it is not occluded.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit vector toward the light.
    pub direction: Vec3,
    /// Distance of the light; infinite for suns and sky.
    pub t: f64,
    /// Row of the light if it is a sphere, which does not occlude itself; otherwise [`MISS`].
    pub target: u32,
    /// Radiance over density: the factor on the surface's BSDF.
    pub weight: Rgb,
    /// Density by solid angle, without the choice of the light; `None` if the light has no extent.
    pub pdf: Option<f32>,
    /// True if the light is an emissive sphere that is so near, or one of so many, that a diffuse
    /// surface should find it by BSDF samples too.
    pub close: bool,
}

/// A light as seen from a point, which can be sampled any number of times.
pub enum LightView<'a> {
    /// An emissive sphere.
    Disc(Disc),
    /// A light without extent.
    Delta(LightSample),
    /// A light at infinity.
    Sun(&'a Sun),
    /// A part of the environment's picture.
    Sky(&'a Picture, usize),
}

/// A light in the order of the light sampler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Light {
    Emitter(usize),
    Point(usize),
    Sun(usize),
    Sky(usize),
}

/// Emissive spheres that are sampled.
#[derive(Default)]
pub(super) struct EmissiveSpheres {
    rows: Vec<u32>,
    radiance: Vec<Rgb>,
}

impl Lights {
    pub(super) fn build(
        scene: &Scene,
        transform: &Transform,
        spheres: &Spheres,
        emissive: EmissiveSpheres,
        environment: &Environment,
    ) -> Self {
        let EmissiveSpheres { rows: emitters, radiance } = emissive;
        let (mut points, mut suns) = (Vec::new(), Vec::new());
        for light in &scene.lights {
            match *light {
                scene::Light::Point { position, intensity, falloff } => points.push(Point {
                    position: transform.point(position),
                    intensity,
                    falloff: falloff.then_some(transform.scale),
                }),
                scene::Light::Sun { direction, irradiance, angular_radius } => {
                    suns.push(Sun::new(direction, irradiance, angular_radius));
                }
            }
        }
        let picture = environment.picture().filter(|_| environment.illuminates);
        let sky_parts = picture.map_or(0, |picture| picture.parts().count());
        let (sampler, by) = (LightSampler::None, scene.settings.light_choice);
        let unit = transform.extent();
        let mut lights =
            Self { emitters, radiance, points, suns, sky_parts, by, sampler, reach: 0.0, unit };
        lights.sampler = LightSampler::new(&lights.light_bounds(spheres, environment), by, unit);
        lights.reach = lights.close_within();
        lights
    }

    /// Returns the lights that are not spheres.
    pub(super) fn without_spheres(&self, environment: &Environment) -> Self {
        if self.emitters.is_empty() {
            return self.clone();
        }
        let (emitters, radiance) = (Vec::new(), Vec::new());
        let mut lights = Self { emitters, radiance, sampler: LightSampler::None, ..self.clone() };
        let light_bounds = lights.light_bounds(&Spheres::default(), environment);
        lights.sampler = LightSampler::new(&light_bounds, self.by, self.unit);
        lights
    }

    /// Returns the number of lights.
    pub fn len(&self) -> usize {
        self.emitters.len() + self.points.len() + self.suns.len() + self.sky_parts
    }

    /// Returns the number of lights apart from parts of the environment's picture.
    pub(crate) fn count_without_sky(&self) -> usize {
        self.len() - self.sky_parts
    }

    /// Returns whether suns and emissive spheres are sampled in the directions of mirrored rays: if there
    /// are few, since each is tested.
    pub fn samples_mirrored_light(&self) -> bool {
        self.emitters.len() <= MAX_MIRRORED && (self.suns_have_discs() || !self.emitters.is_empty())
    }

    /// Returns whether there is no light to sample, and so no shadow ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns whether light `index` has no extent, so that one shadow ray suffices.
    pub fn is_delta(&self, index: usize) -> bool {
        match self.light(index) {
            Light::Point(_) => true,
            Light::Sun(i) => self.suns[i].disc.is_none(),
            Light::Emitter(_) | Light::Sky(_) => false,
        }
    }

    /// Returns the sun if it is the only light: it needs no choice, and is the same from everywhere.
    pub fn single_sun(&self) -> Option<&Sun> {
        if self.len() == 1 { self.suns.first() } else { None }
    }

    fn light(&self, index: usize) -> Light {
        let (emitters, points) = (self.emitters.len(), self.points.len());
        let sky = emitters + points + self.suns.len();
        if index < emitters {
            Light::Emitter(index)
        } else if index < emitters + points {
            Light::Point(index - emitters)
        } else if index < sky {
            Light::Sun(index - emitters - points)
        } else {
            Light::Sky(index - sky)
        }
    }

    /// Returns the index of emissive sphere `row`; `None` if it is not sampled.
    pub fn emitter_index(&self, spheres: &Spheres, row: u32) -> Option<usize> {
        let key = spheres.key(row as usize);
        let found = self.emitters.binary_search_by_key(&key, |&other| spheres.key(other as usize));
        found.ok().filter(|&index| self.emitters[index] == row)
    }

    /// Returns the density with which `choose` and `sample` find emissive sphere `row`; 0 from in or on
    /// it, infinite if it is not close to a `diffuse` surface: then light samples alone count.
    pub fn emitter_pdf(&self, spheres: &Spheres, row: u32, at: &Receiver, diffuse: bool) -> f32 {
        let Some(index) = self.emitter_index(spheres, row).filter(|_| row != at.own) else {
            return 0.0;
        };
        match view_sphere(spheres, row as usize, at.point, self.reach) {
            Some((seen, _)) if diffuse && !seen.close => f32::INFINITY,
            Some((_, cone)) => self.probability(at, index) * cone.pdf(),
            None => 0.0,
        }
    }

    /// Returns whether a sun has a visible disc.
    pub fn suns_have_discs(&self) -> bool {
        self.suns.iter().any(|sun| sun.disc.is_some())
    }

    /// Returns each sun that is visible in unit direction `toward`, with its radiance.
    pub fn suns_toward(&self, toward: Vec3) -> impl Iterator<Item = (usize, Rgb)> {
        self.suns
            .iter()
            .enumerate()
            .filter_map(move |(i, sun)| sun.is_toward(toward).then_some((i, sun.radiance)))
    }

    /// Returns the index of sun `sun` among all lights.
    pub(crate) fn sun_index(&self, sun: usize) -> usize {
        self.emitters.len() + self.points.len() + sun
    }

    /// Returns the density with which a direction toward sun `sun` is sampled.
    pub fn sun_pdf(&self, sun: usize, at: &Receiver) -> f32 {
        let probability = || self.probability(at, self.sun_index(sun));
        self.suns[sun].disc.map_or(0.0, |cone| probability() * cone.pdf())
    }
}

impl EmissiveSpheres {
    /// Finds the emissive spheres that are not cut; only BSDF samples find the light of the others.
    pub(crate) fn find(
        spheres: &Spheres,
        cut: &Cut,
        appearance: &Appearance,
        materials: &Materials,
    ) -> Self {
        if materials.emitter.is_empty() {
            return Self::default();
        }
        let is_uncut = |row: u32| {
            let (center, radius) = spheres.exact(row as usize);
            !cut.divides(center, radius)
        };
        let radiance = |row: u32| {
            let id = appearance.material.row(row as usize);
            (id.kind() == MaterialKind::Emitter).then(|| materials.emitter[id.row()].radiance)
        };
        let emits =
            |row: u32| Some((row, radiance(row).filter(|&radiance| radiance != Rgb::ZERO)?));
        let all = 0..spheres.len() as u32;
        let emitters = all.filter(|&row| emits(row).is_some() && is_uncut(row));
        let emitters = spheres.first_of_equals(emitters).into_iter();
        let (rows, radiance) = emitters.filter_map(emits).unzip();
        Self { rows, radiance }
    }
}

impl LightView<'_> {
    /// Samples the light with two random numbers in [0, 1); `None` if the sample has no light.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Option<LightSample> {
        match self {
            Self::Disc(disc) => Some(disc.sample(u)),
            Self::Delta(sample) => Some(*sample),
            Self::Sun(sun) => Some(sun.sample(u)),
            Self::Sky(picture, part) => {
                let sample = picture.sample::<f32>(*part, u, 1);
                (sample.lanes == 1).then(|| LightSample {
                    direction: sample.direction.into(),
                    t: f64::INFINITY,
                    target: MISS,
                    weight: Rgb::from(sample.radiance) / sample.pdf,
                    pdf: Some(sample.pdf),
                    close: true,
                })
            }
        }
    }
}

#[cfg(test)]
mod tests;
