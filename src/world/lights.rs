//! What can be sampled to find light: emissive spheres, points, suns and a picture of the sky.

use super::environment::{Environment, Picture, luminance};
use super::materials::{Kind, Materials};
use super::{Frame, Spheres, World};
use crate::intersect;
use crate::ray::ExactRay;
use crate::sampling::{self, Cone, Distribution};
use crate::scene::{self, Rgb, Scene};
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

/// The lights, each with a share of the samples in proportion to its power.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// Rows of emissive spheres, ascending.
    pub emitters: Vec<u32>,
    /// Points.
    pub points: Vec<Point>,
    /// Suns.
    pub suns: Vec<Sun>,
    /// Whether the environment is sampled as well, as the last light.
    pub sky: bool,
    /// Chooses among emitters, points, suns and sky, in this order; `None` if there is none.
    choice: Option<Distribution>,
}

/// A point light in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    position: DVec3,
    /// Radiant intensity; irradiance if there is no fall-off.
    intensity: Rgb,
    /// World units per unit of the user, by whose distance light falls off; `None` if it does not.
    falloff: Option<f64>,
}

/// A disc at infinity.
#[derive(Clone, Copy, Debug)]
pub struct Sun {
    frame: sampling::Frame,
    direction: Vec3,
    irradiance: Rgb,
    /// `None`: of no extent.
    disc: Option<Cone>,
}

/// Light that arrives from a direction, if nothing is in between.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit vector toward the light.
    pub direction: Vec3,
    /// Distance of the light; infinite for suns and sky.
    pub t: f64,
    /// Radiance over density: what to multiply with the surface's response.
    pub weight: Rgb,
    /// Density by solid angle, without the choice of the light; `None` if the light has no extent.
    pub pdf: Option<f32>,
    /// Whether it is an emissive sphere, so near that a diffuse surface should look for it too.
    pub close: bool,
}

/// A light as seen from a point, ready to be sampled any number of times.
pub enum Aim<'a> {
    /// An emissive sphere.
    Disc(Disc),
    /// Of no extent.
    Delta(LightSample),
    /// At infinity.
    Sun(&'a Sun),
    /// The environment's picture.
    Sky(&'a Picture),
}

/// An emissive sphere as seen from a point: what fills a cone.
pub struct Disc {
    frame: sampling::Frame,
    cone: Cone,
    origin: Vec3,
    center: DVec3,
    radius: f64,
    weight: Rgb,
    close: bool,
}

/// A light in the order of the choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Light {
    Emitter(usize),
    Point(usize),
    Sun(usize),
    Sky,
}

impl Lights {
    pub(super) fn build(
        scene: &Scene,
        frame: &Frame,
        spheres: &Spheres,
        materials: &Materials,
        environment: &Environment,
    ) -> Self {
        let emitters = emitters(spheres, materials);
        let (mut points, mut suns) = (Vec::new(), Vec::new());
        for light in &scene.lights {
            match *light {
                scene::Light::Point { position, intensity, falloff } => points.push(Point {
                    position: frame.point(position),
                    intensity,
                    falloff: falloff.then_some(frame.scale),
                }),
                scene::Light::Sun { direction, irradiance, angular_radius } => suns.push(Sun {
                    frame: sampling::Frame::new(direction.as_vec3()),
                    direction: direction.as_vec3(),
                    irradiance,
                    disc: (angular_radius > 0.0)
                        .then(|| Cone::from_half_angle(angular_radius.to_radians())),
                }),
            }
        }
        let sky = environment.illuminates && environment.picture().is_some();
        let mut lights = Self { emitters, points, suns, sky, choice: None };
        let powers = lights.powers(spheres, materials, environment);
        lights.choice = Distribution::new(&powers);
        lights
    }

    /// Power of each light, up to a common factor. Light from infinity is what falls on a disk of
    /// the scene's size, which is about 1.
    fn powers(&self, spheres: &Spheres, materials: &Materials, sky: &Environment) -> Vec<f64> {
        let emitters = self.emitters.iter().map(|&row| {
            let row = row as usize;
            let emitter = &materials.emitter[spheres.material.row(row).row()];
            luminance(emitter.radiance) * (2.0 * PI * spheres.radius[row]).powi(2)
        });
        let points = self.points.iter().map(|point| {
            let falloff = point.falloff.map_or(1.0, |scale| (scale * scale) as f32);
            luminance(point.intensity) * falloff * 4.0 * PI
        });
        let suns = self.suns.iter().map(|sun| luminance(sun.irradiance) * PI);
        let sky = sky.picture().filter(|_| self.sky);
        let sky = sky.map(|picture| picture.mean_luminance() * (2.0 * PI).powi(2));
        emitters.chain(points).chain(suns).chain(sky).map(f64::from).collect()
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.emitters.len() + self.points.len() + self.suns.len() + usize::from(self.sky)
    }

    /// Whether there is nothing to sample, and so no shadow ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether light `index` has no extent, so that one shadow ray says all.
    pub fn is_delta(&self, index: usize) -> bool {
        match self.light(index) {
            Light::Point(_) => true,
            Light::Sun(i) => self.suns[i].disc.is_none(),
            Light::Emitter(_) | Light::Sky => false,
        }
    }

    fn light(&self, index: usize) -> Light {
        let (emitters, points) = (self.emitters.len(), self.points.len());
        if index < emitters {
            Light::Emitter(index)
        } else if index < emitters + points {
            Light::Point(index - emitters)
        } else if index < emitters + points + self.suns.len() {
            Light::Sun(index - emitters - points)
        } else {
            Light::Sky
        }
    }

    /// Chooses a light in proportion to its power: its index and the probability of the choice.
    #[inline]
    pub fn choose(&self, u: f32) -> Option<(usize, f32)> {
        let choice = self.choice.as_ref()?.sample(u);
        Some((choice.index, choice.pmf))
    }

    /// The probability that [`Lights::choose`] chooses light `index`.
    #[inline]
    fn probability(&self, index: usize) -> f32 {
        self.choice.as_ref().map_or(0.0, |choice| choice.pmf(index))
    }

    /// Light `index` as seen from a point of the surface of sphere `own`; `None` if the point is in
    /// or on the light: such light is found by the surface's own sampling.
    #[inline]
    pub fn aim<'a>(
        &'a self,
        world: &'a World,
        index: usize,
        (origin, own): (Vec3, u32),
    ) -> Option<Aim<'a>> {
        match self.light(index) {
            Light::Emitter(i) if self.emitters[i] == own => None,
            Light::Emitter(i) => Disc::new(world, self.emitters[i] as usize, origin).map(Aim::Disc),
            Light::Point(i) => self.points[i].sample(origin).map(Aim::Delta),
            Light::Sun(i) => Some(Aim::Sun(&self.suns[i])),
            Light::Sky => world.environment.picture().map(Aim::Sky),
        }
    }

    /// Density with which `choose` and `sample` find a direction from a point of the surface of
    /// sphere `own` that meets emissive sphere `row`, and whether that sphere is close; density 0
    /// from in or on it.
    pub fn emitter_pdf(
        &self,
        spheres: &Spheres,
        row: u32,
        (origin, own): (Vec3, u32),
    ) -> (f32, bool) {
        let Some(index) = self.emitters.binary_search(&row).ok().filter(|_| row != own) else {
            return (0.0, true);
        };
        match toward_sphere(spheres, row as usize, origin) {
            Some((_, cone, close)) => (self.probability(index) * cone.pdf(), close),
            None => (0.0, true),
        }
    }

    /// Density with which the environment's picture is sampled in unit direction `toward`.
    pub fn sky_pdf(&self, environment: &Environment, toward: Vec3) -> f32 {
        match environment.picture() {
            Some(picture) if self.sky => self.probability(self.len() - 1) * picture.pdf(toward),
            _ => 0.0,
        }
    }

    /// Radiance of each sun that is seen in unit direction `toward`, and the density with which it
    /// is sampled.
    pub fn suns_toward(&self, toward: Vec3) -> impl Iterator<Item = (Rgb, f32)> {
        let first = self.emitters.len() + self.points.len();
        self.suns.iter().enumerate().filter_map(move |(i, sun)| {
            let cone = sun.disc.as_ref()?;
            // 1 - cos from the chord, which does not cancel.
            let height = (toward - sun.direction).length_squared() / 2.0;
            (height <= cone.height())
                .then(|| (sun.radiance(*cone), self.probability(first + i) * cone.pdf()))
        })
    }
}

impl Point {
    fn sample(&self, origin: Vec3) -> Option<LightSample> {
        let toward = self.position - origin.as_dvec3();
        let distance = toward.length();
        if distance == 0.0 {
            return None;
        }
        let falloff = self.falloff.map_or(1.0, |scale| (scale / distance).powi(2) as f32);
        Some(LightSample {
            direction: (toward / distance).as_vec3(),
            t: distance,
            weight: self.intensity * falloff,
            pdf: None,
            close: false,
        })
    }
}

impl Sun {
    fn radiance(&self, cone: Cone) -> Rgb {
        // Irradiance on a facing plane is radiance times pi sin^2; sin^2 = h (2 - h) with h = 1 -
        // cos.
        self.irradiance / (PI * cone.height() * (2.0 - cone.height()))
    }

    fn sample(&self, u: [f32; 2]) -> LightSample {
        let sample = |direction, weight, pdf| LightSample {
            direction,
            t: f64::INFINITY,
            weight,
            pdf,
            close: false,
        };
        match &self.disc {
            None => sample(self.direction, self.irradiance, None),
            Some(cone) => sample(
                self.frame.to_world(cone.sample(u)),
                self.radiance(*cone) / cone.pdf(),
                Some(cone.pdf()),
            ),
        }
    }
}

fn emitters(spheres: &Spheres, materials: &Materials) -> Vec<u32> {
    let emits = |row: &u32| {
        let id = spheres.material.row(*row as usize);
        id.kind() == Kind::Emitter && materials.emitter[id.row()].radiance != Rgb::ZERO
    };
    if materials.emitter.is_empty() {
        return Vec::new();
    }
    (0..spheres.len() as u32).filter(emits).collect()
}

/// Direction to the center of sphere `row`, the cone that it fills as seen from `origin`, and
/// whether it is close; `None` from inside.
///
/// Close is nearer than 1.15 radii from the center: there, a diffuse surface looks for the sphere by
/// its own sampling as well, and farther off the cone alone has the least variance. In the box of
/// `scenes/smallpt.toml`, whose lamp is all close and nearly all hidden, the error at equal samples
/// is 0.81 of what it is without (`spherule compare` of pictures of two seeds).
fn toward_sphere(spheres: &Spheres, row: usize, origin: Vec3) -> Option<(DVec3, Cone, bool)> {
    const CLOSE: f64 = 1.15;
    let toward = spheres.center(row).as_dvec3() - origin.as_dvec3();
    let radius = f64::from(spheres.radius[row]);
    let distance2 = toward.length_squared();
    let cone = Cone::toward_sphere(distance2, radius)?;
    Some((toward, cone, distance2 < (CLOSE * radius).powi(2)))
}

impl Disc {
    fn new(world: &World, row: usize, origin: Vec3) -> Option<Self> {
        let (toward, cone, close) = toward_sphere(&world.spheres, row, origin)?;
        let emitter = &world.materials.emitter[world.spheres.material.row(row).row()];
        Some(Self {
            frame: sampling::Frame::new(toward.normalize().as_vec3()),
            origin,
            center: world.spheres.center(row).as_dvec3(),
            radius: f64::from(world.spheres.radius[row]),
            weight: emitter.radiance / cone.pdf(),
            cone,
            close,
        })
    }

    #[inline]
    fn sample(&self, u: [f32; 2]) -> LightSample {
        let direction = self.frame.to_world(self.cone.sample(u));
        LightSample {
            direction,
            t: self.distance(direction),
            weight: self.weight,
            pdf: Some(self.cone.pdf()),
            close: self.close,
        }
    }

    /// Distance to the sphere. At the edge of its disc rounding may take the ray past it: then, to
    /// the point where it is nearest.
    fn distance(&self, direction: Vec3) -> f64 {
        let ray = ExactRay::new(self.origin, direction, true);
        intersect::confirm(&ray, self.center, self.radius).unwrap_or_else(|| {
            (self.center - ray.origin).dot(ray.direction) / ray.direction.length_squared()
        })
    }
}

impl Aim<'_> {
    /// Light from a point of the light, from two numbers in [0, 1); `None` if there is none from
    /// there.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Option<LightSample> {
        match self {
            Self::Disc(disc) => Some(disc.sample(u)),
            Self::Delta(sample) => Some(*sample),
            Self::Sun(sun) => Some(sun.sample(u)),
            Self::Sky(picture) => picture.sample(u).map(|sample| LightSample {
                direction: sample.direction,
                t: f64::INFINITY,
                weight: sample.radiance / sample.pdf,
                pdf: Some(sample.pdf),
                close: true,
            }),
        }
    }
}
